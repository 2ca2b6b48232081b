"""Text that all commands share: the name of a model, counts, and the units of results."""

from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.scene import Scene

# Value of the key "quantities" of every result.
QUANTITIES = (
    "The end of a key names its unit, such as rate_deg_s, exit_time_s, area_m2. Other quantities are "
    "in SI with angles in radians, and numbers without a unit are ratios."
)


def model(scene: Scene, calibrated: bool, compliance: RailCompliance | None) -> str:
    """The surrogate model with the origin of its constants, ``calibrated`` or the scene's. A
    ``compliance`` without flexibility means springs on rigid walls, as for warm rails."""
    if scene.contact is None:
        return f"{COMPLIANT} or {SPRINGS}, which are the same without contact"
    if compliance is not None and compliance.flexibility is not None:
        return f"{COMPLIANT}, calibrated" if calibrated else COMPLIANT
    return f"{SPRINGS}, calibrated" if calibrated else f"{SPRINGS}, with the scene's constants"


def counted(number: int, noun: str, plural: str | None = None) -> str:
    """``number`` with ``noun``; in the ``plural`` (None: with an s) unless the number is one."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"
