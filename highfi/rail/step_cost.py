"""Cost of the worst elements of a mesh: the time step relative to that of good hexahedra, and the
time of a run.

No frequency of a mesh exceeds the highest one of its elements (``stable_step.element_bound``), and
thin or folded elements have the highest. So only the worst elements are assembled, by two measures:
the thickness, and the smallest Jacobian over the two longest edges, which also finds folds of
curved elements.
"""

from dataclasses import replace

import numpy as np

from tipoff.highfi.extruded import mesh as extruded
from tipoff.highfi.mesh.cells import edge_lengths, jacobians, thickness
from tipoff.highfi.mesh.rail_mesh import RailMesh, listed, slivers
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.statics import assembly, stable_step
from tipoff.meshes.bricks import CUBE
from tipoff.scenes.rail_base import MaterialTable
from tipoff.scenes.scene import Scene

MOST = 6.0  # times the steps of hexahedra of the same size; above it there is a warning
_WORST = 500  # elements assembled for each measure
# ns of one core for one step: without elements, of an element of an extrusion, and of another
# element by its number of nodes, if many share a matrix and if each has its own
_STEP, _COLUMNS = 8e3, 2.5
_SHARED, _OWN = {8: 45.0, 10: 150.0}, {8: 250.0, 10: 900.0}
_FEW = 0.1  # matrices per element
_LONG = 1200.0  # s on one core; a longer run is announced with its time


def ratio(
    material: MaterialTable, element_size: float, points: np.ndarray, cells: np.ndarray
) -> float:
    """Number of steps of a mesh over that of cubes of ``element_size`` (m); infinite if an element
    is inverted."""
    jacobian, _ = jacobians(points, cells)
    if not (jacobian > 0.0).all():
        return np.inf
    cube = RailMesh(element_size * CUBE, np.arange(8)[None], {})
    worst = cells[_worst(points, cells, jacobian.min(axis=1))]
    return largest_step(cube, material) / largest_step(RailMesh(points, worst, {}), material)


def largest_step(mesh: RailMesh, material: MaterialTable) -> float:
    """Step (s) at which every element of a mesh is stable, for any fixed nodes."""
    part = assembly.of_material(mesh, material, fixed=())
    return stable_step.critical_step(stable_step.element_bound(part))


def with_sliver_steps(mesh: RailMesh, material: MaterialTable) -> RailMesh:
    """``mesh``; if it has slivers, with a warning that gives the step (s) they require."""
    thin = slivers(mesh.points, mesh.cells)
    if not len(thin):
        return mesh
    forced, other = (
        largest_step(replace(mesh, cells=cells), material)
        for cells in (mesh.cells[thin], np.delete(mesh.cells, thin, axis=0))
    )
    words = (
        f"slivers {listed(thin)} force a step of at most {forced:.3g} s, the other elements "
        f"one of {other:.3g} s"
    )
    return replace(mesh, warnings=(*mesh.warnings, words))


def with_run_time(mesh: RailMesh, scene: Scene, size: float) -> RailMesh:
    """``mesh``; if it needs more than ``MOST`` times the steps of cubes of ``size`` (m), with a
    warning that gives the expected time of a run."""
    times = ratio(scene.rail.material, size, mesh.points, mesh.cells)
    if times <= MOST:
        return mesh
    step, seconds = run_time(mesh, scene)
    steps = scene.expected_end / step
    words = (
        f"thin or bent elements need {times:.3g} times the steps of cubes of {1e3 * size:.3g} mm: "
        f"{steps:.3g} steps of {step:.3g} s for all of {scene.expected_end:.3g} s, with "
        f"{len(mesh.cells):,} elements about {in_words(seconds)} on one core"
    )
    return replace(mesh, warnings=(*mesh.warnings, words))


def run_time(mesh: RailMesh, scene: Scene) -> tuple[float, float]:
    """Estimate of the step (s) on a mesh, and of the time (s) of one core until the expected end of
    ``scene``."""
    jacobian, _ = jacobians(mesh.points, mesh.cells)
    worst = mesh.cells[_worst(mesh.points, mesh.cells, jacobian.min(axis=1))]
    limit = largest_step(RailMesh(mesh.points, worst, {}), scene.rail.material)
    step = Numerics().safety * limit
    return step, _seconds(mesh, scene, step)


def long_run(mesh: RailMesh, scene: Scene, step: float) -> str:
    """Warning of a run with this ``step`` (s) that would take more than twenty minutes of one core,
    for example due to an interface stiffness in a wrong unit; else ""."""
    if (seconds := _seconds(mesh, scene, step)) <= _LONG:
        return ""
    return (
        f"{scene.name}: {scene.expected_end / step:.3g} steps of {step:.3g} s for all of "
        f"{scene.expected_end:.3g} s, with {len(mesh.cells):,} elements about {in_words(seconds)} on one "
        "core"
    )


def _seconds(mesh: RailMesh, scene: Scene, step: float) -> float:
    count, nodes = mesh.cells.shape
    is_shared = len(assembly.shape_classes(mesh)[1]) < _FEW * count
    element = (_SHARED if is_shared else _OWN)[nodes]
    if is_shared and nodes == 8 and extruded.is_extruded(mesh.points):
        element = _COLUMNS
    return 1e-9 * (_STEP + element * count) * scene.expected_end / step


def spacing(mesh: RailMesh) -> float:
    """Median distance (m) of nodes: along the shortest edges of hexahedra, along all edges of
    tetrahedra."""
    edges = edge_lengths(mesh.points, mesh.cells)
    if mesh.cells.shape[1] == 8:
        return float(np.median(edges.min(axis=1)))
    return 0.5 * float(np.median(edges))


def _worst(points: np.ndarray, cells: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    edges = np.sort(edge_lengths(points, cells), axis=1)
    heights = jacobian / (edges[:, -1] * edges[:, -2])
    return np.union1d(np.argsort(thickness(points, cells))[:_WORST], np.argsort(heights)[:_WORST])


def in_words(seconds: float) -> str:
    """Text of a time (s) with its unit."""
    for unit, length in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2.0 * length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"
