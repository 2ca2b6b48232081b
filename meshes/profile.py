"""Extruded rails of any section as hexahedra: quadrilaterals in the section, layers along X.

Scene frame. Quadrilaterals fill the outline (``meshes.quadrilaterals``). The layers have one length if
a length near the wanted one divides every interval between borders, because the solver needs fewer
products for equal layers (``l_rail.layer_length``). Mirror images have the same bits. A surface is
known by the side of the section that it stands on; no box is needed.
"""

import itertools
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.meshes import bricks, l_rail, layers, msh, quadrilaterals

_ON = 1e-9  # m: a node closer to a side lies on it
# Corners of a hexahedron (VTK order) after a reflection across x, y
_REFLECTED = [3, 2, 1, 0, 7, 6, 5, 4]


class Profile(NamedTuple):
    """A rail of one section."""

    loops: tuple[tuple[tuple[float, float], ...], ...]  # m, y and z of corners, metal on the left
    blocks: quadrilaterals.Blocks  # m, four corners of each; none to mesh the loops
    area: float  # m2
    walls: tuple[int, ...]  # numbers of the sides that pads touch
    mounted: tuple[int, ...]  # numbers of the sides that the platform holds
    ends: tuple[float, float]  # m, X
    spans: tuple[tuple[float, float], ...]  # m, mounts from the rear end
    stretch: float  # length of a layer over the element size
    images: tuple[tuple[int, int], ...]  # signs of y and z of each rail


def build(profile: Profile, element_size: float) -> meshio.Mesh:
    """Mesh the rails: one `hexahedron` block (volume `rail`), and one `quad` block per surface, `mount`
    and `contact_N` for each wall, N the number of its side.

    Raises GmshUnavailable, and ValueError if gmsh cannot fill the section.
    """
    section, quads = quadrilaterals.of_outline(profile.loops, element_size, profile.blocks)
    stations = _stations(profile, element_size)
    points, hexes = layers.extruded(section, quads, stations)
    facets, side, layer = _facets(profile, section, quads, len(stations))
    middle = 0.5 * (stations[1:] + stations[:-1]) - profile.ends[0]
    held = np.any([(a < middle) & (middle < b) for a, b in profile.spans], axis=0)
    surfaces = {f"contact_{wall}": facets[side == wall] for wall in profile.walls}
    surfaces["mount"] = facets[np.isin(side, profile.mounted) & held[layer]]
    return msh.tagged(*_images(profile.images, points, hexes, surfaces))


def elements(profile: Profile, element_size: float) -> int:
    """Number of elements of ``build``, about; without making them."""
    ends = quadrilaterals.sides(profile.loops)
    border = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    # gmsh adds elements along the border, to fit corners and thin walls
    across = profile.area / element_size**2 + 0.5 * border / element_size
    return len(profile.images) * round(across * (len(_stations(profile, element_size)) - 1))


def _stations(profile: Profile, element_size: float) -> np.ndarray:
    """Planes (k,) m of the layers."""
    start, end = profile.ends
    borders = sorted({0.0, end - start, *itertools.chain.from_iterable(profile.spans)})
    planes = [a for a, b in itertools.pairwise([*borders, np.inf]) if b - a > _ON]
    layer = l_rail.layer_length(planes, profile.stretch * element_size)
    counts = [l_rail.divisions(b - a, layer) for a, b in itertools.pairwise(planes)]
    return start + bricks.divided(np.array(planes), counts)


def _facets(
    profile: Profile, section: np.ndarray, quads: np.ndarray, stations: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Facets (m,4) of the outside, seen from there anticlockwise, the side (m,) of the section and the
    layer (m,) of each."""
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    _, first, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
    )
    edges = edges[first[count == 1]]
    side = _sides(profile, section[edges])
    low = len(section) * np.arange(stations - 1)[:, None]
    a, b = low + edges[:, 0], low + edges[:, 1]
    facets = np.stack([a, a + len(section), b + len(section), b], axis=2)
    # metal is on the left of an edge, so X, the edge and the outside are left-handed
    return (
        facets[:, :, ::-1].reshape(-1, 4),
        np.tile(side, stations - 1),
        np.repeat(np.arange(stations - 1), len(edges)),
    )


def _sides(profile: Profile, edges: np.ndarray) -> np.ndarray:
    """Number (m,) of the side that holds both ends of each of the ``edges`` (m,2,2) m."""
    found = np.full(len(edges), -1)
    for number, (start, end) in enumerate(quadrilaterals.sides(profile.loops)):
        along = (end - start) / np.linalg.norm(end - start)
        there = edges - start
        off = np.abs(along[0] * there[..., 1] - along[1] * there[..., 0])
        place = there @ along
        on = (off < _ON) & (place > -_ON) & (place < np.linalg.norm(end - start) + _ON)
        found[on.all(axis=1)] = number
    return found


def _images(images, points, hexes, surfaces):
    """The rails of all ``images``, with elements whose corners are numbered alike."""
    count, every = len(points), []
    for number, (y, z) in enumerate(images):
        turned = y * z < 0
        every.append(
            (
                points * (1.0, y, z),
                (hexes[:, _REFLECTED] if turned else hexes) + number * count,
                {
                    name: (facets[:, ::-1] if turned else facets) + number * count
                    for name, facets in surfaces.items()
                },
            )
        )
    return (
        np.concatenate([each[0] for each in every]),
        np.concatenate([each[1] for each in every]),
        {name: np.concatenate([each[2][name] for each in every]) for name in surfaces},
    )
