"""Elements with named surfaces as meshio objects, tagged so that memory and a gmsh file give the
same."""

from pathlib import Path

import meshio
import numpy as np

VOLUME = "rail"
# of elements and facets, by the nodes of an element
_TYPES = {8: ("hexahedron", "quad"), 10: ("tetra10", "triangle6")}


def tagged(
    points: np.ndarray, elements: np.ndarray, surfaces: dict[str, np.ndarray]
) -> meshio.Mesh:
    """One block (volume `rail`) of elements (e,8) or (e,10) and one per named surface (m,4) or
    (m,6), numbered from 0."""
    solid, face = _TYPES[elements.shape[1]]
    cells = [(solid, elements), *((face, facets) for facets in surfaces.values())]
    tags = [len(surfaces) + 1, *range(1, len(surfaces) + 1)]
    blocks = [np.full(len(block), tag, dtype=np.int32) for tag, (_, block) in zip(tags, cells)]
    field_data = {
        name: np.array([tag, 2], dtype=np.int32) for tag, name in enumerate(surfaces, start=1)
    }
    field_data[VOLUME] = np.array([tags[0], 3], dtype=np.int32)
    return meshio.Mesh(
        points,
        cells,
        field_data=field_data,
        cell_data={"gmsh:physical": blocks, "gmsh:geometrical": [block.copy() for block in blocks]},
    )


def save(mesh: meshio.Mesh, path) -> None:
    """Write `mesh` as a binary gmsh 2.2 file, a format most finite-element tools still read."""
    meshio.gmsh.write(Path(path), mesh, fmt_version="2.2", binary=True)
