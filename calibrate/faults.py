"""What makes a calibration impossible, said before any search."""

from scenes.scene import Scene
from scenes.trajectory import Trajectory


class CalibrationError(ValueError):
    """References or a scene nothing can be fitted to; the message lists every fault."""


def check(scene: Scene, references: dict[str, Trajectory]) -> None:
    """Raise CalibrationError listing every fault of the input; SceneError for a condition the scene does not have."""
    faults = []
    if scene.contact is None:
        faults.append("contact: given no table, expected one: without contact there is nothing to fit")
    asked = list(scene.agreement.fitted)
    if not references:
        faults.append(f"references: given none, expected one for each of {', '.join(asked) or 'the fitted conditions'}")
    faults += [f"references: {name} is missing, expected every condition of agreement.fitted"
               for name in asked if references and name not in references]
    for name, reference in references.items():
        scene.condition(name)
        if reference.status != "exited":
            faults.append(f"references: {name} is {reference.status}, expected exited: no settled rate can be fitted")
    if faults:
        raise CalibrationError("\n".join([f"cannot calibrate {scene.name}"] + [f"  {fault}" for fault in faults]))
