"""The walls and mounts that a mesh file names, as faces on the boundary of its solids.

A face is identified by its corners. So surface elements of any order name faces of elements of any
order. A group of nodes names the faces on the boundary whose corners are all in it; it counts where
no surface elements have its name.
"""

import meshio
import numpy as np

from tipoff.highfi.mesh.cells import Kind
from tipoff.highfi.mesh.file_elements import corners
from tipoff.highfi.mesh.files.tables import is_surface

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

    def keys(self) -> np.ndarray:
        """Corners (f,w) of every face in ascending order."""
        return np.array(list(self._place), dtype=np.int64).reshape(-1, self.width)

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


def named_surfaces(mesh: meshio.Mesh, boundary: Boundary) -> dict[str, np.ndarray]:
    """Corners (m,w) of the facets of each wall and mount: from cell sets, from physical tags of a
    mesh made in memory, or from sets of points."""
    groups: dict[str, list[np.ndarray]] = {}
    physical = mesh.cell_data.get("gmsh:physical")
    for index, block in enumerate(mesh.cells):
        if _CORNERS.get(block.type) != boundary.width:
            continue
        facets = block.data[:, : boundary.width].astype(np.int64)
        if physical is not None:
            for name, (tag, dimension) in mesh.field_data.items():
                if dimension == 2 and is_surface(name):
                    groups.setdefault(name, []).append(facets[physical[index] == tag])
        for name, members in mesh.cell_sets.items():
            # If both exist, they give the same group.
            if is_surface(name) and name not in mesh.field_data and members[index] is not None:
                groups.setdefault(name, []).append(
                    facets[np.asarray(members[index], dtype=np.int64)]
                )
    merged = {name: np.concatenate(parts) for name, parts in groups.items()}
    found = {name: facets for name, facets in merged.items() if len(facets)}
    keys = boundary.keys()
    for name, nodes in mesh.point_sets.items():
        if is_surface(name) and name not in found:
            inside = np.zeros(len(mesh.points), dtype=bool)
            inside[np.asarray(nodes, dtype=np.int64)] = True
            if len(facets := keys[inside[keys].all(axis=1)]):
                found[name] = facets
    return found
