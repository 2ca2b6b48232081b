"""Coulomb friction with stick: a touching face is held by a spring and a damper up to mu_s N, or
slides under mu_d N.

    held      F = -k xi - c u         while |F| <= mu_s N        (xi: displacement from the anchor, u: slip velocity)
    sliding   F = -mu_d N u/|u|       until |u| <= the capture speed

``lowfi.contact.stick_slip`` has the transitions. The spring is the tangential compliance of one pad
face: a held face moves by F/k but does not creep. A damping of 2 sqrt(k m), with the mass m per
face, is critical. Sources: Cundall and Strack, Geotechnique 29 (1979) 47 (spring and slider);
Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100 (a band about rest).
"""

from typing import NamedTuple


class Sticking(NamedTuple):
    """Kernel record of friction with sticking."""

    static: float  # coefficient
    dynamic: float  # coefficient
    stiffness: float  # N/m, of a held face
    damping: float  # N s/m, of a held face
    capture_speed: float  # m/s
