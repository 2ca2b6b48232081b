"""Baseline for the speed of the reference: central differences with an assembled SciPy matrix and
NumPy.

    f = K @ u,    v -= dt f / m,    u += dt v         K in compressed rows, lumped mass, no contact
"""

import numpy as np

from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly


class CsrLoop:
    """State of the baseline on the first ``most`` elements of a mesh, with an initial velocity."""

    def __init__(self, mesh: RailMesh, material, step: float, most: int):
        used, local = np.unique(mesh.cells[:most], return_inverse=True)
        part = RailMesh(mesh.points[used], local.reshape(-1, 8), {})
        operator = assembly.of_material(part, material, fixed=())
        self.elements, self.step, self.stiffness = len(part.cells), step, assembly.sparse(operator)
        self.inverse_mass = np.repeat(1.0 / operator.mass, 3)
        self.displacement, self.velocity = (
            np.zeros(3 * len(used)),
            1e-3 * np.sin(np.arange(3.0 * len(used))),
        )

    def advance(self, count: int) -> int:
        """Make ``count`` steps; returns how many times all elements were stepped."""
        taken = 0
        while taken < count:
            self.velocity -= self.step * self.inverse_mass * (self.stiffness @ self.displacement)
            self.displacement += self.step * self.velocity
            taken += 1
        return taken
