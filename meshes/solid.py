"""A solid from a CAD file (STEP, IGES, BREP) as hexahedra or as quadratic tetrahedra, made with
gmsh.

A solid whose faces are all plane and parallel to the axes is a set of bricks: the planes of its
faces divide space into cells, each of which is metal or not. A solid with one section along X is
meshed as an extrusion of this section in quadrilaterals. Any other solid is filled with tetrahedra
of twice the element size, each split into four hexahedra at the centres of its edges and faces;
such elements are skewed, which shortens the step and makes thin walls too stiff. Quadratic
tetrahedra, on request, have ten nodes, about ``element_size`` apart, and edges that follow curved
faces.
"""

from pathlib import Path

import numpy as np

from tipoff.meshes import bricks, generator

_SAME = 1e-9  # m: two planes closer than this are one
_TIE = 1e-6  # divisions
_PROBES = 9  # points of an edge at which its curvature is tested
_TETRAHEDRON = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # nodes of gmsh's quadratic tetrahedron in VTK order


def build(
    path: Path, element_size: float, planes: np.ndarray, tetrahedra: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) m and hexahedra (e,8), or tetrahedra (e,10), VTK order, of every solid in a
    file, whatever its length unit.

    ``planes`` (p,3) m: places along x, y and z at which elements should have borders. Bricks have
    them at all of these, an extruded section at those along x, tetrahedra at none. Raises
    ValueError for a file without a solid that gmsh can read, GmshUnavailable where gmsh does not
    load.
    """
    with generator.session("solid") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "M")
        try:
            gmsh.model.occ.importShapes(str(path))
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(f"gmsh does not read it ({fault})") from fault
        gmsh.model.occ.removeAllDuplicates()  # solids that touch share the face between them
        gmsh.model.occ.synchronize()
        volumes = [tag for _, tag in gmsh.model.getEntities(3)]
        if not volumes:
            raise ValueError("it holds no solid")
        if not tetrahedra and _is_bricks(gmsh):
            return _bricks(gmsh, volumes, element_size, planes)
        try:
            if tetrahedra:
                return _tetrahedra(gmsh, element_size)
            return (
                _extruded(gmsh, element_size, planes)
                if _is_extruded(gmsh)
                else _split_tetrahedra(gmsh, element_size)
            )
        except Exception as fault:  # gmsh knows no other class
            raise ValueError(
                f"gmsh cannot fill it with elements of {element_size:g} m ({fault})"
            ) from fault


def _vertices(gmsh, dimension: int, tag: int) -> np.ndarray:
    """Corners (v,3) m of an entity, of all entities of the dimension for tag -1."""
    entities = gmsh.model.getEntities(dimension) if tag == -1 else [(dimension, tag)]
    ends = gmsh.model.getBoundary(entities, combined=False, recursive=True)
    return np.array([gmsh.model.getValue(0, point, []) for _, point in ends])


def _is_bricks(gmsh) -> bool:
    straight = all(gmsh.model.getType(1, tag) == "Line" for _, tag in gmsh.model.getEntities(1))
    return straight and all(
        (np.ptp(_vertices(gmsh, 2, tag), axis=0) < _SAME).any()
        for _, tag in gmsh.model.getEntities(2)
    )


def _bricks(
    gmsh, volumes: list[int], element_size: float, planes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Cells between all planes that lie in a solid, each interval with about length / element_size
    divisions, one at least."""
    corners = _vertices(gmsh, 3, -1)
    lines = [_different(corners[:, axis], planes[:, axis]) for axis in range(3)]
    middles = [0.5 * (line[1:] + line[:-1]) for line in lines]
    metal = np.zeros([len(middle) for middle in middles], dtype=bool)
    for cell in np.ndindex(metal.shape):
        place = [float(middle[i]) for middle, i in zip(middles, cell)]
        metal[cell] = any(gmsh.model.isInside(3, volume, place) for volume in volumes)
    for axis, line in enumerate(lines):
        metal = np.repeat(metal, _divisions(line, element_size), axis=axis)
    return bricks.filled([_divided(line, element_size) for line in lines], metal)


