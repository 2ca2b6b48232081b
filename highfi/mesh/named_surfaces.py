"""The walls and mounts that a mesh file names, as faces on the boundary of its solids.

A face is identified by its corners. So surface elements of any order name faces of elements of any
order. A group of nodes names the faces on the boundary whose corners are all in it; it counts where
no surface elements have its name.
"""

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import LEFT_OUT, any_case, is_surface
from tipoff.highfi.mesh.asked import AS_DRAWN, Asked
from tipoff.highfi.mesh.boxes import chosen
from tipoff.highfi.mesh.cells import Kind
from tipoff.highfi.mesh.file_elements import corners

# corners of the surface elements of files
_CORNERS = {
    **dict.fromkeys(("quad", "quad8", "quad9"), 4),
    **dict.fromkeys(("triangle", "triangle6", "triangle7"), 3),
}


class Boundary:
    """Faces that belong to one element (e,k) only."""

    def __init__(self, cells: np.ndarray, kind: Kind) -> None:
        table = corners(kind)
        faces = cells[:, table].reshape(-1, table.shape[1])
        keys, first, count = np.unique(
            np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
        )
        self.width, self._per_element = table.shape[1], len(table)
        alone = count == 1
        self._place = {tuple(key): place for key, place in zip(keys[alone].tolist(), first[alone])}
        self.faces = faces[first[alone]]  # (f,w) corners, counter-clockwise seen from outside

    def faults(self, surfaces: dict[str, np.ndarray]) -> list[str]:
        """Surfaces with facets that are elsewhere or appear twice."""
        found = []
        for name, given in surfaces.items():
            keys = [tuple(key) for key in np.sort(given, axis=1).tolist()]
            if astray := sum(key not in self._place for key in keys):
                found.append(
                    f"surface '{name}': {astray} of {len(keys)} facets are not on the boundary of "
                    "the solid"
                )
            if twice := len(keys) - len(set(keys)):
                found.append(f"surface '{name}': {twice} facets appear twice")
        return found

    def places(self, facets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Element and number of the face of each of some facets (m,w) on the boundary."""
        keys = np.sort(facets, axis=1).tolist()
        found = np.array([self._place[tuple(key)] for key in keys], dtype=np.int64)
        return found // self._per_element, found % self._per_element


def named_surfaces(
    mesh: meshio.Mesh, boundary: Boundary, asked: Asked = AS_DRAWN
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Corners (m,w) of the facets of each wall and mount, and what is wrong with their names: from
    boxes, from the groups that a scene names, or from groups with names of surfaces."""
    groups = _Groups(mesh, boundary)
    found, faults = {}, []
    own: dict[str, tuple[str, ...]] = {}
    for name in groups.names():
        if key := name if is_surface(name) else any_case(name):
            own[key] = (*own.get(key, ()), name)
    for name, given in {**own, **asked.groups}.items():
        if name in asked.boxes:
            continue
        if left_out := [words for each in given if (words := groups.left_out(each))]:
            faults.append(left_out[0])
            continue
        if unknown := [each for each in given if not groups.has(each)]:
            faults.append(f"no group '{unknown[0]}' (groups in the mesh: {groups.shown()})")
            continue
        facets = np.concatenate([groups.facets(each) for each in given])
        if len(given) > 1:  # a face may be in several groups
            _, first = np.unique(np.sort(facets, axis=1), axis=0, return_index=True)
            facets = facets[np.sort(first)]
        if asked.body:  # other bodies may have surfaces of this name too
            facets = facets[np.isin(facets, boundary.faces).all(axis=1)]
        if len(facets):
            found[name] = facets
    for name, boxes in asked.boxes.items():
        inside, wrong = chosen(mesh.points, boundary.faces, boxes)
        faults += [f"surface '{name}': {each}" for each in wrong]
        if inside.any():
            found[name] = boundary.faces[inside]
    return found, faults


class _Groups:
    """Groups of a mesh: cell sets, physical tags of a mesh made in memory, and sets of points."""

    def __init__(self, mesh: meshio.Mesh, boundary: Boundary) -> None:
        self._mesh, self._boundary = mesh, boundary
        self._physical = mesh.cell_data.get("gmsh:physical")
        every = (*mesh.field_data, *mesh.cell_sets, *mesh.point_sets)
        self._named = {name.lower(): name for name in reversed(every)}
        self._left_out: dict[str, str] = dict((mesh.info or {}).get(LEFT_OUT, {}))

    def names(self) -> list[str]:
        """All names, in the order of the file; then those of groups that are not read."""
        mesh = self._mesh
        named = (*mesh.field_data, *mesh.cell_sets, *mesh.point_sets, *self._left_out)
        return list(dict.fromkeys(named))

    def shown(self) -> str:
        """All names, as messages list them."""
        return ", ".join(sorted({*self._named.values()})) or "none"

    def has(self, name: str) -> bool:
        """Whether there is such a group, in letters of any case."""
        return name.lower() in self._named

    def left_out(self, name: str) -> str:
        """Why a group is not read, or not all of it; empty for others."""
        reasons = {key.lower(): reason for key, reason in self._left_out.items()}
        reason = reasons.get(name.lower(), "")
        return f"group '{name}' is not read: {reason}" if reason else ""

    def facets(self, name: str) -> np.ndarray:
        """Corners (m,w) of the facets of a group; of a set of points, the faces on the boundary
        between them."""
        mesh, width = self._mesh, self._boundary.width
        if name not in self.names():
            name = self._named[name.lower()]
        parts = [np.empty((0, width), dtype=np.int64)]
        for index, block in enumerate(mesh.cells):
            if _CORNERS.get(block.type) != width:
                continue
            facets = block.data[:, :width].astype(np.int64)
            # If both exist, they give the same group.
            if name in mesh.field_data and self._physical is not None:
                tag, dimension = mesh.field_data[name]
                if dimension == 2:
                    parts.append(facets[self._physical[index] == tag])
            elif name in mesh.cell_sets and mesh.cell_sets[name][index] is not None:
                parts.append(facets[np.asarray(mesh.cell_sets[name][index], dtype=np.int64)])
        found = np.concatenate(parts)
        if not len(found) and name in mesh.point_sets:
            inside = np.zeros(len(mesh.points), dtype=bool)
            inside[np.asarray(mesh.point_sets[name], dtype=np.int64)] = True
            found = self._boundary.faces[inside[self._boundary.faces].all(axis=1)]
        return found
