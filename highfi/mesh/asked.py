"""What a scene says of a mesh file: its unit, its axes and its origin, the body to use, and the groups
and boxes that are walls and mounts.

A node at p in the file, with lengths in a unit of s metres, is in the scene at

    x = R (s p - o)    with the rows of R the scene's axes and o its origin, both in axes of the file.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from tipoff.scenes.rail import MeshTable, directions
from tipoff.units import LENGTHS_OF_FILES


class Asked(NamedTuple):
    """What a scene says of a mesh file."""

    unit: str = "m"
    axes: tuple[str, str, str] = ("x", "y", "z")
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m
    body: str = ""  # group of solids; empty for all
    groups: Mapping[str, tuple[str, ...]] = MappingProxyType({})  # by the surface that they are
    boxes: Mapping[str, np.ndarray] = MappingProxyType({})  # (b,2,3) m, by their surface

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Points (n,3) m in scene axes. Those of a file in scene axes keep every bit."""
        if self[:3] == Asked()[:3]:
            return points
        return (LENGTHS_OF_FILES[self.unit] * points - np.array(self.origin)) @ np.array(
            directions(self.axes)
        ).T


AS_DRAWN = Asked()


def asked(rail: MeshTable) -> Asked:
    """What the table of a mesh file says."""
    boxes = {
        name: np.array([(box.low, box.high) for box in given])
        for name, given in (rail.surfaces or {}).items()
    }
    return Asked(
        unit=rail.unit or "m",
        axes=rail.axes or ("x", "y", "z"),
        origin=rail.origin or (0.0, 0.0, 0.0),
        body=rail.body or "",
        groups=rail.groups or {},
        boxes=boxes,
    )


def axes_along(rail: MeshTable, longest: int) -> str:
    """The value of ``axes`` that turns the rail from this axis of the scene to X."""
    own = rail.axes[longest][-1] if rail.axes else "xyz"[longest]
    start = "xyz".index(own)
    return "[" + ", ".join(f'"{axis}"' for axis in ("xyz" * 2)[start : start + 3]) + "]"
