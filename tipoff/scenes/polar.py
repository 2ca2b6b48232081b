"""The convention of ``axial`` and ``radial``: the size of an error of assembly and its clock angle.

    misalignment t at clock angle p     (cos t, sin t cos p, sin t sin p), unit vector of the thrust
    eccentricity r at clock angle a     (y, z) = (r sin a, r cos a)

The clock angle of a misalignment is counted from +Y towards +Z, that of an eccentricity from +Z towards
+Y. ``functions`` has ``sin`` and ``cos``: ``math`` for numbers, ``numpy`` for arrays. Axes are those of
the body.
"""

import math
from typing import Any

MISALIGNMENT = "thrust_offset.misalignment"
ECCENTRICITIES = ("thrust_offset.eccentricity", "mass_offset.eccentricity")


def direction(axial: Any, radial: Any, functions: Any = math) -> tuple[Any, Any, Any]:
    """Unit vector of a thrust with a misalignment (rad) at a clock angle (rad)."""
    sine = functions.sin(axial)
    return functions.cos(axial), sine * functions.cos(radial), sine * functions.sin(radial)


def offset(axial: Any, radial: Any, functions: Any = math) -> tuple[Any, Any]:
    """Offset (m) along y and z of an eccentricity (m) at a clock angle (rad)."""
    return axial * functions.sin(radial), axial * functions.cos(radial)


def axes(table: str) -> tuple[str, str]:
    """The axes at the clock angles 0 and 90 deg of a ``table``."""
    return ("y", "z") if table == MISALIGNMENT else ("z", "y")
