"""Element sizes of a mesh file, and whether a finer mesh fits into memory.

A file is split if its elements are larger than requested, and never coarsened. So it may give the
same mesh for two element sizes. Other rails are meshed in the requested size.
"""

from collections.abc import Sequence

from tipoff.highfi.mesh import split
from tipoff.highfi.mesh.asked import asked
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.rail import memory_estimate, step_cost
from tipoff.scenes.rail import MeshTable
from tipoff.scenes.scene import Scene

LONGEST = 1800.0  # s on one core, for a run that only checks another one


def sizes(scene: Scene, wanted: Sequence[float]) -> list[float]:
    """Size (m) of the elements in the mesh of ``scene`` for each requested element size ``wanted``
    (m): equal for equal meshes. Raises MeshError for a file that cannot be used."""
    if not isinstance(scene.rail, MeshTable):
        return list(wanted)
    mesh = read(scene.rail.path(), asked(scene.rail))
    own = split.shortest(mesh)
    return [own / split.parts(mesh, size) for size in wanted]


def too_fine(scene: Scene, size: float) -> str:
    """Reason why a run in elements of ``size`` (m), split from the file of ``scene``, does not fit
    into memory or takes too long, or ""."""
    mesh = read(scene.rail.path(), asked(scene.rail)) if isinstance(scene.rail, MeshTable) else None
    if mesh is None:
        return ""
    parts = split.parts(mesh, size)
    elements, nodes = parts**3 * len(mesh.cells), mesh.cells.shape[1]
    needed = memory_estimate.of_mesh(elements, nodes, elements)
    left = memory_estimate.available()
    if left is not None and needed > left:
        return (
            f"{elements:,} elements take about {memory_estimate.in_words(needed)} of memory, and "
            f"{memory_estimate.in_words(left)} can be had"
        )
    seconds = parts**4 * step_cost.run_time(mesh, scene)[1]
    if seconds > LONGEST:
        return (
            f"{elements:,} elements take about {step_cost.in_words(seconds)} on one core, more "
            f"than {step_cost.in_words(LONGEST)}"
        )
    return ""
