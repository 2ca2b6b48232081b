"""Quadrilaterals that fill the outline of a section: in its blocks if these are known, in a grid if every
side is along Y or Z, else by gmsh.

gmsh makes two or more across every side; their shapes are good from elements of half a wall on.
"""

import itertools

import numpy as np

from tipoff.meshes import blocks, bricks, generator, layers

Loops = tuple[tuple[tuple[float, float], ...], ...]
Blocks = Loops

_ON = 1e-9  # m: corners closer than this are on one line
_THIN = 0.25  # of the element size: a grid with thinner cells is left to gmsh


def of_outline(
    loops: Loops, element_size: float, known: Blocks = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Points (s,2) m, Y and Z, and anticlockwise corners (q,4) of quadrilaterals about
    ``element_size`` (m); each side is between nodes. ``loops`` have metal on the left.
    ``known`` blocks of four anticlockwise corners each fill them.

    Raises GmshUnavailable, and ValueError if gmsh cannot fill the outline.
    """
    if known:
        return blocks.divided(np.array(known), element_size)
    lines = _grid_lines(loops)
    if lines and min(np.diff(line).min() for line in lines) >= _THIN * element_size:
        return _grid(loops, lines, element_size)
    return _by_gmsh(loops, element_size)


def sides(loops: Loops) -> np.ndarray:
    """Both ends (n,2,2) m of each side, loop by loop."""
    return np.array([ends for loop in loops for ends in zip(loop, loop[1:] + loop[:1])])


def _grid_lines(loops: Loops) -> list[np.ndarray]:
    """Places (m) of the corners along Y and along Z; none if a side is inclined."""
    ends = sides(loops)
    if (np.abs(ends[:, 1] - ends[:, 0]).min(axis=1) > _ON).any():
        return []
    places = [np.sort(ends[:, 0, axis]) for axis in (0, 1)]
    return [each[np.append(True, np.diff(each) > _ON)] for each in places]


def _grid(
    loops: Loops, lines: list[np.ndarray], element_size: float
) -> tuple[np.ndarray, np.ndarray]:
    counts = [np.maximum(1, np.round(np.diff(line) / element_size).astype(int)) for line in lines]
    fine = [bricks.divided(line, count) for line, count in zip(lines, counts)]
    y, z = (0.5 * (line[1:] + line[:-1]) for line in fine)
    metal = _inside(loops, np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1))
    points, hexes = bricks.filled([np.array([0.0, 1.0]), *fine], metal[None])
    count = len(points) // 2
    return points[:count, 1:], hexes[:, [0, 3, 7, 4]]


def _inside(loops: Loops, places: np.ndarray) -> np.ndarray:
    """Which places (p,q,2) m are in the metal: a ray along Y meets an odd number of sides."""
    odd = np.zeros(places.shape[:2], dtype=bool)
    for (a, b), (c, d) in sides(loops):
        if abs(b - d) > _ON:
            above = (b > places[..., 1]) != (d > places[..., 1])
            odd ^= above & (places[..., 0] < a + (places[..., 1] - b) * (c - a) / (d - b))
    return odd


def _by_gmsh(loops: Loops, element_size: float) -> tuple[np.ndarray, np.ndarray]:
    with generator.session("section") as gmsh:
        try:
            borders = []
            for loop in loops:
                corners = [gmsh.model.geo.addPoint(0.0, y, z) for y, z in loop]
                pairs = itertools.pairwise([*corners, corners[0]])
                lines = [gmsh.model.geo.addLine(a, b) for a, b in pairs]
                for line, (start, end) in zip(lines, sides((loop,))):
                    halves = max(1, round(float(np.linalg.norm(end - start)) / (2 * element_size)))
                    gmsh.model.geo.mesh.setTransfiniteCurve(line, 2 * halves + 1)
                borders.append(gmsh.model.geo.addCurveLoop(lines))
            face = gmsh.model.geo.addPlaneSurface(borders)
            gmsh.model.geo.synchronize()
            gmsh.option.setNumber("Mesh.Algorithm", 8)  # fronts of right angles
            gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 2)  # without triangles left
            gmsh.option.setNumber("Mesh.Smoothing", 10)
            return layers.quadrilaterals(gmsh, element_size, [face])
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(
                f"gmsh cannot fill it with elements of {element_size:g} m ({fault})"
            ) from fault
