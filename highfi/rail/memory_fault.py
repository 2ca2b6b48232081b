"""Refuses a rail from a file if its elements would not fit into memory, before it is split or
meshed. A wrong unit, in the file or of the element size, can give billions of elements."""

from tipoff.faults import Fault, SceneError
from tipoff.highfi.mesh import split
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.rail import memory_estimate
from tipoff.highfi.statics import assembly
from tipoff.scenes.scene import Scene

# Elements of nodes a length h apart, per h^3 of solid: tetrahedra of edges 2 h are about
# (2 h)^3 / (6 sqrt(2)) each, and each gives four hexahedra.
_TETRAHEDRA, _HEXAHEDRA = 1.06, 1.0


def require_split(scene: Scene, element_size: float, mesh: RailMesh) -> None:
    """Raise SceneError if the ``mesh`` of a file, split to ``element_size`` (m), does not fit into
    memory."""
    elements, nodes = mesh.cells.shape
    parts = split.parts(mesh, element_size) ** 3
    shapes = min(elements * parts, len(assembly.shape_classes(mesh)[1]) * parts)
    needed = memory_estimate.of_mesh(elements * parts, nodes, shapes)
    _require(scene, element_size, elements * parts, needed, memory_estimate.available())


def require_filled(
    scene: Scene, element_size: float, nodes: int, memory: float | None, volume: float
) -> None:
    """Raise SceneError if a solid of ``volume`` (m3), meshed with equal elements of so many
    ``nodes`` and ``element_size`` (m), does not fit into ``memory`` (bytes)."""
    per_cube = _HEXAHEDRA if nodes == 8 else _TETRAHEDRA
    elements = int(per_cube * volume / element_size**3)
    shapes = 1 if nodes == 8 else elements
    needed = memory_estimate.of_mesh(elements, nodes, shapes)
    _require(scene, element_size, elements, needed, memory)


def _require(
    scene: Scene, element_size: float, elements: int, needed: float, left: float | None
) -> None:
    if left is not None and needed > left:
        raise too_large(
            scene, element_size, elements, needed, left, "a larger one, or a coarser file"
        )


def too_large(
    scene: Scene, element_size: float, elements: int, needed: float, left: float, expected: str
) -> SceneError:
    """The fault of an element size (m) whose mesh needs more memory (bytes) than is left."""
    given = (
        f"{1e3 * element_size:.4g} mm: {elements:,} elements take about "
        f"{memory_estimate.in_words(needed)} of memory, and "
        f"{memory_estimate.in_words(left)} can be had"
    )
    return SceneError([Fault(scene.name, "element_size", given, expected)])
