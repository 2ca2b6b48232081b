"""A free platform that recoils: a second rigid body that carries the rails.

Mass, inertia and mass centre are those of the whole platform *with* its undeformed rails.
"""

from typing import NamedTuple

import numpy as np


class Platform(NamedTuple):
    """Kernel record of the platform."""

    mass: float  # kg
    inertia: np.ndarray  # (3,3) kg m2
    inverse_inertia: np.ndarray  # (3,3) 1/(kg m2)
    mass_centre: tuple  # (3,) m, at ignition
