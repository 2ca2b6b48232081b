"""The rail mesh as plain arrays, read from any file meshio knows and checked before anything is computed with it.

A mesh needs 8-node hexahedra, at least one named quadrilateral group that starts with `contact` (the walls pads touch) and
one named `mount` (fixed to the platform). Corners follow the VTK order, which gmsh shares. The Jacobian is checked at the
eight corners,

    J = e1 . (e2 x e3) > 0    with e the three edges that leave a corner,

which is stricter than checking it where it is integrated. Arrays count from 0; messages count the hexahedra of the file from 1,
as mesh editors do.
"""

import contextlib
import io
from dataclasses import dataclass, field, replace
from pathlib import Path

import meshio
import numpy as np

# Faces of a hexahedron in VTK order, each counter-clockwise seen from outside.
FACES = np.array([[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]])
# The three neighbours of each corner, ordered so that their triple product is positive.
_NEIGHBOURS = np.array([[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]])
_LISTED = 20  # element numbers printed in one message
_SHORT_EDGE = 0.25  # of the median: shorter ones set the time step of the whole mesh
_SKEW = 0.85  # scaled Jacobian, 1 for a brick and 0.71 for corners of 45 degrees, where bending of thin layers is lost


class MeshError(ValueError):
    """The mesh cannot be used; the message lists every fault found."""


@dataclass(frozen=True)
class RailMesh:
    """Hexahedra and named boundary surfaces.

    points (n,3) m; cells (e,8) point numbers, VTK order, positive Jacobian; surfaces: name -> (m,4) point numbers of facets,
    counter-clockwise seen from outside the solid; warnings: what costs time or accuracy without being wrong.
    """

    points: np.ndarray
    cells: np.ndarray
    surfaces: dict[str, np.ndarray]
    warnings: tuple[str, ...] = field(default=())


def read(source) -> RailMesh:
    """Check and convert a meshio mesh, or the path of a file meshio can read.

    Points no hexahedron uses are dropped. Raises MeshError for a file that meshio does not read, and with one line per fault: no
    hexahedra or other solid elements, missing surfaces, facets that are not on the boundary of the solid or appear twice,
    inverted elements.
    """
    mesh = source if isinstance(source, meshio.Mesh) else _opened(Path(source))
    hexes = _hexahedra(mesh)
    surfaces = _named_quads(mesh)
    faults = _content_faults(mesh, hexes, surfaces)
    if len(hexes):
        faults += _inverted(mesh.points, hexes)
        boundary = boundary_facets(hexes)
        surfaces, facet_faults = _matched(surfaces, boundary)
        faults += facet_faults
    if faults:
        name = "the mesh" if source is mesh else source
        raise MeshError(f"{name} cannot be used:\n  " + "\n  ".join(faults))
    used, numbered = np.unique(hexes, return_inverse=True)
    renumber = np.full(len(mesh.points), -1)
    renumber[used] = np.arange(len(used))
    points = np.ascontiguousarray(mesh.points[used], dtype=float)
    hexes = numbered.reshape(hexes.shape)
    return RailMesh(points, hexes, {name: renumber[facets] for name, facets in surfaces.items()}, _warnings(points, hexes))


def along_x(mesh: RailMesh) -> RailMesh:
    """The same mesh with nodes and elements numbered from one end to the other.

    Neighbours are then near each other in memory, whatever tool numbered the file: an internal force costs 45 ns per element
    on 155,000 elements, 75 ns where the file numbers at random.
    """
    order = _from_end_to_end(mesh.points)
    renumber = np.empty_like(order)
    renumber[order] = np.arange(len(order))
    elements = _from_end_to_end(mesh.points[mesh.cells].mean(axis=1))
    surfaces = {name: renumber[facets] for name, facets in mesh.surfaces.items()}
    return replace(mesh, points=mesh.points[order], cells=renumber[mesh.cells[elements]], surfaces=surfaces)


