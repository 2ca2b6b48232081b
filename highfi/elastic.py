"""Internal force of the rails, by whichever kernel their mesh allows."""

from highfi.operator import internal_force
from highfi.pencil_kernel import pencil_force
from scenes.jit import njit


@njit
def elastic_force(rail, displacement, force):
    """Set ``force`` to K u (N): by pencils where the mesh is extruded, else element by element. Both (n,3), component-major."""
    _by_pencils(rail.pencils, displacement, force)
    _by_elements(rail.pencils, rail, displacement, force)


@njit
def _by_pencils(pencils, displacement, force):
    if pencils is not None:
        pencil_force(pencils, displacement.T, force.T)


@njit
def _by_elements(pencils, rail, displacement, force):
    if pencils is None:
        internal_force(displacement, rail.hexes, rail.shape_class, rail.stiffness, force)
