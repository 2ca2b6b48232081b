"""Rail mesh as plain arrays, read from a file (``highfi.mesh.files``) and checked.

A mesh needs 8-node hexahedra or 10-node tetrahedra, at least one named group of their faces that
starts with `contact` (the walls pads touch) and one named `mount` (fixed to the platform). Nodes
follow the VTK order. The Jacobian must be positive at the corners of a hexahedron,

    J = e1 . (e2 x e3) > 0    with e the three edges that leave a corner,

This is stricter than a check at the integration points. In a tetrahedron the Jacobian must be
positive everywhere (`highfi.mesh.cells`). Arrays count from 0; messages count the elements of the
file from 1, as mesh editors do.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import meshio
import numpy as np

from tipoff.highfi.mesh.cells import (
    HEXAHEDRON,
    KINDS,
    Kind,
    edge_lengths,
    jacobians,
    kind,
    thickness,
)
from tipoff.highfi.mesh.files.opened import opened
from tipoff.highfi.mesh.files.tables import Unreadable, is_surface
from tipoff.scenes.faults import InputError

_LISTED = 20  # element numbers printed in one message
_THIN = 0.25  # of the median; thinner elements set the time step of the whole mesh
# scaled Jacobian: 1 for a brick, 0.71 for corners of 45 degrees, at which thin layers do not bend
# correctly
_SKEW = 0.85


class MeshError(InputError):
    """The mesh cannot be used; the message lists every fault found."""


@dataclass(frozen=True)
class RailMesh:
    """Elements of one kind and named boundary surfaces."""

    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,k) point numbers, k = 8 or 10, VTK order, positive Jacobian
    # name -> (m,f) point numbers of facets: four corners, or three and three middles; corners
    # counter-clockwise seen from outside the solid
    surfaces: dict[str, np.ndarray]
    warnings: tuple[str, ...] = field(default=())  # properties that cost time or accuracy
    drawn: dict[str, float] | None = None  # m2, areas on the solid, None for a mesh made elsewhere


def read(source) -> RailMesh:
    """Check and convert a meshio mesh, or the path of a file in a format of ``files.opened``.

    Unused points are dropped. Raises MeshError for a file that cannot be read. Else the error has
    one line per fault: no elements of a supported kind, two kinds or others beside them, missing
    surfaces, facets that are not on the boundary of the solid or appear twice, elements that are
    inverted or appear twice.
    """
    mesh = source if isinstance(source, meshio.Mesh) else _opened(Path(source))
    found = _kinds(mesh)
    cells = _elements(mesh, found[0])
    surfaces = _named_facets(mesh, found[0])
    faults = _content_faults(mesh, found, len(cells), surfaces)
    if len(cells):
        faults += _inverted(mesh.points, cells) + _repeated(cells)
        boundary = boundary_facets(cells)
        surfaces, facet_faults = _matched(surfaces, boundary)
        faults += facet_faults
    if faults:
        name = "the mesh" if source is mesh else source
        raise MeshError(f"{name} cannot be used:\n  " + "\n  ".join(faults))
    used, numbered = np.unique(cells, return_inverse=True)
    renumber = np.full(len(mesh.points), -1)
    renumber[used] = np.arange(len(used))
    points = np.ascontiguousarray(mesh.points[used], dtype=float)
    cells = numbered.reshape(cells.shape)
    return RailMesh(
        points,
        cells,
        {name: renumber[facets] for name, facets in surfaces.items()},
        _warnings(points, cells),
    )


def along_x(mesh: RailMesh) -> RailMesh:
    """The same mesh with nodes and elements numbered from one end to the other.

    Neighbours are then close in memory: with 155,000 elements an internal force takes 45 ns per
    element, and 75 ns with a random numbering of the file.
    """
    order = _from_end_to_end(mesh.points)
    renumber = np.empty_like(order)
    renumber[order] = np.arange(len(order))
    elements = _from_end_to_end(mesh.points[mesh.cells].mean(axis=1))
    surfaces = {name: renumber[facets] for name, facets in mesh.surfaces.items()}
    return replace(
        mesh, points=mesh.points[order], cells=renumber[mesh.cells[elements]], surfaces=surfaces
    )


def boundary_facets(cells: np.ndarray) -> np.ndarray:
    """Faces (m,f) that belong to one element of (e,k) only, corners counter-clockwise seen from
    outside."""
    faces = cells[:, kind(cells).faces].reshape(-1, kind(cells).faces.shape[1])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(first[count == 1])]


def slivers(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Numbers of the elements so thin that they, not the rest of the mesh, set the time step."""
    thin = thickness(points, cells)
    return np.flatnonzero(thin < _THIN * np.median(thin))


