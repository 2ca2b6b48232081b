"""Words that every command has for the same thing."""

from tipoff.mechanics.models import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene


def model(scene: Scene, fitted: Calibration | None, compliance: RailCompliance | None) -> str:
    """The model that this makes, with what its constants are. Springs may stand on rigid walls,
    where warm rails have bowed them."""
    if scene.contact is None:
        return f"{COMPLIANT}, without contact"
    if compliance is not None and compliance.flexibility is not None:
        return COMPLIANT
    return f"{SPRINGS}, calibrated" if fitted else f"{SPRINGS}, with the scene's constants"
