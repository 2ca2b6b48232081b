"""Ten-node tetrahedron: quadratic displacement, edges straight or curved, small strain, isotropic
Hooke's law.

    K = sum over points of w det J B^T C B,      m_a = m integral(N_a^2) / sum over b of integral(N_b^2)

Where edges are straight B is linear and J constant, so four points integrate exactly. Curved
elements take fourteen: J B then has degree three, and the patch test requires its exact integral.
Both rules have positive weights, so no energy is negative. Row sums of the consistent mass are
negative at the corners (-1/20 of the element's mass each), so no explicit step would be stable. The
diagonal scaled to the right total is positive for every element with a positive Jacobian.

Nodes follow the VTK order: four corners, then the middles of the edges 01 12 02 03 13 23.

Source: Hinton, Rock, Zienkiewicz, Earthquake Eng. Struct. Dyn. 4 (1976) 245-249, for the mass;
Cook, Malkus, Plesha, Witt, Concepts and Applications of Finite Element Analysis, 4th ed. 2002,
section 11.4.
"""

from typing import NamedTuple

import numpy as np
from skfem import ElementTetP2
from skfem.quadrature import get_quadrature

from tipoff.highfi.elements.hexahedron import integral, strain_matrix

EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
_STRAIGHT = 1e-6  # of the edge; a middle node nearer to the chord's middle is straight
_EXACT, _CURVED = 2, 5  # polynomial degree that the two rules integrate: 4 and 14 points


class Kinematics(NamedTuple):
    """Strain matrices at the quadrature points of c elements."""

    nodal: np.ndarray  # (c,q,6,30) 1/m, by node displacement
    volume: np.ndarray  # (c,q) m3 of each point


def shape_functions(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (10,q) and gradients (10,3,q) of the nodal functions at places (3,q) of the unit
    tetrahedron."""
    values, gradients = zip(*(ElementTetP2().lbasis(places, node) for node in range(10)))
    return np.array(values), np.array(gradients)


def jacobians(nodes: np.ndarray, gradients: np.ndarray) -> np.ndarray:
    """Derivative (c,q,3,3) in m of places by coordinates of the unit tetrahedron; nodes (c,10,3) m,
    gradients (10,3,q)."""
    return np.einsum("cai,ajq->cqij", nodes, gradients, optimize=True)


def kinematics(nodes: np.ndarray, degree: int = _CURVED) -> Kinematics:
    """Strain matrices of elements with nodes (c,10,3) m at the points of a rule of that degree."""
    places, weights = get_quadrature(ElementTetP2, degree)
    _, gradients = shape_functions(places)
    mapping = jacobians(nodes, gradients)
    across = np.einsum("ajq,cqji->cqai", gradients, np.linalg.inv(mapping), optimize=True)
    return Kinematics(strain_matrix(across), np.linalg.det(mapping) * weights)


def stiffness(nodes: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Stiffness (c,30,30) in N/m, degrees of freedom as node * 3 + component; nodes (c,10,3) m, law
    (6,6) Pa."""
    result = np.empty((len(nodes), 30, 30))
    straight = is_straight(nodes)
    for group, degree in ((straight, _EXACT), (~straight, _CURVED)):
        if group.any():
            strain = kinematics(nodes[group], degree)
            result[group] = integral(strain.nodal, law, strain.nodal, strain.volume)
    # symmetric to the last bit, so that energy is exact
    return 0.5 * (result + np.swapaxes(result, 1, 2))


def expansion(nodes: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Loads (c,30,10) in N of a free strain that is one at each node in turn."""
    strain, (values, _) = (
        kinematics(nodes),
        shape_functions(get_quadrature(ElementTetP2, _CURVED)[0]),
    )
    return np.einsum(
        "cqsd,s,aq,cq->cda",
        strain.nodal,
        law[:, :3].sum(axis=1),
        values,
        strain.volume,
        optimize=True,
    )


def node_mass(nodes: np.ndarray, density: float) -> np.ndarray:
    """Mass (c,10) in kg of each node of elements with nodes (c,10,3) m: the scaled diagonal of the
    module docstring."""
    places, weights = get_quadrature(ElementTetP2, _CURVED)
    values, gradients = shape_functions(places)
    volume = np.linalg.det(jacobians(nodes, gradients)) * weights
    diagonal = volume @ (values**2).T
    return density * diagonal * (volume.sum(axis=1) / diagonal.sum(axis=1))[:, None]


def is_straight(nodes: np.ndarray) -> np.ndarray:
    """Whether (c,) every edge has its middle node half way between its ends."""
    start, end = nodes[:, EDGES[:, 0]], nodes[:, EDGES[:, 1]]
    off = np.linalg.norm(nodes[:, 4:] - 0.5 * (start + end), axis=2)
    return (off <= _STRAIGHT * np.linalg.norm(end - start, axis=2)).all(axis=1)
