"""Stiffness and lumped mass of a rail mesh, in the form that the explicit kernel uses.

    f(u) = sum over elements of scatter(K_class gather(u)),    m = sum over elements of scatter(m_class)

Elements that are translations of each other have the same matrix, so one matrix is stored per
class. A structured mesh has only a few classes, which stay in the fastest cache while the kernel
reads the elements. Joints under the mounts have their own sparse matrix (``statics.mounts``).
"""

from types import ModuleType
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array

from tipoff.highfi.elements import hexahedron, tetrahedron
from tipoff.highfi.mesh.cells import thickness
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import mounts
from tipoff.kernels.memory import aligned
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes.rail_base import MaterialTable

_SAME_SHAPE = 1e-9  # of the thinnest element; smaller differences of coordinates are ignored
_FORMULATION = {8: hexahedron, 10: tetrahedron}  # by the nodes of an element
_BATCH = 2048  # classes integrated at once; bounds the memory of an unstructured mesh


class Operator(NamedTuple):
    """Linear elastic operator of e elements with k nodes each in c shape classes over n nodes."""

    # Indices are unsigned, so that they need no test for negative values.
    cells: np.ndarray  # (e,k) node numbers
    shape_class: np.ndarray  # (e,)
    stiffness: np.ndarray  # (c,3k,3k) N/m, degrees of freedom node * 3 + component
    node_mass: np.ndarray  # (c,k) kg, share of one element in the mass of its nodes
    mass: np.ndarray  # (n,) kg
    free: np.ndarray  # (n,) False where the node is fixed
    joints: csr_array | None = None  # (3n,3n) N/m, stiffness of the joints under the mounts


def build(
    mesh: RailMesh,
    density: float,
    youngs_modulus: float,
    poisson_ratio: float,
    fixed: tuple[str, ...] = ("mount",),
    joint: MountStiffness | None = None,
) -> Operator:
    """Operator of a homogeneous isotropic solid: density kg/m3, Young's modulus Pa. Nodes of the
    `fixed` surfaces are held, those of ``mount`` by the springs of a `joint` if there is one.

    Raises ValueError for constants of no stable material.
    """
    if not (density > 0.0 and np.isfinite(density)):
        raise ValueError(f"density must be positive and finite, got {density!r} kg/m3")
    law = hexahedron.elasticity(youngs_modulus, poisson_ratio)
    shape_class, representatives = shape_classes(mesh)
    batches, formulation = _batches(mesh, representatives)
    stiffness = np.concatenate([formulation.stiffness(batch, law) for batch in batches])
    node_mass = np.concatenate([formulation.node_mass(batch, density) for batch in batches])
    mass = np.bincount(
        mesh.cells.ravel(), node_mass[shape_class].ravel(), minlength=len(mesh.points)
    )
    free = np.ones(len(mesh.points), dtype=np.bool_)
    joints = None
    for name in fixed:
        if joint is not None and name == "mount":
            joints = mounts.stiffness(mesh.points, mesh.surfaces[name], joint)
        else:
            free[mesh.surfaces[name]] = False
    return Operator(
        cells=mesh.cells.astype(np.uint32),
        shape_class=shape_class,
        stiffness=aligned(stiffness),
        node_mass=node_mass,
        mass=mass,
        free=free,
        joints=joints,
    )


def of_material(
    mesh: RailMesh,
    material: MaterialTable,
    joint: MountStiffness | None = None,
    fixed: tuple[str, ...] = ("mount",),
) -> Operator:
    """``build`` for the ``material`` of a scene."""
    return build(
        mesh,
        material.density,
        material.youngs_modulus,
        material.poisson_ratio,
        fixed=fixed,
        joint=joint,
    )


def expansion(mesh: RailMesh, youngs_modulus: float, poisson_ratio: float) -> np.ndarray:
    """Loads (c,3k,k) in N on an element of each class, from a free strain of one at each of its
    nodes in turn."""
    law = hexahedron.elasticity(youngs_modulus, poisson_ratio)
    batches, formulation = _batches(mesh, shape_classes(mesh)[1])
    return np.concatenate([formulation.expansion(batch, law) for batch in batches])


def _batches(mesh: RailMesh, representatives: np.ndarray) -> tuple[list[np.ndarray], ModuleType]:
    """Batches of the nodes (c,k,3) m of the first element of each class, and the module with their
    formulas."""
    nodes = mesh.points[mesh.cells[representatives]]
    return [nodes[start : start + _BATCH] for start in range(0, len(nodes), _BATCH)], _FORMULATION[
        mesh.cells.shape[1]
    ]


def shape_classes(mesh: RailMesh) -> tuple[np.ndarray, np.ndarray]:
    """Class (e,) of each element, and the first element (c,) of each class of translations of one
    another."""
    nodes = mesh.points[mesh.cells]
    grid = _SAME_SHAPE * thickness(mesh.points, mesh.cells).min()
    shape = np.round((nodes - nodes[:, :1]) / grid).reshape(len(nodes), -1)
    _, representatives, shape_class = np.unique(
        shape, axis=0, return_index=True, return_inverse=True
    )
    return shape_class.reshape(-1).astype(np.uint32), representatives


def sparse(operator: Operator) -> csr_array:
    """Assembled stiffness (3n,3n) in N/m including the joints, degrees of freedom node * 3 +
    component, for static and modal solutions."""
    size = 3 * len(operator.mass)
    width = operator.stiffness.shape[1]
    freedoms = (3 * operator.cells[:, :, None] + np.arange(3)).reshape(-1, width)
    rows = np.repeat(freedoms, width, axis=1).ravel()
    columns = np.tile(freedoms, (1, width)).ravel()
    solid = coo_array(
        (operator.stiffness[operator.shape_class].ravel(), (rows, columns)), shape=(size, size)
    ).tocsr()
    return solid if operator.joints is None else solid + operator.joints
