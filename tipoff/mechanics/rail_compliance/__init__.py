"""Static compliance of the rails under the pads: condensed once from the finite elements, used by
the surrogate as compliant contact.

On pad face i, with xi along the rail and eta across it in [-1, 1], a pressure p displaces the wall
away from the payload by u::

    u_i = sum_a U_ia phi_a(xi, eta),   P_jb = integral over face j of p phi_b dA,   U_ia = sum_jb F_iajb(travel) P_jb
    phi = 1, xi, eta, xi^2, xi eta, eta^2 (``patterns``, here of the second degree)

F is the flexibility of linear statics, symmetric and positive definite, at every station along the
rail. Near an end of the rail it is that of the part of the face that has a wall, at least the last
half of a pad length of the rail, in the patterns of the whole face.

Friction of the coefficient mu drags the wall along X, the way the payload goes. It acts on the
surface, half a wall away from the middle of the leg, so its moment bends the leg::

    U = F P + mu (D P),   D = (T + T') / 2,   T_iajb: pattern a of face i under traction along X in pattern b on face j

Only the first three patterns count: traction with the resultant and the moments of the pressure, and
the mean and the tilt of the wall.
The symmetric part D has a potential. The other part, T - D, is left out.

The lowest modes of the rail, mass-normalised and with frequencies omega_m, are a part of it. The
rest is static::

    U = (F_res + mu D_res) P + S q,   S = W + mu / 2 V,   force on mode m: S_m' P
    F_res = F - sum_m W_m W_m' / omega_m^2,   D_res = D - sum_m (W_m V_m' + V_m W_m') / (2 omega_m^2)

W_iam(travel) is the displacement in mode m, V_iam that along X in the patterns of friction. D_res takes W
in these patterns alone, as D is. All modes together have all of F and of D. F_res is positive semidefinite:
it is the part of the other modes. Modes at rest in their static place displace the wall as F + mu D does,
and by two small terms more: by mu^2 / 4 V V' / omega^2, the square of what friction does (0.04 % of F on
``reference``, 0.11 % on a rail of 11 m), and in the patterns beyond the third, which D leaves out (0.2 %).

A warm rail (``mechanics.laws.thermal``) has the thermal offset T = sum_t amount_t warm_t in the same patterns,
to which U is added. Walls from a file that are not straight have a further offset W
(``mechanics.drawn_walls``). Warm and rigid walls have T and W but no F. On joints of finite
stiffness this holds for the nominal stiffness, and ``RailCompliance.at`` gives it for a factor
(``mechanics.rail_compliance.joint_terms``).
"""

from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST
from tipoff.mechanics.rail_compliance.patterns import (
    DEGREE,
    LEAST_DEGREE,
    LOW_DEGREE,
    MOST_DEGREE,
    PATTERNS,
    on_part,
)
from tipoff.mechanics.rail_compliance.record import (
    MODES,
    RailCompliance,
    content,
)
from tipoff.mechanics.rail_compliance.stations import cubic

__all__ = [
    "DEGREE",
    "LEAST",
    "LEAST_DEGREE",
    "LOW_DEGREE",
    "MODES",
    "MOST",
    "MOST_DEGREE",
    "PATTERNS",
    "RailCompliance",
    "content",
    "cubic",
    "on_part",
]
