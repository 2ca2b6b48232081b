"""Requests for runs and ensembles of a surrogate from the arguments of a Python caller."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tipoff import highfi, lowfi, sources
from tipoff.highfi.rail.geometry import require_walls
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.rail_compliance import DEGREE, RailCompliance
from tipoff.scenes import Calibration, Fault, Scene, SceneError, arguments, studies, uncertainty
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run

_DRAWN = ("count", "seed", "sampling")  # of the cases, which replace values of the file
_SIZE = "element_size"


def run(
    scene: Scene,
    model: str,
    options: Mapping[str, Any],
    compliance: RailCompliance | None,
    calibration: Calibration | None,
    many: bool = False,
) -> Run:
    """The request for a run of a surrogate ``model``, or for each of ``many`` cases. ``options`` are
    fields of ``lowfi.Numerics``, and on compliant contact ``element_size`` of the rail compliance,
    which is computed if it is not given. Raises SceneError and ValueError."""
    given = dict(options)
    size = given.pop(_SIZE, None) if model == COMPLIANT else None
    if size is not None and (compliance is not None or scene.contact is None):
        expected = "none with a compliance, which has its elements"
        if scene.contact is None:
            expected = "none for a scene without contact, which needs no rail compliance"
        raise SceneError([Fault("arguments", _SIZE, repr(size), expected)])
    if size is not None:
        size = arguments.length(_SIZE, size)
    numerics = arguments.numerics(lowfi.Numerics, given, highfi.Numerics, model)
    if many:
        own = {name: getattr(numerics, name) for name in given}
        tolerance = own.get("relative_tolerance", lowfi.OF_MANY)
        numerics = replace(lowfi.Numerics.of_many(tolerance, model=model), **own)
    pressed = walls(scene, model, compliance, calibration, numerics.needed_degree, size)
    return Run(
        fidelity="lowfi",
        label=scene.name,
        scene=scene,
        numerics=numerics,
        calibration=calibration,
        compliance=pressed,
    )


def cases(given: Any, scene: Scene, options: dict[str, Any]) -> Any:
    """The cases that a caller gives: rows of overrides, or distributions by the name or path of their
    file; None means the errors that the scene states, else those of the paper. Takes what belongs to
    drawn cases out of the ``options``. Raises SceneError."""
    drawn = {name: options.pop(name, None) for name in _DRAWN}
    changed = {
        "cases" if name == "count" else name: arguments.plain(value)
        for name, value in drawn.items()
        if value is not None
    }
    if given is None or isinstance(given, (str, Path)):
        given = uncertainty.load(given or uncertainty.chosen(None, scene), scene, **changed)
    elif changed:
        raise SceneError(
            [Fault(scene.name, ", ".join(_DRAWN), "given", "none with a list of cases")]
        )
    return given if isinstance(given, Uncertainty) else arguments.rows(given)


def compliance(scene: Scene, element_size: float | None, degree: int) -> RailCompliance:
    """The rail compliance of a scene from the cache folder of the user, or computed; elements (m) by
    default those of the reference. Raises SceneError and MeshError."""
    from tipoff.calibration import rail_compliance  # slow to load

    usual = studies.element_size(scene.studies, scene.rail.length)
    size = usual if element_size is None else element_size
    return rail_compliance.kept(scene, sources.cache_folder() / "compliance", size, say, degree)


def walls(
    scene: Scene,
    model: str,
    given: RailCompliance | None,
    calibration: Calibration | None = None,
    degree: int = DEGREE,
    element_size: float | None = None,
) -> RailCompliance | None:
    """The rail compliance that ``model`` needs; rigid walls for springs at warm walls or walls from
    a file."""
    if scene.contact is None:
        return given
    if model == COMPLIANT:
        if calibration is not None and calibration.is_of_springs:  # before the statics, for speed
            arguments.require_none(scene, model, calibration=calibration)
        return given or compliance(scene, element_size, degree)
    if given is not None:
        return given
    if scene.thermal is not None:
        return compliance(scene, None, DEGREE).rigid()
    from tipoff.calibration import rail_compliance  # slow to load

    return rail_compliance.walls(scene)


def require_model(scene: Scene, model: str, models: Sequence[str]) -> None:
    """Raise SceneError for a name that is not one of ``models``, and for pads beside no wall of
    their rail, which no model can run."""
    require_walls(scene)
    if not isinstance(model, str) or model not in models:
        raise SceneError([Fault(scene.name, "model", repr(model), f"one of {', '.join(models)}")])