def _different(solid: np.ndarray, requested: np.ndarray) -> np.ndarray:
    """Positions of the solid's own planes and of the requested ones inside it, in order, without
    duplicates."""
    inside = (requested > solid.min()) & (requested < solid.max())
    places = np.sort(np.concatenate([solid, requested[inside]]))
    return places[np.append(True, np.diff(places) > _SAME)]


def _divisions(line: np.ndarray, element_size: float) -> np.ndarray:
    """Elements in each interval. Halves are rounded down whatever the rounding of positions, so
    that symmetric solids get symmetric meshes."""
    return np.maximum(1, np.ceil(np.diff(line) / element_size - 0.5 - _TIE).astype(int))


def _divided(line: np.ndarray, element_size: float) -> np.ndarray:
    """All borders of elements along a line of places."""
    return bricks.divided(line, _divisions(line, element_size))


def _is_extruded(gmsh) -> bool:
    """Whether every edge runs along X from one end to the other, or lies in one of the two end
    planes."""
    x = _vertices(gmsh, 3, -1)[:, 0]
    for _, edge in gmsh.model.getEntities(1):
        low, high = np.array(gmsh.model.getParametrizationBounds(1, edge)).ravel()
        along = np.array(gmsh.model.getValue(1, edge, np.linspace(low, high, _PROBES))).reshape(
            -1, 3
        )
        across = np.ptp(along, axis=0)
        in_end = across[0] < _SAME and np.abs(along[0, 0] - [x.min(), x.max()]).min() < _SAME
        from_end_to_end = across[1:].max() < _SAME and abs(across[0] - np.ptp(x)) < _SAME
        if not (in_end or from_end_to_end):
            return False
    return True


def _extruded(gmsh, element_size: float, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = _different(_vertices(gmsh, 3, -1)[:, 0], planes[:, 0])
    stations = _divided(x, element_size)
    ends = [
        tag
        for _, tag in gmsh.model.getEntities(2)
        if np.abs(_vertices(gmsh, 2, tag)[:, 0] - x[0]).max() < _SAME
    ]
    _set_size(gmsh, 2.0 * element_size)
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    # halves every side, so that no triangle is left over
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)
    gmsh.model.mesh.generate(2)
    places, quads = _elements(gmsh, "Quadrangle", ends)
    used, number = np.unique(quads, return_inverse=True)
    section, quads = places[used, 1:], number.reshape(-1, 4)
    a, b, c = (section[quads[:, i]] for i in range(3))
    clockwise = (b[:, 0] - a[:, 0]) * (c[:, 1] - b[:, 1]) < (b[:, 1] - a[:, 1]) * (
        c[:, 0] - b[:, 0]
    )
    quads[clockwise] = quads[clockwise][:, ::-1]
    layer = len(section) * np.arange(len(stations))[:, None, None] + quads
    points = np.column_stack(
        [np.repeat(stations, len(section)), np.tile(section, (len(stations), 1))]
    )
    return points, np.concatenate([layer[:-1], layer[1:]], axis=2).reshape(-1, 8)


def _split_tetrahedra(gmsh, element_size: float) -> tuple[np.ndarray, np.ndarray]:
    _set_size(gmsh, 2.0 * element_size)
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 2)
    gmsh.model.mesh.generate(3)
    return _elements(gmsh, "Hexahedron", [tag for _, tag in gmsh.model.getEntities(3)])


def _tetrahedra(gmsh, element_size: float) -> tuple[np.ndarray, np.ndarray]:
    _set_size(gmsh, 2.0 * element_size)
    # edges bent around a hole must not fold the elements behind them
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    points, nodes = _elements(
        gmsh, "Tetrahedron", [tag for _, tag in gmsh.model.getEntities(3)], order=2
    )
    return points, nodes[:, _TETRAHEDRON]


def _set_size(gmsh, size: float) -> None:
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)


def _elements(
    gmsh, family: str, entities: list[int], order: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """All points (n,3) m of the mesh and the nodes (e,k) of the elements of one family in some
    entities."""
    tags, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    kind = gmsh.model.mesh.getElementType(family, order)
    nodes = [gmsh.model.mesh.getElementsByType(kind, entity)[1] for entity in entities]
    count = gmsh.model.mesh.getElementProperties(kind)[3]
    return places.reshape(-1, 3), number[np.concatenate(nodes).astype(np.int64)].reshape(-1, count)
