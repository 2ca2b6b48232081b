"""Four L-section launch rails as structured hexahedra.

Scene frame: SI, origin at the payload mass centre at t = 0, +X to the open end. One rail is at each
corner (sign_y, sign_z) = (+-1, +-1). Its outer corner edge is at |y| = inner_corner_y + thickness,
|z| = inner_corner_z + thickness. Its inner walls |y| = inner_corner_y and |z| = inner_corner_z face
the payload.

A grid gives the rail of the (+,+) corner. A fillet between the inner walls moves its nodes
(``fillet``). The other three rails are mirror images with the same bits, so that a symmetric scene
has a symmetric result; their elements are numbered along the axes again, since a reflection
reverses their orientation. A section of rectangles needs no mesh generator; the tests compare with
one.
"""

import itertools
import math
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.meshes import bricks, fillet, msh

SURFACES = ("contact_y", "contact_z", "mount")

_CORNERS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
# Corners of a brick in VTK order after a reflection of y, and of z.
_REFLECTED_Y, _REFLECTED_Z = [3, 2, 1, 0, 7, 6, 5, 4], [4, 5, 6, 7, 0, 1, 2, 3]
# Corners of a brick of the grid, inwards from the outer corner: its faces towards the payload and
# towards the platform.
_INWARD_Y, _INWARD_Z, _OUTWARD_Y, _OUTWARD_Z = (
    [3, 7, 6, 2],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [0, 3, 2, 1],
)
_TOUCH = 1e-9  # m; coordinates closer than this are on the same plane
# of the element size: its largest difference from a common length of all layers
_EVEN = 0.1


class LRailGeometry(NamedTuple):
    """Dimensions of the rails in m."""

    leg: float = 0.024
    thickness: float = 0.004
    x_start: float = -0.088
    x_end: float = 0.132
    inner_corner_y: float = 0.10025
    inner_corner_z: float = 0.10025
    # from the rear end of the rail
    mount_spans: tuple[tuple[float, float], ...] = ((0.008, 0.028), (0.100, 0.120), (0.192, 0.212))
    mount_width: float = 0.004  # from the outer corner
    fillet: float = 0.0  # radius between the inner walls, 0 for a sharp corner


def build(geometry: LRailGeometry, element_size: float) -> meshio.Mesh:
    """Mesh the four rails; every border of a mount and of a wall is a grid plane, for any element
    size.

    Each interval between borders gets round(length / element_size) divisions, at least one. Along X
    all layers have the same length if a length near the element size divides every interval,
    because the solver needs fewer products for equal layers. With the default geometry all elements
    are cubes for sizes of 4, 2 and 1 mm. Contact walls end where a fillet begins.

    Returns a mesh with one `hexahedron` block (volume `rail`) and one `quad` block per surface in
    `SURFACES`, numbered from 0 and tagged with the field `gmsh:physical`. Raises ValueError for
    dimensions that do not make a rail.
    """
    _check(geometry, element_size)
    return msh.tagged(*_mirrored(*_corner_rail(geometry, element_size)))


def elements(geometry: LRailGeometry, element_size: float) -> int:
    """Number of elements of ``build``, without making them. Raises ValueError as it does."""
    _check(geometry, element_size)
    depths, stations = grid_depths(geometry), grid_stations(geometry)
    layer, across = (
        layer_length(stations, element_size),
        [divisions(b - a, element_size) for a, b in itertools.pairwise(depths)],
    )
    section = sum(across[i] * across[j] for i, j in section_cells(geometry, depths))
    return (
        len(_CORNERS)
        * section
        * sum(divisions(end - start, layer) for start, end in itertools.pairwise(stations))
    )


def grid_depths(geometry: LRailGeometry) -> list[float]:
    """Grid lines (m) of the section, measured inwards from the outer corner along y and along z."""
    end = geometry.thickness + geometry.fillet
    return _grid_lines(0.0, geometry.thickness, end, geometry.mount_width, geometry.leg)


def grid_stations(geometry: LRailGeometry) -> list[float]:
    """Grid planes along X (m)."""
    return _grid_lines(
        geometry.x_start,
        geometry.x_end,
        *(geometry.x_start + border for span in geometry.mount_spans for border in span),
    )


def section_cells(geometry: LRailGeometry, depths: list[float]) -> list[tuple[int, int]]:
    """Intervals (i,j) of ``depths`` (m) along y and along z whose rectangles lie inside the L."""
    return [
        (i, j)
        for i, j in itertools.product(range(len(depths) - 1), repeat=2)
        if min(depths[i], depths[j]) < geometry.thickness - _TOUCH
    ]