def listed(elements: np.ndarray) -> str:
    """Numbers of elements as messages print them, counted from 1."""
    numbers = ", ".join(str(number + 1) for number in elements[:_LISTED])
    return numbers if len(elements) <= _LISTED else f"{numbers} and {len(elements) - _LISTED} more"


def _opened(path: Path) -> meshio.Mesh:
    try:
        return opened(path)
    except (Unreadable, OSError) as fault:
        raise MeshError(f"{path} cannot be used: {fault}") from fault


def _kinds(mesh: meshio.Mesh) -> list[Kind]:
    """Kinds of element in a file; hexahedra if there are no elements."""
    types = {block.type for block in mesh.cells}
    return [each for each in KINDS.values() if each.cell in types] or [HEXAHEDRON]


def _elements(mesh: meshio.Mesh, wanted: Kind) -> np.ndarray:
    blocks = [block.data for block in mesh.cells if block.type == wanted.cell]
    return np.concatenate(blocks).astype(np.int64) if blocks else np.empty((0, 8), dtype=np.int64)


def _named_facets(mesh: meshio.Mesh, wanted: Kind) -> dict[str, np.ndarray]:
    """Facets of each contact or mount group: from cell sets, or from physical tags of a mesh made
    in memory."""
    blocks = [
        (index, block.data) for index, block in enumerate(mesh.cells) if block.type == wanted.facet
    ]
    physical = mesh.cell_data.get("gmsh:physical")
    groups: dict[str, list[np.ndarray]] = {}
    for index, facets in blocks:
        if physical is not None:
            for name, (tag, dimension) in mesh.field_data.items():
                if dimension == 2:
                    groups.setdefault(name, []).append(facets[physical[index] == tag])
        for name, members in mesh.cell_sets.items():
            # If both exist, they give the same group.
            if is_surface(name) and name not in mesh.field_data and members[index] is not None:
                groups.setdefault(name, []).append(
                    facets[np.asarray(members[index], dtype=np.int64)]
                )
    merged = {
        name: np.concatenate(parts).astype(np.int64)
        for name, parts in groups.items()
        if is_surface(name)
    }
    return {name: facets for name, facets in merged.items() if len(facets)}


def _content_faults(
    mesh: meshio.Mesh, found: list[Kind], elements: int, surfaces: dict[str, np.ndarray]
) -> list[str]:
    faults = []
    supported = {kind.cell for kind in KINDS.values()}
    names = [kind.name for kind in KINDS.values()]
    other = sorted(
        {block.type for block in mesh.cells if block.dim == 3 and block.type not in supported}
    )
    if other:
        faults.append(f"solid elements other than {' and '.join(names)}: {', '.join(other)}")
    if "tetra" in other:
        faults.append(
            "4-node tetrahedra, which are far too stiff: let the mesh generator write elements of "
            "second order"
        )
    if len(found) > 1:
        faults.append(f"both {' and '.join(names)}: one kind can be used")
    if not elements:
        faults.append(f"no {' or '.join(names)}")
    if not np.isfinite(mesh.points).all():
        faults.append("coordinates that are not finite")
    named = ", ".join(sorted({*mesh.field_data, *mesh.cell_sets})) or "none"
    facets = found[0].facets
    if not any(name.startswith("contact") for name in surfaces):
        faults.append(
            f"no {facets} group whose name starts with 'contact' (groups in the mesh: {named})"
        )
    if "mount" not in surfaces:
        faults.append(f"no {facets} group named 'mount' (groups in the mesh: {named})")
    return faults


