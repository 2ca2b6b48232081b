"""Which scenes a rail compliance serves, and which models of the surrogate they then have."""

import json
from functools import lru_cache

from tipoff.faults import Fault, SceneError
from tipoff.files import content_hash
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import LEAST, MOST, RailCompliance
from tipoff.scenes.scene import Scene


def of_scene(compliance: RailCompliance, scene: Scene) -> RailCompliance:
    """The ``compliance`` at the factor of ``scene`` on the stiffness of its mounts. Raises SceneError
    as ``require`` does."""
    require(compliance, scene)
    return compliance.at(_factor(scene))


def require(compliance: RailCompliance, scene: Scene) -> None:
    """Raise SceneError if ``scene`` has another rail or other pads than ``compliance``, a temperature
    while this has no thermal offset, or a factor on the stiffness of its mounts outside its
    range."""
    if compliance.made_for != digest(scene):
        expected = "those of this compliance: compute it again"
        raise SceneError([Fault(scene.name, "rail", "another rail, or other pads", expected)])
    if scene.thermal is not None and compliance.warm is None:
        given = "a compliance without thermal offset"
        expected = "a compliance for warm rails: compute it again"
        raise SceneError([Fault(scene.name, "thermal", given, expected)])
    factor = _factor(scene)
    if not compliance.allows(factor):
        expected = (
            "1, for a compliance of fewer patterns"
            if compliance.is_of_fixed_joints
            else f"{LEAST:g} to {MOST:g}: change normal and shear for others"
        )
        key = "rail.mount_stiffness.factor"
        raise SceneError([Fault(scene.name, key, f"{factor:g}", expected)])


def _factor(scene: Scene) -> float:
    table = scene.rail.mount_stiffness
    return 1.0 if table is None else table.factor


def digest(scene: Scene) -> str:
    """Hexadecimal digest of the rail and pads of a compliance, without the clearance: one
    compliance serves the cases of a population, whose clearances vary around that of their scene. A
    compliance is stored under all its inputs, including the clearance
    (``calibration.rail_compliance.made_from``)."""
    text = scene.model_dump_json(include={"rail", "pads"})
    return _digest(text, tuple(scene.rail.contents().items()))


@lru_cache(maxsize=64)  # a run of the surrogate asks three times
def _digest(text: str, contents: tuple[tuple[str, str], ...]) -> str:
    """``digest`` of the JSON of rail and pads, and of the ``contents`` of the files of the rail."""
    described = json.loads(text)
    described["rail"] |= dict(contents)
    described["rail"].pop("damping", None)  # statics do not use it
    described["rail"].get("mount_stiffness", {}).pop("factor", None)  # see ``of_scene``
    described["rail"]["material"].pop("expansion", None)  # the offset is per unit of each field
    return content_hash(described)


def model_of(scene: Scene, compliance: RailCompliance | None) -> str:
    """The surrogate model of ``scene`` with ``compliance``: springs without it or on rigid walls.
    Without contact both models are the same, and the default is returned."""
    flexible = compliance is not None and compliance.flexibility is not None
    return COMPLIANT if flexible or scene.contact is None else SPRINGS


def may_vibrate(scene: Scene, compliance: RailCompliance | None) -> bool:
    """Whether the rails of ``scene`` may have modes: only on compliant contact."""
    return scene.contact is not None and model_of(scene, compliance) == COMPLIANT


def require_modes(source: str, compliance: RailCompliance | None, modes: int) -> None:
    """Raise SceneError, naming ``source``, if ``compliance`` has fewer ``modes``."""
    if compliance is not None and modes > (most := compliance.frequency.shape[1]):
        raise SceneError(
            [
                Fault(
                    source,
                    "numerics.modes",
                    str(modes),
                    f"at most {most}, the modes this rail compliance holds",
                )
            ]
        )
