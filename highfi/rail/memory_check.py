"""Memory check: refuses a mesh that does not fit into the memory of this process, before the mesh
is made if its size is known in advance (``memory_fault`` for files)."""

from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.rail import memory_estimate
from tipoff.highfi.rail.geometry import elements
from tipoff.highfi.rail.memory_fault import too_large
from tipoff.highfi.statics import assembly
from tipoff.scenes.scene import Scene

_COARSER = 1.05  # ratio of two sizes tried in turn
_COARSEST = 0.1  # m


def check_before(scene: Scene, element_size: float) -> None:
    """Raise SceneError if the section of ``scene`` with elements of ``element_size`` (m)
    does not fit into memory."""
    left = memory_estimate.available()
    if left is None or not scene.rail.IS_STRAIGHT:
        return

    def needed(size: float) -> float:
        return memory_estimate.of_section(elements(scene, size) or 0)

    if needed(element_size) > left:
        size = element_size
        while needed(1e-3 * float(_in_mm(size))) > left and size < _COARSEST:
            size *= _COARSER
        raise too_large(
            scene,
            element_size,
            elements(scene, element_size) or 0,
            needed(element_size),
            left,
            f"{_in_mm(size)} mm or more",
        )


def _in_mm(size: float) -> str:
    return f"{1e3 * size:.2g}"


def check_mesh(scene: Scene, element_size: float, mesh: RailMesh) -> None:
    """Raise SceneError if the run does not fit into the memory that is left after reading the
    ``mesh`` of ``scene`` from a file."""
    left = memory_estimate.available()
    if left is None or scene.rail.IS_STRAIGHT:
        return
    count, nodes = mesh.cells.shape
    needed = memory_estimate.of_mesh(count, nodes, count)
    if needed > left:  # an estimate as if no two elements were equal; count the classes only now
        needed = memory_estimate.of_mesh(count, nodes, len(assembly.shape_classes(mesh)[1]))
    if needed > left:
        raise too_large(scene, element_size, count, needed, left, "a larger one, or a coarser file")
