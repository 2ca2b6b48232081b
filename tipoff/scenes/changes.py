"""Changes of numbers of a scene: amounts that are added to the values of the scene and its
condition.

An error of mounting is common to all conditions, and each condition may have its own deviation too.
So the error is added and does not replace. The tables of a direction and of an eccentricity are
polar; changes of them are components along y and z, which also have a meaning at zero::

    misalignment   (y, z) = axial (cos radial, sin radial)
    eccentricity   (y, z) = axial (sin radial, cos radial)

An absent table counts as zero.
"""

import math
from collections.abc import Mapping

from tipoff.scenes import overrides as keys
from tipoff.scenes import polar
from tipoff.scenes.scene import Scene

_POLAR = (polar.MISALIGNMENT, *polar.ECCENTRICITIES)  # tables


def overrides(scene: Scene, changes: Mapping[str, float]) -> dict[str, float]:
    """Overrides (SI) of ``scene`` that add ``changes`` (SI) by dotted key; keys of a polar table end
    on ``.y`` and ``.z``."""
    found: dict[str, float] = {}
    for key in changes:
        table, _, _ = key.rpartition(".")
        if table not in _POLAR:
            found[key] = stated(scene, key) + changes[key]
        elif f"{table}.axial" not in found:
            axial, radial = stated(scene, f"{table}.axial"), stated(scene, f"{table}.radial")
            first, second = axial * math.cos(radial), axial * math.sin(radial)
            along, aside = (f"{table}.{axis}" for axis in polar.axes(table))
            first, second = first + changes.get(along, 0.0), second + changes.get(aside, 0.0)
            found[f"{table}.axial"] = math.hypot(first, second)
            found[f"{table}.radial"] = math.atan2(second, first)
    return found


def stated(scene: Scene, key: str) -> float:
    """The number (SI) under a dotted ``key``, 0 if a table on the way is absent. An unknown key is
    left to the scene, which refuses it."""
    found = keys.held(scene, key)
    return 0.0 if found is None else float(found)
