"""Internal force of the elastic solid, f = K u, element by element without an assembled matrix.

A matrix of one class of hexahedra (4.6 kB) stays in the first-level cache; an assembled sparse
matrix would read 1.9 kB per node from memory. Displacements are relative to the first node of the
element: so a rigid translation gives exactly no force, and one eighth of the products is saved.
Each kind of element has its own loop, so that the compiler knows its length.
"""

import numpy as np

from tipoff.kernels.jit import njit


@njit
def internal_force(displacement, cells, shape_class, stiffness, force_out):
    """Set force_out (n,3) N to K u for displacement (n,3) m; cells, shape_class, stiffness as in
    `assembly.Operator`.

    force_out must not share memory with displacement.
    """
    force_out[:] = 0.0
    add_internal_force(
        displacement,
        cells,
        shape_class,
        stiffness,
        force_out,
        0,
        cells.shape[0],
        np.empty(3 * cells.shape[1]),
    )


@njit
def add_internal_force(
    displacement, cells, shape_class, stiffness, force_out, first, last, element_force
):
    """Add the share of elements ``first`` to ``last`` to ``force_out``; ``element_force`` is
    workspace for one, 24 or 30 numbers.

    Deterministic: elements are added in their order, and sums keep the written order for any vector
    width.
    """
    if cells.shape[1] == 8:
        _add_hexahedra(
            displacement, cells, shape_class, stiffness, force_out, first, last, element_force
        )
    else:
        _add_tetrahedra(
            displacement, cells, shape_class, stiffness, force_out, first, last, element_force
        )


@njit
def _add_hexahedra(
    displacement, cells, shape_class, stiffness, force_out, first, last, element_force
):
    for element in range(first, last):
        nodes = cells[element]
        k = stiffness[shape_class[element]]
        x1, y1, z1 = _relative(displacement, nodes[1], nodes[0])
        x2, y2, z2 = _relative(displacement, nodes[2], nodes[0])
        x3, y3, z3 = _relative(displacement, nodes[3], nodes[0])
        x4, y4, z4 = _relative(displacement, nodes[4], nodes[0])
        x5, y5, z5 = _relative(displacement, nodes[5], nodes[0])
        x6, y6, z6 = _relative(displacement, nodes[6], nodes[0])
        x7, y7, z7 = _relative(displacement, nodes[7], nodes[0])
        # One loop over the 24 contiguous outputs, which vectorises. The brackets are seven
        # independent chains of additions; without them the processor waits for each sum (52 instead
        # of 45 ns per element).
        for i in range(24):
            element_force[i] = (
                (k[3, i] * x1 + k[4, i] * y1 + k[5, i] * z1)
                + (k[6, i] * x2 + k[7, i] * y2 + k[8, i] * z2)
                + (k[9, i] * x3 + k[10, i] * y3 + k[11, i] * z3)
                + (k[12, i] * x4 + k[13, i] * y4 + k[14, i] * z4)
                + (k[15, i] * x5 + k[16, i] * y5 + k[17, i] * z5)
                + (k[18, i] * x6 + k[19, i] * y6 + k[20, i] * z6)
                + (k[21, i] * x7 + k[22, i] * y7 + k[23, i] * z7)
            )
        for corner in range(8):
            node = nodes[corner]
            force_out[node, 0] += element_force[3 * corner]
            force_out[node, 1] += element_force[3 * corner + 1]
            force_out[node, 2] += element_force[3 * corner + 2]


@njit
def _add_tetrahedra(
    displacement, cells, shape_class, stiffness, force_out, first, last, element_force
):
    for element in range(first, last):
        nodes = cells[element]
        k = stiffness[shape_class[element]]
        x1, y1, z1 = _relative(displacement, nodes[1], nodes[0])
        x2, y2, z2 = _relative(displacement, nodes[2], nodes[0])
        x3, y3, z3 = _relative(displacement, nodes[3], nodes[0])
        x4, y4, z4 = _relative(displacement, nodes[4], nodes[0])
        x5, y5, z5 = _relative(displacement, nodes[5], nodes[0])
        x6, y6, z6 = _relative(displacement, nodes[6], nodes[0])
        x7, y7, z7 = _relative(displacement, nodes[7], nodes[0])
        x8, y8, z8 = _relative(displacement, nodes[8], nodes[0])
        x9, y9, z9 = _relative(displacement, nodes[9], nodes[0])
        for i in range(30):
            element_force[i] = (
                (k[3, i] * x1 + k[4, i] * y1 + k[5, i] * z1)
                + (k[6, i] * x2 + k[7, i] * y2 + k[8, i] * z2)
                + (k[9, i] * x3 + k[10, i] * y3 + k[11, i] * z3)
                + (k[12, i] * x4 + k[13, i] * y4 + k[14, i] * z4)
                + (k[15, i] * x5 + k[16, i] * y5 + k[17, i] * z5)
                + (k[18, i] * x6 + k[19, i] * y6 + k[20, i] * z6)
                + (k[21, i] * x7 + k[22, i] * y7 + k[23, i] * z7)
                + (k[24, i] * x8 + k[25, i] * y8 + k[26, i] * z8)
                + (k[27, i] * x9 + k[28, i] * y9 + k[29, i] * z9)
            )
        for a in range(10):
            node = nodes[a]
            force_out[node, 0] += element_force[3 * a]
            force_out[node, 1] += element_force[3 * a + 1]
            force_out[node, 2] += element_force[3 * a + 2]


@njit(inline="always")
def _relative(displacement, node, origin):
    return (
        displacement[node, 0] - displacement[origin, 0],
        displacement[node, 1] - displacement[origin, 1],
        displacement[node, 2] - displacement[origin, 2],
    )
