"""The contract of both fidelities: scenes, effects, and the records that travel."""

from scenes.calibration import Calibration
from scenes.faults import Fault, SceneError
from scenes.scene import Scene, catalog, load, parse
from scenes.trajectory import Trajectory

__all__ = ["Calibration", "Fault", "Scene", "SceneError", "Trajectory", "catalog", "load", "parse"]
