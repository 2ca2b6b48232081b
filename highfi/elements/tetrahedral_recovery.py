"""Strain at any point of ten-node tetrahedra from the displacement of their nodes;
``elements.hexahedral_recovery`` does the same for hexahedra.

    du/dX = sum over nodes of u_a (x) grad N_a,      grad N_a = J^-1 dN_a/dxi

No mode is condensed, so the strain does not depend on the law. Between straight edges J is constant and strain
linear; von Mises stress, strain and rotation are norms, hence convex, and largest at a corner.
Between curved edges they may be larger at the middle of one.
"""

import numpy as np

from tipoff.highfi.elements import hexahedron, tetrahedron

_CORNERS = np.eye(4)[:, 1:]
# (10,3) places on the unit tetrahedron
NODES = np.concatenate([_CORNERS, _CORNERS[tetrahedron.EDGES].mean(axis=1)])


def gradients(nodes: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Gradients (p,10,3) 1/m of the nodal functions at p points.

    nodes (p,10,3) m of the element around each point; local (p,3) its place on the unit
    tetrahedron.
    """
    _, slopes = tetrahedron.shape_functions(local.T)
    mapping = np.einsum("pai,ajp->pij", nodes, slopes)
    return np.einsum("ajp,pji->pai", slopes, np.linalg.inv(mapping))


def strain_matrix(nodes: np.ndarray, law: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Matrix (p,6,30) 1/m from the displacement of the nodes, node * 3 + component, to the strain
    at p points; see ``gradients``.

    Strain is ordered xx, yy, zz, xy, yz, zx, shear in engineering measure. ``law`` is
    not used; it is an argument of the function for hexahedra.
    """
    return hexahedron.strain_matrix(gradients(nodes, local))


def node_slopes(nodes: np.ndarray) -> np.ndarray:
    """Slopes (c,10,3,3) 1/m of local coordinate i along j at the nodes of elements with nodes
    (c,10,3) m."""
    _, slopes = tetrahedron.shape_functions(NODES.T)
    return np.linalg.inv(tetrahedron.jacobians(nodes, slopes))