def boundary_facets(hexes: np.ndarray) -> np.ndarray:
    """Faces (m,4) that belong to one hexahedron of (e,8) only, counter-clockwise seen from outside."""
    faces = hexes[:, FACES].reshape(-1, 4)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def corner_jacobians(points: np.ndarray, hexes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Jacobian (e,8) at the corners in m3, and the same scaled by the lengths of the three edges (1 for a brick)."""
    corners = points[hexes]
    edges = corners[:, _NEIGHBOURS] - corners[:, :, None]
    jacobian = np.linalg.det(edges)
    lengths = np.linalg.norm(edges, axis=-1).prod(axis=-1)
    return jacobian, np.divide(jacobian, lengths, out=np.zeros_like(jacobian), where=lengths > 0.0)


def edge_lengths(points: np.ndarray, hexes: np.ndarray) -> np.ndarray:
    """Lengths (e,12) in m of the edges of each hexahedron."""
    start = np.array([0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3])
    end = np.array([1, 2, 3, 0, 5, 6, 7, 4, 4, 5, 6, 7])
    corners = points[hexes]
    return np.linalg.norm(corners[:, end] - corners[:, start], axis=-1)


def slivers(points: np.ndarray, hexes: np.ndarray) -> np.ndarray:
    """Numbers of the elements with an edge so short that it, not the rest of the mesh, sets the time step."""
    shortest = edge_lengths(points, hexes).min(axis=1)
    return np.flatnonzero(shortest < _SHORT_EDGE * np.median(shortest))


def listed(elements: np.ndarray) -> str:
    """Numbers of elements as messages print them, counted from 1."""
    numbers = ", ".join(str(number + 1) for number in elements[:_LISTED])
    return numbers if len(elements) <= _LISTED else f"{numbers} and {len(elements) - _LISTED} more"


def _opened(path: Path) -> meshio.Mesh:
    said = io.StringIO()
    try:
        # meshio prints what is wrong with a file, and then asks the whole program to exit.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(path)
    except (Exception, SystemExit) as fault:  # each format's reader fails in its own way on damaged bytes
        why = " ".join(said.getvalue().split()) or f"{type(fault).__name__}: {fault}"
        raise MeshError(f"{path} cannot be used: meshio does not read it ({why})") from fault


def _hexahedra(mesh: meshio.Mesh) -> np.ndarray:
    blocks = [block.data for block in mesh.cells if block.type == "hexahedron"]
    return np.concatenate(blocks).astype(np.int64) if blocks else np.empty((0, 8), dtype=np.int64)


def _named_quads(mesh: meshio.Mesh) -> dict[str, np.ndarray]:
    """Quadrilaterals of each contact or mount group, from gmsh's physical tags or from the cell sets of other formats."""
    quads = [(index, block.data) for index, block in enumerate(mesh.cells) if block.type == "quad"]
    physical = mesh.cell_data.get("gmsh:physical")
    groups: dict[str, list[np.ndarray]] = {}
    for index, facets in quads:
        if physical is not None:
            for name, (tag, dimension) in mesh.field_data.items():
                if dimension == 2:
                    groups.setdefault(name, []).append(facets[physical[index] == tag])
        for name, members in mesh.cell_sets.items():
            # A format that gives both (gmsh 4.1) says the same thing twice.
            if name not in mesh.field_data and members[index] is not None:
                groups.setdefault(name, []).append(facets[np.asarray(members[index], dtype=np.int64)])
    merged = {name: np.concatenate(parts).astype(np.int64) for name, parts in groups.items()
              if name.startswith("contact") or name == "mount"}
    return {name: facets for name, facets in merged.items() if len(facets)}


def _content_faults(mesh: meshio.Mesh, hexes: np.ndarray, surfaces: dict[str, np.ndarray]) -> list[str]:
    faults = []
    other = sorted({block.type for block in mesh.cells if block.dim == 3 and block.type != "hexahedron"})
    if other:
        faults.append(f"solid elements other than 8-node hexahedra: {', '.join(other)}")
    if not len(hexes):
        faults.append("no 8-node hexahedra")
    if not np.isfinite(mesh.points).all():
        faults.append("coordinates that are not finite")
    named = ", ".join(sorted({*mesh.field_data, *mesh.cell_sets})) or "none"
    if not any(name.startswith("contact") for name in surfaces):
        faults.append(f"no quadrilateral group whose name starts with 'contact' (groups in the mesh: {named})")
    if "mount" not in surfaces:
        faults.append(f"no quadrilateral group named 'mount' (groups in the mesh: {named})")
    return faults


def _inverted(points: np.ndarray, hexes: np.ndarray) -> list[str]:
    jacobian, _ = corner_jacobians(points, hexes)
    inverted = np.flatnonzero(~(jacobian > 0.0).all(axis=1))
    return [f"inverted or flat elements: {listed(inverted)}"] if len(inverted) else []


def _matched(surfaces: dict[str, np.ndarray], boundary: np.ndarray) -> tuple[dict[str, np.ndarray], list[str]]:
    """Each facet replaced by the hexahedron face it lies on, which carries the outward orientation."""
    face_of = {tuple(key): face for key, face in zip(np.sort(boundary, axis=1).tolist(), boundary)}
    matched, faults = {}, []
    for name, facets in surfaces.items():
        keys = [tuple(key) for key in np.sort(facets, axis=1).tolist()]
        astray = sum(key not in face_of for key in keys)
        if astray:
            faults.append(f"surface '{name}': {astray} of {len(keys)} facets are not on the boundary of a hexahedron")
        if len(set(keys)) < len(keys):
            faults.append(f"surface '{name}': {len(keys) - len(set(keys))} facets appear twice")
        if not astray:
            matched[name] = np.array([face_of[key] for key in keys])
    return matched, faults


def _warnings(points: np.ndarray, hexes: np.ndarray) -> tuple[str, ...]:
    lengths = edge_lengths(points, hexes)
    shortest = lengths.min(axis=1)
    thin = slivers(points, hexes)
    _, scaled = corner_jacobians(points, hexes)
    skewed = np.flatnonzero(scaled.min(axis=1) < _SKEW)
    warnings = []
    if len(thin):
        worst = thin[np.argmin(shortest[thin])]
        warnings.append(
            f"slivers: elements {listed(thin)}; shortest edge {shortest[worst]:.3g} m in element {worst + 1} (aspect "
            f"ratio {lengths[worst].max() / shortest[worst]:.3g}), so a run takes about "
            f"{np.median(shortest) / shortest[worst]:.3g} times the steps that the rest of the mesh needs")
    if len(skewed):
        warnings.append(
            f"skewed elements: {listed(skewed)}; scaled Jacobian down to {scaled.min():.3g}, where one layer of hexahedra "
            "is far too stiff in bending")
    return tuple(warnings)


def _from_end_to_end(points: np.ndarray) -> np.ndarray:
    # Rounded, because rounding errors of a mesh generator would shuffle the nodes of one section.
    x, y, z = np.round(points, 9).T
    return np.lexsort((z, y, x))