def _check(geometry: LRailGeometry, element_size: float) -> None:
    length = geometry.x_end - geometry.x_start
    borders = [0.0, *itertools.chain.from_iterable(geometry.mount_spans), length]
    if not 0.0 < element_size:
        raise ValueError(f"element_size must be positive, got {element_size!r}")
    if (
        not 0.0 < geometry.mount_width <= geometry.leg + _TOUCH
        or not 0.0 < geometry.thickness < geometry.leg
    ):
        raise ValueError(f"need 0 < thickness < leg and 0 < mount_width <= leg, got {geometry}")
    largest, inside = fillet.LARGEST * geometry.thickness, geometry.leg - geometry.thickness
    if not 0.0 <= geometry.fillet <= largest + _TOUCH or geometry.fillet > inside - _TOUCH:
        raise ValueError(
            f"need a fillet of 0 to {largest:g} m, less than {inside:g} m, got {geometry.fillet!r}"
        )
    if any(right < left - _TOUCH for left, right in itertools.pairwise(borders)) or length <= 0.0:
        raise ValueError(
            f"mount_spans must be in order and inside the length {length:g} m, got "
            f"{geometry.mount_spans}"
        )


def _grid_lines(*borders: float) -> list[float]:
    """The borders in order, without duplicates."""
    lines = sorted(borders)
    return lines[:1] + [right for left, right in itertools.pairwise(lines) if right - left > _TOUCH]


def layer_length(stations: list[float], element_size: float) -> float:
    """Length (m) that divides every interval between ``stations`` (m) and is within a tenth of
    ``element_size`` (m); ``element_size`` if there is none."""
    common = (
        math.gcd(*(round((right - left) / _TOUCH) for left, right in itertools.pairwise(stations)))
        * _TOUCH
    )
    even = common / divisions(common, element_size)
    return even if abs(even - element_size) <= _EVEN * element_size else element_size


def divisions(length: float, element_size: float) -> int:
    """Elements of about ``element_size`` (m) along ``length`` (m), at least one."""
    return max(1, round(length / element_size))


def _corner_rail(
    geometry: LRailGeometry, element_size: float
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Points (n,3), hexes (e,8) and facets per surface of the (+,+) rail: a grid along X and
    inwards from the outer corner, in right-handed axes like x, y and z."""
    depths, stations = np.array(grid_depths(geometry)), np.array(grid_stations(geometry))
    fine = bricks.divided(depths, _all_divisions(depths, element_size))
    along = bricks.divided(
        stations, _all_divisions(stations, layer_length(list(stations), element_size))
    )
    middle, station = (
        0.5 * (fine[1:] + fine[:-1]),
        0.5 * (along[1:] + along[:-1]) - geometry.x_start,
    )
    in_wall = middle < geometry.thickness
    metal = np.broadcast_to(in_wall[:, None] | in_wall, (len(station), len(middle), len(middle)))
    points, hexes = bricks.filled([along, fine, fine], metal)

    layer, in_y, in_z = np.argwhere(metal).T  # of each hexahedron
    held = np.array(
        [any(start < place < end for start, end in geometry.mount_spans) for place in station]
    )[layer]
    strip, wall = middle < geometry.mount_width, np.count_nonzero(in_wall)
    begun = np.count_nonzero(middle < geometry.thickness + geometry.fillet)
    contact_y = (in_y == wall - 1) & (in_z >= begun)
    contact_z = (in_z == wall - 1) & (in_y >= begun)
    back_y, back_z = held & (in_y == 0) & strip[in_z], held & (in_z == 0) & strip[in_y]
    surfaces = {
        "contact_y": hexes[contact_y][:, _INWARD_Y],
        "contact_z": hexes[contact_z][:, _INWARD_Z],
        "mount": np.concatenate([hexes[back_y][:, _OUTWARD_Y], hexes[back_z][:, _OUTWARD_Z]]),
    }
    outer = np.array(
        [
            0.0,
            geometry.inner_corner_y + geometry.thickness,
            geometry.inner_corner_z + geometry.thickness,
        ]
    )
    if geometry.fillet > 0.0:
        points[:, 1:] = fillet.rounded(points[:, 1:], geometry.thickness, geometry.fillet)
    return outer + points * (1, -1, -1), hexes, surfaces


def _all_divisions(borders: np.ndarray, element_size: float) -> list[int]:
    return [divisions(length, element_size) for length in np.diff(borders)]


def _mirrored(points, hexes, surfaces):
    """One rail per corner of the launcher, with elements numbered alike (see the module
    docstring)."""
    count = len(points)
    all_points = np.concatenate([points * (1, sign_y, sign_z) for sign_y, sign_z in _CORNERS])
    all_hexes = [_along_axes(hexes, *signs) + rail * count for rail, signs in enumerate(_CORNERS)]
    all_surfaces = {
        name: np.concatenate([facets + rail * count for rail in range(len(_CORNERS))])
        for name, facets in surfaces.items()
    }
    return all_points, np.concatenate(all_hexes), all_surfaces


def _along_axes(hexes, sign_y, sign_z):
    """Number the corners of the bricks of a rail in VTK order along +x, +y, +z: translated bricks
    are then equal. They are numbered inwards, so along -y and -z in the (+,+) corner."""
    if sign_y > 0:
        hexes = hexes[:, _REFLECTED_Y]
    return hexes[:, _REFLECTED_Z] if sign_z > 0 else hexes
