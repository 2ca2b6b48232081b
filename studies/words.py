"""Words that every command has for the same thing."""

from scenes.calibration import Calibration
from scenes.fidelity import COMPLIANT, SPRINGS
from scenes.scene import Scene
from scenes.walls import Walls


def model(scene: Scene, fitted: Calibration | None, walls: Walls | None) -> str:
    """The model that this makes, with what its constants are. Springs may stand on rigid walls,
    where warm rails have bowed them."""
    if scene.contact is None:
        return f"{COMPLIANT}, without contact"
    if walls is not None and walls.flexibility is not None:
        return COMPLIANT
    return f"{SPRINGS}, calibrated" if fitted else f"{SPRINGS}, with the scene's constants"
