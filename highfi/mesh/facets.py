"""Control points, normals, shape functions and Gauss points of facets: bilinear ones of four corners
and quadratic ones of six nodes.

A quadratic triangle may bulge beyond its nodes. It lies in the convex hull of its six Bernstein
control points: the corners and, for each edge, 2 m - (a + b) / 2 with m the node between a and b
(Farin, Curves and Surfaces for CAGD, 5th ed. 2002, chapter 17). A bilinear facet lies in the hull
of its corners, which are its own control points.
"""

import numpy as np
from skfem import ElementTriP2
from skfem.quadrature import get_quadrature

# Polynomial degree of the symmetric rules on a triangle with positive weights and points inside
# (Dunavant, Int. J. Numer. Methods Eng. 21 (1985) 1129-1148), by their number of points.
_DEGREE = {3: 2, 6: 4, 12: 6, 16: 8, 19: 9, 25: 10, 33: 12, 42: 14, 61: 17, 73: 19}
INSIDE = 1e-6  # in local coordinates: a point with a smaller excess is inside its facet
_NEWTON = 20
_ARRIVED = 1e-12  # in local coordinates; the next step changes only the last bits
_FAR = 3.0  # local coordinates; beyond, the iteration stops


def control(nodes_per_facet: int) -> np.ndarray | None:
    """Matrix (6,6) from the nodes of a triangle to its control points; None for four nodes, which
    are the control points."""
    if nodes_per_facet == 4:
        return None
    matrix = np.eye(6)
    for middle, (a, b) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        matrix[middle, [a, b, middle]] = -0.5, -0.5, 2.0
    return matrix


def hull(nodes: np.ndarray) -> np.ndarray:
    """Control points (m,k,i) of facets with nodes (m,k,i), in space or in a plane."""
    matrix = control(nodes.shape[1])
    return nodes if matrix is None else np.einsum("ab,mbi->mai", matrix, nodes)


def normals(nodes: np.ndarray) -> np.ndarray:
    """Unit normals (m,3) out of the solid, from the corners of facets with nodes (m,k,3)."""
    if nodes.shape[1] == 4:
        across = np.cross(nodes[:, 2] - nodes[:, 0], nodes[:, 3] - nodes[:, 1])
    else:
        across = np.cross(nodes[:, 1] - nodes[:, 0], nodes[:, 2] - nodes[:, 0])
    return across / np.linalg.norm(across, axis=1, keepdims=True)


def weights(nodes: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (p,k) of the nodal functions at each ``target`` (p,2), for a facet with nodes (p,k,2)
    in a plane, by Newton's method, and whether the target is inside (p,)."""
    square = nodes.shape[1] == 4
    functions, middle = (_square_functions, 0.0) if square else (_triangle_functions, 1.0 / 3.0)
    place = np.full(target.shape, middle)
    for _ in range(_NEWTON):
        values, slopes = functions(place.T)
        missing = target - np.einsum("pa,pai->pi", values, nodes)
        step = np.linalg.solve(np.einsum("dpa,pai->pid", slopes, nodes), missing[:, :, None])[
            :, :, 0
        ]
        place = (place + step).clip(-_FAR, _FAR)
        if np.abs(step).max(initial=0.0) < _ARRIVED:
            break
    values = functions(place.T)[0]
    outside = (
        np.abs(place).max(axis=1) - 1.0
        if square
        else -np.minimum(place.min(axis=1), 1.0 - place.sum(axis=1))
    )
    # A target outside a curved facet may have no local coordinates.
    missed = np.abs(np.einsum("pa,pai->pi", values, nodes) - target).max(axis=1) / np.ptp(
        nodes, axis=1
    ).max(axis=1)
    return values, np.maximum(outside, missed) < INSIDE


def area(points: np.ndarray, facets: np.ndarray) -> float:
    """Area (m2) of ``facets`` (m,4) or (m,6) by Gauss quadrature, exact for plane facets."""
    return float(gauss(points[facets], 2)[1].sum())


def gauss(nodes: np.ndarray, quadrature: int) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (q,k) and areas (m,q) in m2 at the Gauss points of facets with nodes (m,k,3)
    m.

    A bilinear facet has ``quadrature`` points along each edge. A triangle with edges of the same
    length has at least as many per area, and at least three. All areas are positive; shape
    functions at the corners of a triangle may be negative.
    """
    shape, _, area = oriented(nodes, quadrature)
    return shape, area


def oriented(nodes: np.ndarray, quadrature: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shape functions (q,k), unit normals (m,q,3) out of the solid and areas (m,q) in m2 at the
    points of ``gauss``."""
    shape, along, weight = _bilinear(quadrature) if nodes.shape[1] == 4 else _quadratic(quadrature)
    r, s = np.einsum("dqa,mai->dmqi", along, nodes)
    across = np.cross(r, s)
    length = np.linalg.norm(across, axis=2)
    return shape, across / length[:, :, None], length * weight


def _bilinear(quadrature: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Functions (q,4), their derivatives (2,q,4) on the square from -1 to 1, and weights (q,)."""
    nodes, weight = np.polynomial.legendre.leggauss(quadrature)
    places = np.stack([grid.ravel() for grid in np.meshgrid(nodes, nodes, indexing="ij")])
    return *_square_functions(places), np.outer(weight, weight).ravel()


def _quadratic(quadrature: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As ``_bilinear``, (q,6), (2,q,6) and (q,) on the unit triangle."""
    # A triangle has half the area of a square with edges of the same length.
    degree = next(degree for points, degree in _DEGREE.items() if 2 * points >= quadrature**2)
    places, weight = get_quadrature(ElementTriP2, degree)
    return *_triangle_functions(places), weight


def _square_functions(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Functions (q,4) and their derivatives (2,q,4) at places (2,q) of the square from -1 to 1."""
    r, s = places
    ra, sa = np.array([-1.0, 1.0, 1.0, -1.0]), np.array([-1.0, -1.0, 1.0, 1.0])
    shape = 0.25 * (1.0 + np.outer(r, ra)) * (1.0 + np.outer(s, sa))
    return shape, np.stack(
        [0.25 * ra * (1.0 + np.outer(s, sa)), 0.25 * sa * (1.0 + np.outer(r, ra))]
    )


def _triangle_functions(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Functions (q,6) and their derivatives (2,q,6) at places (2,q) of the unit triangle."""
    values, gradients = zip(*(ElementTriP2().lbasis(places, node) for node in range(6)))
    return np.array(values).T, np.moveaxis(np.array(gradients), (1, 2, 0), (0, 1, 2))
