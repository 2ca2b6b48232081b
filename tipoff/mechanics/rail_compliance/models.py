"""The models of the surrogate that a rail compliance allows."""

from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance.record import RailCompliance
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import Scene


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
