"""Check that displacements are small: the largest displacement gradient of the rails.

Linear elasticity has an error of the order of the strain and of the square of the rotation. Both
are parts of the displacement gradient G = du/dx; its norm is the angle of a pure rotation and the
strain of a pure extension. A run ends where the norm exceeds ``MOST``: there a rotation has an
error of 1 %, and no metal is elastic beyond. Bending between two mounts also causes tension, of the
order of (deflection / thickness)^2, which this limit does not see.

G of an element is the linear map closest to the displacements u of its nodes at x,

    G = (sum (u - <u>) (x - <x>)') (sum (x - <x>) (x - <x>)')^-1

This is exact for a linear displacement. In a brick the norm of G is at most 2 sqrt(3) max|u - u_0|
/ thickness, with u_0 of any point. So only elements whose nodes differ by more than ``small`` are
evaluated.
"""

import numpy as np

from tipoff.highfi.dynamics.system import System
from tipoff.highfi.mesh.cells import thickness

MOST = 0.1
EVERY = 2500  # least number of steps from one check of the rails to the next
_BATCH = 65536  # elements treated at once; bounds the memory


def small(system: System) -> float:
    """Largest difference (m) of displacement in an element that cannot exceed the limit."""
    across = thickness(system.mesh.points, system.mesh.cells).min()
    return float(MOST * across / (2.0 * np.sqrt(3.0)))


def gradients(points: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Norm (e,) of the displacement gradient of elements with nodes at ``points`` (e,k,3) m moved by
    ``displacement`` (e,k,3) m."""
    arms = points - points.mean(axis=1, keepdims=True)
    moved = displacement - displacement.mean(axis=1, keepdims=True)
    shape = np.swapaxes(arms, 1, 2) @ arms
    found = np.swapaxes(np.linalg.solve(shape, np.swapaxes(arms, 1, 2) @ moved), 1, 2)
    return np.linalg.norm(found, ord=2, axis=(1, 2))


def largest(
    system: System, displacement: np.ndarray, above: float = 0.0
) -> tuple[float, np.ndarray]:
    """Largest gradient of ``displacement`` (n,3) m of the nodal arrays, and the centre (3,) m of its
    element in scene axes; elements whose nodes differ by at most ``above`` (m) are left out."""
    mesh, moved = system.mesh, displacement[system.number]
    worst, place = 0.0, np.zeros(3)
    for start in range(0, len(mesh.cells), _BATCH):
        cells = mesh.cells[start : start + _BATCH]
        apart = moved[cells] - moved[cells[:, :1]]
        cells = cells[(apart**2).sum(axis=2).max(axis=1) > above**2]
        if not len(cells):
            continue
        found = gradients(mesh.points[cells], moved[cells])
        at = int(found.argmax())
        if found[at] > worst:
            worst, place = float(found[at]), mesh.points[cells[at]].mean(axis=0)
    return worst, place


def fault(system: System, displacement: np.ndarray, harmless: float) -> str:
    """Reason why the rails are no longer linear, or ""; ``harmless`` (m): result of ``small``."""
    size = np.sqrt((displacement**2).sum(axis=1).max())
    if size <= harmless:
        return ""
    worst, place = largest(system, displacement, harmless)
    if worst <= MOST:
        return ""
    where = ", ".join(f"{1e3 * value:.4g}" for value in place)
    return (
        f"the rails turn or stretch by up to {worst:.3g} at ({where}) mm, displacements up to "
        f"{1e3 * size:.3g} mm; linear elasticity holds up to {MOST:g}"
    )
