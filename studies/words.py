"""Words that every command has for the same thing."""

from scenes.calibration import Calibration
from scenes.scene import Scene
from scenes.walls import Walls


def touched(scene: Scene, fitted: Calibration | None, walls: Walls | None) -> str:
    """What the pads of a surrogate touch. Springs may stand on rigid walls, where warm rails have bowed them."""
    if scene.contact is None:
        return "no contact"
    if walls is not None and walls.flexibility is not None:
        return "compliant walls"
    return "calibrated springs" if fitted else "uncalibrated springs"
