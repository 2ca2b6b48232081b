"""Boxes on a solid: the parts of its faces inside the boxes, their areas, and their borders drawn
onto the solid. So each element face is either inside or outside.

Places within ``SAME`` of a box count as inside, so that a box may be flat. But a face that only
touches a box from outside, at most ``2 SAME`` deep, has no part in it.
"""

from collections.abc import Mapping

import numpy as np

SAME = 1e-6  # m, largest distance of a node of a facet from the box that names it
_BEYOND = 1e-3  # m, length of a cutting tool beyond the end of a face

Boxes = Mapping[str, np.ndarray]  # name of a surface: (b,2,3) m, corners of its boxes


class Outside(ValueError):
    """Boxes without a face of the solid; ``extent`` (2,3) m of the solid."""

    def __init__(self, message: str, extent: np.ndarray):
        super().__init__(message)
        self.extent = extent


def areas(gmsh, boxes: Boxes) -> dict[str, float]:
    """Area (m2) of the faces of all solids inside the boxes of each surface; overlaps count once.

    Raises Outside with every box that contains no face.
    """
    found, empty = {}, []
    for name, given in boxes.items():
        parts: list[int] = []
        for number, box in enumerate(given):
            inside = _inside(gmsh, _faces(gmsh), box)
            parts += inside
            if not inside:
                empty.append(f"box {number + 1} of {name}, {_words(box)}")
        found[name] = _union(gmsh, parts)
        _remove_loose(gmsh)
    if empty:
        reach = extent(gmsh)
        spans = ", ".join(
            f"{axis} {low:.6g} to {high:.6g}" for axis, low, high in zip("xyz", *reach)
        )
        raise Outside(f"no face of the solid ({spans} m) lies in {'; '.join(empty)}", reach)
    return found


def draw(gmsh, boxes: list[np.ndarray], faces: list[list[int]]) -> None:
    """Draw the borders of each of the ``boxes`` (2,3) m onto its ``faces`` of the solids."""
    parts = {part for box, among in zip(boxes, faces) for part in _inside(gmsh, among, box)} - set(
        _faces(gmsh)
    )
    if not parts:
        return
    solids = gmsh.model.getEntities(3)
    gmsh.model.occ.fragment(solids, [(2, part) for part in sorted(parts)])
    gmsh.model.occ.synchronize()
    _remove_loose(gmsh)


def _remove_loose(gmsh) -> None:
    """Remove the faces that belong to no solid."""
    solids = gmsh.model.getEntities(3)
    bounds = {abs(tag) for _, tag in gmsh.model.getBoundary(solids, combined=False)}
    loose = [(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in bounds]
    gmsh.model.occ.remove(loose, recursive=True)
    gmsh.model.occ.synchronize()


def extent(gmsh) -> np.ndarray:
    """Lowest and highest place (2,3) m of all corners of the model."""
    corners = np.array([gmsh.model.getValue(0, tag, []) for _, tag in gmsh.model.getEntities(0)])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def _faces(gmsh) -> list[int]:
    """Faces that belong to one solid only."""
    solids = gmsh.model.getEntities(3)
    return sorted(abs(tag) for _, tag in gmsh.model.getBoundary(solids, combined=True))


def _inside(gmsh, faces: list[int], box: np.ndarray) -> list[int]:
    """Parts of ``faces`` inside a ``box`` (2,3) m: separate faces, or a whole face."""
    parts = []
    for face in faces:
        bounds = np.array(gmsh.model.getBoundingBox(2, face)).reshape(2, 3)
        is_flat = np.ptp(bounds, axis=0) < SAME
        shared = np.minimum(bounds[1], box[1]) - np.maximum(bounds[0], box[0])
        if not np.where(is_flat, shared > -SAME, shared > 2.0 * SAME).all():
            continue
        covered = np.array([box[0] < bounds[0] + SAME, box[1] > bounds[1] - SAME])
        if covered.all():
            parts.append(face)
            continue
        tool = np.where(covered, bounds + _BEYOND * np.array([[-1.0], [1.0]]), box)
        cutter = gmsh.model.occ.addBox(*tool[0], *np.ptp(tool, axis=0))
        found, _ = gmsh.model.occ.intersect(
            [(2, face)], [(3, cutter)], removeObject=False, removeTool=True
        )
        parts += [tag for dimension, tag in found if dimension == 2]
    gmsh.model.occ.synchronize()
    return parts


def _union(gmsh, faces: list[int]) -> float:
    """Area (m2) of faces; overlaps count once."""
    copies = gmsh.model.occ.copy([(2, face) for face in faces]) if faces else []
    if len(copies) > 1:
        copies, _ = gmsh.model.occ.fragment(copies[:1], copies[1:])
    area = sum(gmsh.model.occ.getMass(2, face) for _, face in set(copies))
    gmsh.model.occ.remove(copies, recursive=True)
    gmsh.model.occ.synchronize()
    return area


def _words(box: np.ndarray) -> str:
    low, high = (", ".join(f"{value:.6g}" for value in corner) for corner in box)
    return f"({low}) to ({high}) m"
