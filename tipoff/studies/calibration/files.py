"""Fitted constants from a file of the user."""

from pathlib import Path

from tipoff.faults import Fault, SceneError
from tipoff.files import tell
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes.calibration import Calibration


def constants(path: Path | None, model: str, scene: str) -> Calibration | None:
    """The calibration in a file, or None without a file. A message announces a calibration that was
    fitted on another scene than ``scene``. Raises SceneError for a file that cannot be read or
    belongs to another ``model``."""
    if path is None:
        return None
    try:
        found = Calibration.load(path)
    except (OSError, ValueError, TypeError, KeyError) as fault:
        raise SceneError(
            [Fault(str(path), "file", str(fault), "a calibration written by tipoff calibrate")]
        ) from None
    wrong = {COMPLIANT: found.is_of_springs, SPRINGS: found.is_of_compliant_contact}
    if wrong.get(model, False):
        given = f"constants of {SPRINGS if model == COMPLIANT else 'compliant contact'}"
        expected = f"those of a fit on --model {model}"
        raise SceneError([Fault(str(path), "calibration", given, expected)])
    if (fitted := found.provenance.get("scene", scene)) != scene:
        tell(f"{path}: fitted on the scene {fitted}, and applied to {scene}")
    return found
