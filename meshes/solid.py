"""A solid from a CAD file (STEP, IGES, BREP) as hexahedra, made with gmsh.

A solid whose faces are all plane and parallel to the axes is a set of bricks: the planes of its faces cut space into cells, each of
which is metal or not. Any other solid is filled with tetrahedra of twice the size asked for, each split into four hexahedra at
the centres of its edges and faces; such elements are skewed, which costs steps and makes thin walls too stiff.
"""

from pathlib import Path

import numpy as np

from meshes import generator

_SAME = 1e-9  # m: two planes closer than this are one
_TIE = 1e-6  # divisions
_CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])  # VTK order


def build(path: Path, element_size: float, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) m and hexahedra (e,8), VTK order, of every solid in a file, whatever length unit the file is written in.

    ``planes`` (p,3) m: places along x, y and z that a mesh of bricks must have as borders of elements; others take no notice.
    Raises ValueError for a file without a solid that gmsh can read, RuntimeError where a system library of gmsh is missing.
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
        return (_bricks if _is_bricks(gmsh) else _split_tetrahedra)(gmsh, volumes, element_size, planes)


def _vertices(gmsh, dimension: int, tag: int) -> np.ndarray:
    """Corners (v,3) m of an entity."""
    ends = gmsh.model.getBoundary([(dimension, tag)], combined=False, recursive=True)
    return np.array([gmsh.model.getValue(0, point, []) for _, point in ends])


def _is_bricks(gmsh) -> bool:
    straight = all(gmsh.model.getType(1, tag) == "Line" for _, tag in gmsh.model.getEntities(1))
    return straight and all((np.ptp(_vertices(gmsh, 2, tag), axis=0) < _SAME).any() for _, tag in gmsh.model.getEntities(2))


def _bricks(gmsh, volumes: list[int], element_size: float, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells between all planes that lie in a solid, each interval with about length / element_size divisions, one at least."""
    corners = np.concatenate([_vertices(gmsh, 3, volume) for volume in volumes])
    lines = [_different(corners[:, axis], planes[:, axis]) for axis in range(3)]
    middles = [0.5 * (line[1:] + line[:-1]) for line in lines]
    metal = np.zeros([len(middle) for middle in middles], dtype=bool)
    for cell in np.ndindex(metal.shape):
        place = [float(middle[i]) for middle, i in zip(middles, cell)]
        metal[cell] = any(gmsh.model.isInside(3, volume, place) for volume in volumes)
    # Halves go down however the places are rounded, so that both sides of a symmetric solid are cut alike.
    counts = [np.maximum(1, np.ceil(np.diff(line) / element_size - 0.5 - _TIE).astype(int)) for line in lines]
    fine = [np.append(np.concatenate([np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(line, line[1:], count)]), line[-1])
            for line, count in zip(lines, counts)]
    for axis, count in enumerate(counts):
        metal = np.repeat(metal, count, axis=axis)
    nodes = np.ravel_multi_index(np.moveaxis(np.argwhere(metal)[:, None] + _CUBE, -1, 0), [len(line) for line in fine])
    points = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1).reshape(-1, 3)
    used, number = np.unique(nodes, return_inverse=True)
    return points[used], number.reshape(-1, 8)


def _different(solid: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Places of the solid's own planes and of those asked for inside it, in order, those that coincide taken once."""
    places = np.sort(np.concatenate([solid, asked[(asked > solid.min()) & (asked < solid.max())]]))
    return places[np.append(True, np.diff(places) > _SAME)]


def _split_tetrahedra(gmsh, volumes: list[int], element_size: float, planes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    gmsh.option.setNumber("Mesh.MeshSizeMin", 2.0 * element_size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 2.0 * element_size)
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 2)
    try:
        gmsh.model.mesh.generate(3)
    except Exception as fault:  # gmsh knows no other class
        raise ValueError(f"gmsh cannot fill it with elements of {element_size:g} m ({fault})") from fault
    tags, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    hexahedron = gmsh.model.mesh.getElementType("Hexahedron", 1)
    nodes = [gmsh.model.mesh.getElementsByType(hexahedron, volume)[1] for volume in volumes]
    return places.reshape(-1, 3), number[np.concatenate(nodes).astype(np.int64)].reshape(-1, 8)