def _inverted(points: np.ndarray, cells: np.ndarray) -> list[str]:
    # The products of too large coordinates overflow.
    with np.errstate(over="ignore", invalid="ignore"):
        jacobian, scaled = jacobians(points, cells)
    if np.isfinite(points).all() and not (np.isfinite(jacobian) & np.isfinite(scaled)).all():
        return [f"coordinates up to {np.abs(points).max():.3g} m, too large for any element"]
    inverted = np.flatnonzero(~(jacobian > 0.0).all(axis=1))
    return [f"inverted or flat elements: {listed(inverted)}"] if len(inverted) else []


def _repeated(cells: np.ndarray) -> list[str]:
    """Elements with the nodes of an earlier one: the solid would be twice as stiff there."""
    _, first = np.unique(np.sort(cells, axis=1), axis=0, return_index=True)
    again = np.delete(np.arange(len(cells)), first)
    return [f"elements that appear twice: {listed(again)}"] if len(again) else []


def _matched(
    surfaces: dict[str, np.ndarray], boundary: np.ndarray
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Each facet replaced by the face of its element, which has the outward orientation."""
    face_of = {tuple(key): face for key, face in zip(np.sort(boundary, axis=1).tolist(), boundary)}
    matched, faults = {}, []
    for name, facets in surfaces.items():
        keys = [tuple(key) for key in np.sort(facets, axis=1).tolist()]
        astray = sum(key not in face_of for key in keys)
        if astray:
            faults.append(
                f"surface '{name}': {astray} of {len(keys)} facets are not on the boundary of the "
                f"solid"
            )
        if len(set(keys)) < len(keys):
            faults.append(f"surface '{name}': {len(keys) - len(set(keys))} facets appear twice")
        if not astray:
            matched[name] = np.array([face_of[key] for key in keys])
    return matched, faults


def _warnings(points: np.ndarray, cells: np.ndarray) -> tuple[str, ...]:
    across = thickness(points, cells)
    thin = slivers(points, cells)
    warnings = []
    if len(thin):
        thinnest = thin[np.argmin(across[thin])]
        longest = edge_lengths(points, cells[thinnest : thinnest + 1]).max()
        warnings.append(
            f"slivers: elements {listed(thin)}; shortest {kind(cells).thickness} "
            f"{across[thinnest]:.3g} m in element {thinnest + 1} "
            f"(aspect ratio {longest / across[thinnest]:.3g}), so a run takes about "
            f"{np.median(across) / across[thinnest]:.3g} times the steps that the rest of the mesh "
            f"needs"
        )
    return (*warnings, *_skewed(points, cells))


def _skewed(points: np.ndarray, cells: np.ndarray) -> tuple[str, ...]:
    """Warning of hexahedra far from bricks, which bend too stiffly. Tetrahedra of any shape bend
    correctly: their edges are quadratic."""
    if kind(cells) is not HEXAHEDRON:
        return ()
    _, scaled = jacobians(points, cells)
    skewed = np.flatnonzero(scaled.min(axis=1) < _SKEW)
    if not len(skewed):
        return ()
    return (
        f"skewed elements: {listed(skewed)}; scaled Jacobian down to {scaled.min():.3g}, where one "
        f"layer of hexahedra "
        "is far too stiff in bending",
    )


def _from_end_to_end(points: np.ndarray) -> np.ndarray:
    # Rounded, because rounding errors of a mesh generator would shuffle the nodes of a section.
    x, y, z = np.round(points, 9).T
    return np.lexsort((z, y, x))
