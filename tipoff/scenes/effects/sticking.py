"""Coulomb friction with stick (``mechanics.laws.sticking``): a table of ``[friction]``."""

from typing import Literal

from pydantic import ValidationInfo, field_validator

from tipoff.mechanics.laws.sticking import Sticking
from tipoff.scenes.rounding import below
from tipoff.scenes.table import Table
from tipoff.scenes.units import CaptureSpeed, ContactDamping, NonNegativeNumber, Stiffness


class StickingTable(Table):
    """``[friction] law = "sticking"``: coefficients (dimensionless), tangential stiffness (N/m) and
    damping (N s/m) of one held face, and the slip (m/s) below which a face that stops is held."""

    #: Coulomb friction with stick, in the model springs only.
    law: Literal["sticking"]
    #: Static coefficient.
    static: NonNegativeNumber
    #: Dynamic coefficient.
    dynamic: NonNegativeNumber
    #: Tangential stiffness of a held face.
    stiffness: Stiffness
    #: Tangential damping of a held face.
    damping: ContactDamping
    #: Slip speed below which a face is held.
    capture_speed: CaptureSpeed = 1e-6

    @field_validator("dynamic")
    @classmethod
    def _not_above_static(cls, dynamic: float, info: ValidationInfo):
        if below(info.data.get("static", dynamic), dynamic):
            raise ValueError("at most static; otherwise a face that slips would stick at once")
        return dynamic

    def record(self) -> Sticking:
        """Kernel record."""
        return Sticking(self.static, self.dynamic, self.stiffness, self.damping, self.capture_speed)
