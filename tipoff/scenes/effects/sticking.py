"""Coulomb friction with stick: a touching face is held by a spring and a damper up to mu_s N, or
slides under mu_d N.

    held      F = -k xi - c u         while |F| <= mu_s N        (xi: displacement from the anchor, u: slip velocity)
    sliding   F = -mu_d N u/|u|       until |u| <= the capture speed

``lowfi.contact.stick_slip`` has the transitions. The spring is the tangential compliance of one pad
face: a held face moves by F/k but does not creep. A damping of 2 sqrt(k m), with the mass m per
face, is critical. Sources: Cundall and Strack, Geotechnique 29 (1979) 47 (spring and slider);
Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100 (a band about rest).
"""

from typing import Literal, NamedTuple

from pydantic import ValidationInfo, field_validator

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

    def record(self) -> "Sticking":
        """Kernel record."""
        return Sticking(self.static, self.dynamic, self.stiffness, self.damping, self.capture_speed)


class Sticking(NamedTuple):
    """Kernel record of friction with sticking."""

    static: float  # coefficient
    dynamic: float  # coefficient
    stiffness: float  # N/m, of a held face
    damping: float  # N s/m, of a held face
    capture_speed: float  # m/s
