"""Rails at an uneven temperature: linear in position, and constant during a launch.

T is the change of temperature since the rails were mounted free of stress, X_m the middle of their
length on the payload's axis, alpha the coefficient of expansion and s the strain of the platform
that carries the mounts::

    T = mean + gradient . (X - X_m),      free strain alpha T in every direction,      mounts moved by s (X - X_m)

Example: rails that are 20 K warmer than those at a distance of 0.2 m have a gradient of 0.1 K/mm. A
platform with the temperature and the expansion of its rails has s = alpha mean, and the rails stay
free of stress.
"""

from typing import NamedTuple

import numpy as np

# every [thermal] is a sum of these fields: a free strain, its gradients along x, y and z, and the
# strain of the platform
FIELDS = 5


class Thermal(NamedTuple):
    """Plain record of the temperature."""

    # (FIELDS,) amount of each field: free strain at X_m (1), its gradients (1/m), strain of the
    # platform (1)
    amounts: np.ndarray
    middle: float  # m, X_m in scene axes


def fields(points: np.ndarray, middle: float) -> np.ndarray:
    """Unit values of the four fields of free strain (n,4) at ``points`` (n,3) m in scene axes."""
    return np.column_stack([np.ones(len(points)), np.subtract(points, [middle, 0.0, 0.0])])
