"""Hexahedra from quadrilaterals of a section, in layers along X."""

import numpy as np


def quadrilaterals(gmsh, size: float, faces: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Points (s,2) m, Y and Z, and anticlockwise corners (q,4) of quadrilaterals that fill ``faces`` of
    the model, all in one plane across X; ``size`` (m) as gmsh understands it."""
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    gmsh.model.mesh.generate(2)
    places, quads = _of_faces(gmsh, faces)
    used, number = np.unique(quads, return_inverse=True)
    section, quads = places[used, 1:], number.reshape(-1, 4)
    a, b, c = (section[quads[:, i]] for i in range(3))
    clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - b[:, 1]) < (b[:, 1] - a[:, 1]) * (
        c[:, 0] - b[:, 0]
    )
    quads[clockwise] = quads[clockwise][:, ::-1]
    return section, quads


def _of_faces(gmsh, faces: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """All points (n,3) m of the mesh and the corners (q,4) of the quadrilaterals on some faces."""
    tags, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    kind = gmsh.model.mesh.getElementType("Quadrangle", 1)
    nodes = [gmsh.model.mesh.getElementsByType(kind, face)[1] for face in faces]
    return places.reshape(-1, 3), number[np.concatenate(nodes).astype(np.int64)].reshape(-1, 4)


def extruded(
    section: np.ndarray, quads: np.ndarray, stations: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) m and hexahedra (e,8), VTK order, of anticlockwise ``quads`` (q,4) between points
    (s,2) m of a section, in layers between the ``stations`` (k,) m. Points and elements have the
    order of the layers."""
    layer = len(section) * np.arange(len(stations))[:, None, None] + quads
    points = np.column_stack(
        [np.repeat(stations, len(section)), np.tile(section, (len(stations), 1))]
    )
    return points, np.concatenate([layer[:-1], layer[1:]], axis=2).reshape(-1, 8)
