"""The convention of ``axial`` and ``radial``: the size of an error of assembly and its clock angle.

    misalignment t at clock angle p     (cos t, sin t cos p, sin t sin p), unit vector of the thrust
    eccentricity r at clock angle a     (y, z) = (r sin a, r cos a)

The clock angle of a misalignment is counted from +Y towards +Z, that of an eccentricity from +Z towards
+Y. ``functions`` has ``sin`` and ``cos``: ``math`` for numbers, ``numpy`` for arrays. Axes are those of
the body.

A file of errors may state the components y and z of an error instead: of an eccentricity (m), and of a
misalignment its size (rad) along both axes, ``t cos p`` and ``t sin p``.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

OFFSETS = ("misalignment", "eccentricity")  # last names of the tables with axial and radial
COMPONENTS = ("y", "z")
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


def component(key: str) -> tuple[str, str] | None:
    """Table of an error and y or z, for a dotted key that is a component of one."""
    table, _, last = key.rpartition(".")
    is_component = last in COMPONENTS and table.rpartition(".")[2] in OFFSETS
    return (table, last) if is_component else None


def stored(key: str) -> str:
    """The key of a number of the scene with the same unit: the size of the error, for a component."""
    found = component(key)
    return f"{found[0]}.axial" if found else key


def components(table: str, axial: float, radial: float) -> dict[str, float]:
    """The components y and z of an error of this ``table``."""
    first, second = axes(_kind(table))
    return {first: axial * math.cos(radial), second: axial * math.sin(radial)}


def without_components(columns: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """``columns`` (n,) by dotted key, with components of errors as axial and radial; a missing component is
    zero. One number at a time: NumPy's vector code may round the end of an array differently."""
    found: dict[str, list[float]] = {}
    errors: dict[str, dict[str, Sequence[float]]] = {}
    for key, column in columns.items():
        if own := component(key):
            errors.setdefault(own[0], {})[own[1]] = column
        else:
            found[key] = list(column)
    for table, parts in errors.items():
        nothing = [0.0] * len(next(iter(parts.values())))
        first, second = (parts.get(axis, nothing) for axis in axes(_kind(table)))
        pairs = list(zip(first, second))
        found[f"{table}.axial"] = [math.hypot(*pair) for pair in pairs]
        found[f"{table}.radial"] = [math.atan2(b, a) for a, b in pairs]
    return found


def _kind(table: str) -> str:
    """The table whose convention of angles ``table`` has."""
    return MISALIGNMENT if table.endswith("misalignment") else ECCENTRICITIES[0]
