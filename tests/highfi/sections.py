"""One rail of a tee, a channel or a box on three mounts, meshed at any size, and the pad that
presses it. Its back is clamped on all of its width, or both sides of the web of the tee."""

import numpy as np

from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.mechanics.model import Faces
from tipoff.meshes import bricks
from tipoff.scenes.rail_base import MaterialTable

LENGTH = 0.22  # m
MOUNTS = ((0.008, 0.028), (0.1, 0.12), (0.192, 0.212))  # m along X
# Rectangles of metal, y and z from and to, in mm. The wall is at y = 0.
_TEE = ((0, 4, -10, 10), (4, 24, -2, 2))
RECTANGLES = {
    "tee": _TEE,
    "tee by its web": _TEE,
    "channel": ((0, 4, -15, 15), (4, 20, -15, -11), (4, 20, 11, 15)),
    "box": ((0, 4, -15, 15), (20, 24, -15, 15), (4, 20, -15, -11), (4, 20, 11, 15)),
}
SAME = 1e-9  # m
ALUMINIUM = MaterialTable.model_validate(
    {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
    context={"bare_numbers_are_si": True},
)


def divided(borders, size: float) -> np.ndarray:
    """Places (m) from border to border, about ``size`` (m) apart."""
    borders = np.unique(np.round(borders, 9))
    counts = np.maximum(1, np.ceil(np.diff(borders) / size - 0.5 - 1e-6)).astype(int)
    return bricks.divided(borders, counts)


def along(size: float) -> np.ndarray:
    """Planes (m) of the mesh along X."""
    return divided([0.0, LENGTH, *np.ravel(MOUNTS)], size)


def rail(section: str, size: float) -> RailMesh:
    """A rail in elements of ``size`` (m)."""
    parts = 1e-3 * np.array(RECTANGLES[section])
    lines = along(size), divided(parts[:, :2], size), divided(parts[:, 2:], size)
    y, z = (0.5 * (line[1:] + line[:-1]) for line in lines[1:])
    metal = np.any(
        [((a < y) & (y < b))[:, None] & ((c < z) & (z < d)) for a, b, c, d in parts], axis=0
    )
    points, cells = bricks.filled(
        list(lines), np.broadcast_to(metal, (len(lines[0]) - 1, *metal.shape))
    )
    facets = boundary_facets(cells)
    at = points[facets]
    back = np.abs(at[:, :, 1] - parts[:, 1].max()) < SAME
    if section.endswith("web"):
        low, _, _, side = parts[1]
        back = (np.abs(np.abs(at[:, :, 2]) - side) < SAME) & (at[:, :, 1] > low - SAME)
    return _named(points, cells, facets, np.abs(at[:, :, 1]) < SAME, back)


def _named(points, cells, facets, wall, back) -> RailMesh:
    middle = points[facets][:, :, 0].mean(axis=1)
    held = np.any([(start < middle) & (middle < end) for start, end in MOUNTS], axis=0)
    return RailMesh(
        points,
        cells,
        {"contact": facets[wall.all(axis=1)], "mount": facets[back.all(axis=1) & held]},
    )


def pad() -> Faces:
    """One face of 16 x 16 mm at the rear end of the wall."""
    one = np.ones(1)
    return Faces(
        centre=np.array([[0.008, 0.0, 0.0]]),
        axis=np.array([1]),
        sign=one,
        half_length=0.008 * one,
        half_width=0.008 * one,
        relief=0.0 * one,
        wall=0.0 * one,
        pad=np.array([0]),
        guide=np.array([0]),
    )
