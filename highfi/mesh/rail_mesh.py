"""Rail mesh as plain arrays, read from a file (``formats.meshes``) and checked.

A mesh needs hexahedra or tetrahedra (`mesh.file_elements`), at least one named group of their faces
that starts with `contact` (the walls pads touch) and one named `mount` (fixed to the platform). Nodes
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

from tipoff.faults import InputError
from tipoff.formats.meshes.blocks import Unreadable
from tipoff.formats.meshes.reader import read_mesh_file
from tipoff.highfi.mesh import file_elements
from tipoff.highfi.mesh.asked import AS_DRAWN, Asked
from tipoff.highfi.mesh.cells import (
    HEXAHEDRON,
    edge_lengths,
    jacobians,
    kind,
    thickness,
)
from tipoff.highfi.mesh.file_elements import FILE_ELEMENTS
from tipoff.highfi.mesh.named_surfaces import Boundary, named_surfaces

SUPPORTED = "hexahedra of 8, 20 or 27 nodes and tetrahedra of 4 or 10 nodes"
_ONE_TYPE = (
    "mesh the rail with one of them, such as tetrahedra alone; if the others are of another part, name "
    "the group of the rail in rail.body"
)
# last line of every refusal of a file
DESCRIBED = "what is read: docs/reference/file_formats.md, section 'Meshes of rails'"
_LISTED = 20  # element numbers printed in one message
_LARGEST = 1e100  # m; the cube of a larger coordinate overflows
_THIN = 0.25  # of the median; thinner elements set the time step of the whole mesh
# scaled Jacobian: 1 for a brick, 0.71 for corners of 45 degrees, at which thin layers do not bend
# correctly
_SKEW = 0.85


class MeshError(InputError):
    """The mesh cannot be used; the message lists every fault found."""


@dataclass(frozen=True, eq=False)
class RailMesh:
    """Elements of one kind and named boundary surfaces. A mesh equals itself alone, so that what
    follows from it can be kept with it."""

    points: np.ndarray  # (n,3) m
    cells: np.ndarray  # (e,k) point numbers, k = 8 or 10, VTK order, positive Jacobian
    # name -> (m,f) point numbers of facets: four corners, or three and three middles; corners
    # counter-clockwise seen from outside the solid
    surfaces: dict[str, np.ndarray]
    warnings: tuple[str, ...] = field(default=())  # properties that cost time or accuracy
    drawn: dict[str, float] | None = None  # m2, areas on the solid, None for a mesh made elsewhere


def read(source, asked: Asked = AS_DRAWN, made_here: bool = False) -> RailMesh:
    """Check and convert a meshio mesh, or the path of a file in a format of ``formats.meshes``;
    ``asked`` says how the file differs from the scene, and which of its parts are the rail. Warnings
    about a mesh that was ``made_here`` do not list numbers of elements.

    Unused points are dropped. Raises MeshError for a file that cannot be read. Else the error has
    one line per fault: no elements of a supported type, two types or others beside them, missing
    surfaces, facets that are not on the boundary of the solid or appear twice, elements that are
    inverted or appear twice.
    """
    mesh = source if isinstance(source, meshio.Mesh) else _opened(Path(source))
    # The products of too large coordinates overflow.
    with np.errstate(over="ignore", invalid="ignore"):
        mesh.points = asked.placed(np.asarray(mesh.points, dtype=float))
    others = [] if not asked.body else _without_other_bodies(mesh, asked.body)
    found = [name for name in FILE_ELEMENTS if any(block.type == name for block in mesh.cells)]
    name = found[0] if found else "hexahedron"
    _, made, parts = FILE_ELEMENTS[name]
    blocks = [block.data for block in mesh.cells if block.type == name]
    given = np.concatenate(blocks).astype(np.int64) if blocks else np.empty((0, 8), dtype=np.int64)
    boundary = Boundary(given, made)
    with np.errstate(over="ignore", invalid="ignore"):
        surfaces, wrong = named_surfaces(mesh, boundary, asked)
    faults = [*others, *wrong, *_content_faults(mesh, found, surfaces)]
    points, cells = mesh.points, given
    if len(given):
        with np.errstate(over="ignore", invalid="ignore"):
            points, cells, astray = file_elements.converted(name, points, given)
        if len(astray):
            faults.append(f"middle nodes far from the middles of edges: elements {listed(astray)}")
        else:
            faults += _inverted(points, cells, parts)
        faults += _repeated(given)
        faults += boundary.faults(surfaces)
    if faults:
        shown, end = ("the mesh", "") if source is mesh else (source, f"\n  {DESCRIBED}")
        raise MeshError(f"{shown} cannot be used:\n  " + "\n  ".join(faults) + end)
    used, numbered = np.unique(cells, return_inverse=True)
    renumber = np.full(len(points), -1)
    renumber[used] = np.arange(len(used))
    points = np.ascontiguousarray(points[used])
    facets = {
        key: renumber[file_elements.facets(name, cells, *boundary.places(corners))]
        for key, corners in surfaces.items()
    }
    cells = numbered.reshape(cells.shape)
    warnings = _warnings(points, cells, numbered=not made_here)
    return RailMesh(points, cells, facets, (*_of_parts(name), *warnings))


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
        return read_mesh_file(path)
    except (Unreadable, OSError) as fault:
        raise MeshError(f"{path} cannot be used: {fault}\n  {DESCRIBED}") from fault


def _without_other_bodies(mesh: meshio.Mesh, body: str) -> list[str]:
    """Leave only the solids of one group in a mesh; the fault of a group that does not exist."""
    name = next((each for each in mesh.cell_sets if each.lower() == body.lower()), None)
    solids = {index: block for index, block in enumerate(mesh.cells) if block.dim == 3}
    members = {index: mesh.cell_sets[name][index] for index in solids} if name else {}
    if not sum(map(len, members.values())):
        named = [
            each for each, parts in mesh.cell_sets.items() if any(len(parts[one]) for one in solids)
        ]
        return [f"no body '{body}' (groups of solids: {', '.join(sorted(named)) or 'none'})"]
    for index, chosen in members.items():
        mesh.cells[index] = meshio.CellBlock(
            solids[index].type, solids[index].data[np.asarray(chosen, dtype=np.int64)]
        )
    mesh.cells = [
        block if len(block.data) else meshio.CellBlock("vertex", np.empty((0, 1), dtype=int))
        for block in mesh.cells
    ]
    return []


def _of_parts(name: str) -> tuple[str, ...]:
    """What became of the elements of a file, if their numbers changed."""
    text, _, parts = FILE_ELEMENTS[name]
    if parts == 1:
        return ()
    return (
        f"each of the {text} is split into {parts} of 8 nodes between its nodes; element n of the "
        f"file has the numbers {parts} n - {parts - 1} to {parts} n here",
    )


def _content_faults(
    mesh: meshio.Mesh, found: list[str], surfaces: dict[str, np.ndarray]
) -> list[str]:
    faults = []
    other = sorted(
        {block.type for block in mesh.cells if block.dim == 3 and block.type not in FILE_ELEMENTS}
    )
    if other:
        faults.append(
            f"solid elements of other types: {', '.join(other)}; {SUPPORTED} are read: {_ONE_TYPE}"
        )
    if len(found) > 1:
        names = " and ".join(FILE_ELEMENTS[name].name for name in found)
        faults.append(f"both {names}: one type can be used: {_ONE_TYPE}")
    if not found:
        faults.append(f"no solid elements; {SUPPORTED} are read")
    if not np.isfinite(mesh.points).all():
        faults.append("coordinates that are not finite")
    named = ", ".join(sorted({*mesh.field_data, *mesh.cell_sets, *mesh.point_sets})) or "none"
    facets = FILE_ELEMENTS[found[0]].kind.facets if found else HEXAHEDRON.facets
    if not any(name.startswith("contact") for name in surfaces):
        faults.append(
            f"no {facets} group whose name starts with 'contact' (groups in the mesh: {named})"
        )
    if "mount" not in surfaces:
        faults.append(f"no {facets} group named 'mount' (groups in the mesh: {named})")
    return faults


def _inverted(points: np.ndarray, cells: np.ndarray, parts: int) -> list[str]:
    with np.errstate(all="ignore"):
        jacobian, scaled = jacobians(points, cells)
    is_bounded = np.abs(points).max(initial=0.0) < _LARGEST
    if np.isfinite(points).all() and not (
        is_bounded and (np.isfinite(jacobian) & np.isfinite(scaled)).all()
    ):
        return [f"coordinates up to {np.abs(points).max():.3g} m, too large for any element"]
    inverted = np.unique(np.flatnonzero(~((jacobian > 0.0) & (scaled > 0.0)).all(axis=1)) // parts)
    return [f"inverted or flat elements: {listed(inverted)}"] if len(inverted) else []


def _repeated(cells: np.ndarray) -> list[str]:
    """Elements with the nodes of an earlier one: the solid would be twice as stiff there."""
    _, first = np.unique(np.sort(cells, axis=1), axis=0, return_index=True)
    again = np.delete(np.arange(len(cells)), first)
    return [f"elements that appear twice: {listed(again)}"] if len(again) else []


def _warnings(points: np.ndarray, cells: np.ndarray, numbered: bool) -> tuple[str, ...]:
    """Properties that cost time or accuracy. Elements are named by number if those are ``numbered`` in
    a file, and are counted in a mesh that was made here."""
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
    return (*warnings, *_skewed(points, cells, numbered))


def _skewed(points: np.ndarray, cells: np.ndarray, numbered: bool) -> tuple[str, ...]:
    """Warning of hexahedra far from bricks, which bend too stiffly. Tetrahedra of any shape bend
    correctly: their edges are quadratic."""
    if kind(cells) is not HEXAHEDRON:
        return ()
    _, scaled = jacobians(points, cells)
    skewed = np.flatnonzero(scaled.min(axis=1) < _SKEW)
    if not len(skewed):
        return ()
    which = f": {listed(skewed)}" if numbered else f", {len(skewed):,} of {len(cells):,}"
    return (
        f"skewed elements{which}; scaled Jacobian down to {scaled.min():.3g}, where a wall of one "
        "layer of hexahedra is far too stiff in bending",
    )


def _from_end_to_end(points: np.ndarray) -> np.ndarray:
    # Rounded, because rounding errors of a mesh generator would shuffle the nodes of a section.
    x, y, z = np.round(points, 9).T
    return np.lexsort((z, y, x))
