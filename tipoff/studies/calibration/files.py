"""Fitted constants from a file of the user."""

from pathlib import Path

from tipoff.scenes.calibration import Calibration
from tipoff.scenes.faults import Fault, SceneError


def constants(path: Path | None) -> Calibration | None:
    """The calibration in a file, or None without a file. Raises SceneError for one that cannot be
    read."""
    if path is None:
        return None
    try:
        return Calibration.load(path)
    except (OSError, ValueError, TypeError, KeyError) as fault:
        raise SceneError(
            [Fault(str(path), "file", str(fault), "a calibration written by tipoff calibrate")]
        ) from None
