"""Input of a user: scenes with their effects, distributions, calibrated constants."""

from tipoff.faults import Fault, SceneError
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene, catalog, load, parse

__all__ = ["Calibration", "Fault", "Scene", "SceneError", "catalog", "load", "parse"]
