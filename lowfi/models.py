"""Options of the two models of the surrogate, ``compliant`` and ``springs``."""

from tipoff.faults import Fault, SceneError
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT, SURROGATES
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.rail import GeometryTable, MeshTable
from tipoff.scenes.rail_compliance import model_of
from tipoff.scenes.scene import Scene


def require(
    scene: Scene,
    model: str,
    compliance: RailCompliance | None,
    calibration: Calibration | None,
    numerics: Numerics | None,
) -> None:
    """Raise SceneError with every fault if ``model`` is unknown, lacks an input, or has options of
    the other one. Without contact both models are the same and need no options."""
    if model not in SURROGATES:
        raise SceneError(
            [Fault(scene.name, "model", repr(model), f"one of {', '.join(SURROGATES)}")]
        )
    if scene.contact is None:
        return
    faults = []
    degree = numerics.degree if numerics is not None else None
    if model == COMPLIANT:
        if isinstance(degree, int) and compliance is not None and degree > compliance.degree:
            faults.append(
                (
                    "numerics.degree",
                    str(degree),
                    f"at most {compliance.degree}, that of this rail compliance: "
                    f"tipoff.compliance(scene, degree={degree}) has it",
                )
            )
        if model_of(scene, compliance) != COMPLIANT:
            faults.append(
                ("compliance", "no rail compliance", "tipoff.compliance(scene), or model='springs'")
            )
        if calibration is not None and calibration.is_of_springs:
            faults.append(
                ("calibration", "constants of springs", "none, or those of a fit on this model")
            )
    else:
        if calibration is not None and calibration.is_of_compliant_contact:
            faults.append(
                (
                    "calibration",
                    "constants of compliant contact",
                    "none, or those of a fit on this model",
                )
            )
        if model_of(scene, compliance) == COMPLIANT:
            faults.append(
                (
                    "compliance",
                    "a rail compliance",
                    "none, or rigid walls where rails are warm or from a file: model='compliant' uses it",
                )
            )
        faults += [
            (fault.key, fault.given, fault.expected) for fault in _lacking(scene, compliance)
        ]
        if numerics is not None and numerics.count:
            faults.append(
                ("numerics.modes", str(numerics.modes), "0: springs stand on rigid rails")
            )
        if degree is not None:
            faults.append(("numerics.degree", str(degree), "none: springs stand on rigid rails"))
        if numerics is not None and numerics.cells != Numerics().cells:
            faults.append(("numerics.cells", str(numerics.cells), "none: springs have no cells"))
    if faults:
        raise SceneError([Fault(f"{scene.name}, model {model}", *fault) for fault in faults])


def _lacking(scene: Scene, compliance: RailCompliance | None) -> list[Fault]:
    """Faults of a scene without rail ``compliance`` whose walls are warm or from a file: this
    package does not read files."""
    if scene.contact is None or compliance is not None:
        return []
    faults = []
    if scene.thermal is not None:
        expected = (
            "a rail compliance (tipoff.compliance(scene)), or its rigid() for contact springs"
        )
        faults.append(Fault(scene.name, "thermal", "no rail compliance", expected))
    elif isinstance(scene.rail, (MeshTable, GeometryTable)):
        expected = (
            "tipoff.calibration.rail_compliance.walls(scene), the walls as the file draws them, or "
            "tipoff.run, which finds them"
        )
        given = f"none, and a rail from {scene.rail.path().name}"
        faults.append(Fault(scene.name, "compliance", given, expected))
    return faults


def require_walls(scene: Scene, compliance: RailCompliance | None) -> None:
    """Raise SceneError with the faults of ``_lacking``."""
    if faults := _lacking(scene, compliance):
        raise SceneError(faults)
