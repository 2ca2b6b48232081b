"""A quarter of a thick cylinder in plane strain under inner pressure, which Lame solved."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tests.highfi.blocks import block, static, without_bubbles
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.statics import assembly

INNER, OUTER, PRESSURE, MODULUS = 3.0, 9.0, 1.0, 1000.0


class Solution(NamedTuple):
    """Mesh and mass (n,) kg of the quarter, and the displacement (n,3) m under pressure."""

    mesh: RailMesh
    mass: np.ndarray
    displacement: np.ndarray

    @property
    def radius(self) -> np.ndarray:
        """Radius (n,) of the nodes in m."""
        return np.hypot(self.mesh.points[:, 0], self.mesh.points[:, 1])

    @property
    def radial(self) -> np.ndarray:
        """Radial displacement (n,) in m."""
        return (self.mesh.points[:, :2] * self.displacement[:, :2]).sum(axis=1) / self.radius


def solve(refinement: int, poisson_ratio: float, bubbles: bool = True) -> Solution:
    """Static answer on 4 by 6 elements (through the wall, round the quarter), each divided
    `refinement` times both ways."""
    flat = block((4 * refinement, 6 * refinement, 1), (OUTER - INNER, 0.5 * np.pi, 1.0))
    radius, angle, z = (flat.points + np.array([INNER, 0.0, 0.0])).T
    mesh = replace(
        flat, points=np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
    )
    operator = assembly.build(mesh, 1.0, MODULUS, poisson_ratio, fixed=())
    if not bubbles:
        operator = without_bubbles(mesh, operator, MODULUS, poisson_ratio)
    held = np.stack(
        [np.isclose(angle, 0.5 * np.pi), angle == 0.0, np.ones_like(angle)], axis=1
    ).astype(bool)
    return Solution(mesh, operator.mass, static(operator, _pressure(mesh, radius == INNER), held))


def _pressure(mesh, inside):
    """Nodal forces (n,3) N of the pressure on the facets whose nodes are all `inside`; each facet
    is a plane rectangle."""
    facets = boundary_facets(mesh.cells)
    facets = facets[inside[facets].all(axis=1)]
    corners, load = mesh.points[facets], np.zeros(mesh.points.shape)
    outward = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    for corner in range(4):
        np.add.at(load, facets[:, corner], -0.25 * PRESSURE * outward)
    return load
