"""Internal force of an extruded mesh, pencil by pencil: three sums over the neighbouring pencils, then a filter along the layers.

    d = sum D u,  l = sum L u,  o = sum O u,      f(k) = d(k) + l(k-1) + l(k+1) + o(k+1) - o(k-1)

The nine sums of 16 layers stay in vector registers while the neighbours stream by. Numba does not keep them there from a loop in
Python, so that one loop is written as LLVM code; a processor with narrower vectors splits them.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from highfi.pencils import COEFFICIENTS, LANES
from scenes.jit import njit

_WIDTH = 8
_HALVES = LANES // _WIDTH
# (sum, coefficient, component): sums 0-2 are d, 3-5 are l, 6-8 are o.
_PRODUCTS = ((0, 0, 0), (1, 1, 1), (1, 2, 2), (2, 3, 1), (2, 4, 2), (3, 5, 0), (4, 6, 1), (4, 7, 2), (5, 8, 1), (5, 9, 2),
             (6, 10, 1), (6, 11, 2), (7, 12, 0), (8, 13, 0))
_SUMS = 9


@intrinsic
def _sum_neighbours(typing, values, neighbour, coefficients, first, last, layer, plane, sums, stride):
    """sums[i, layer:layer+16] = sum over q in first..last of coefficient * values[component, neighbour[q] + layer : + 16].

    All arrays are flat: values (3 * plane), coefficients (q * COEFFICIENTS), sums (9 * stride). No bounds are checked.
    """
    size = types.intp
    signature = types.void(values, neighbour, coefficients, size, size, size, size, sums, size)

    def generate(context, builder, signature, arguments):
        def data(position):
            return context.make_array(signature.args[position])(context, builder, value=arguments[position]).data

        integer = ir.IntType(64)
        vector = ir.VectorType(ir.DoubleType(), _WIDTH)
        multiply_add = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(vector, [vector] * 3), f"llvm.fmuladd.v{_WIDTH}f64")

        def plus(value, offset):
            return builder.add(value, ir.Constant(integer, offset))

        def vector_at(pointer, index):
            return builder.bitcast(builder.gep(pointer, [index]), vector.as_pointer())

        def spread(scalar):
            one = builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0))
            return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined),
                                          ir.Constant(ir.VectorType(ir.IntType(32), _WIDTH), [0] * _WIDTH))

        zero = ir.Constant(vector, [0.0] * _WIDTH)
        held = [[cgutils.alloca_once_value(builder, zero) for _ in range(_HALVES)] for _ in range(_SUMS)]
        _, _, _, first, last, layer, plane, _, stride = arguments
        with cgutils.for_range_slice(builder, first, last, ir.Constant(integer, 1), integer) as (q, _):
            start = builder.add(builder.load(builder.gep(data(1), [q])), layer)
            rows = [builder.add(start, builder.mul(plane, ir.Constant(integer, c))) for c in range(3)]
            read = [[builder.load(vector_at(data(0), plus(row, _WIDTH * h)), align=8) for h in range(_HALVES)] for row in rows]
            own = builder.mul(q, ir.Constant(integer, COEFFICIENTS))
            for target, coefficient, component in _PRODUCTS:
                factor = spread(builder.load(builder.gep(data(2), [plus(own, coefficient)])))
                for h in range(_HALVES):
                    total = builder.call(multiply_add, [factor, read[component][h], builder.load(held[target][h])])
                    builder.store(total, held[target][h])
        for target in range(_SUMS):
            row = builder.add(layer, builder.mul(stride, ir.Constant(integer, target)))
            for h in range(_HALVES):
                builder.store(builder.load(held[target][h]), vector_at(data(7), plus(row, _WIDTH * h)), align=8)
        return context.get_dummy_value()

    return signature, generate


@njit
def pencil_force(pencils, displacement, force):
    """Set ``force`` (N) to K u of ``displacement`` (m), both (3, s * stride) with contiguous rows."""
    plane, stride = displacement.shape[1], pencils.stride
    values, coefficients = displacement.reshape(displacement.size), pencils.coefficients.reshape(pencils.coefficients.size)
    sums = np.empty((_SUMS, stride))
    flat = sums.reshape(sums.size)
    for point in range(pencils.first.size - 1):
        first, last = pencils.first[point], pencils.first[point + 1]
        for layer in range(0, stride, LANES):
            _sum_neighbours(values, pencils.neighbour, coefficients, first, last, layer, plane, flat, stride)
        for component in range(3):
            row = force[component, point * stride:point * stride + pencils.layers]
            _filter(sums[component], sums[3 + component], sums[6 + component], pencils.layers, row)
        _ends(pencils, point, displacement, force)


@njit
def _filter(own, even, odd, layers, out):
    # Slices instead of k-1 and k+1: an index that might be negative would keep the loop from being vectorised.
    inner, middle = out[1:layers - 1], own[1:layers - 1]
    even_below, even_above = even[0:layers - 2], even[2:layers]
    odd_below, odd_above = odd[0:layers - 2], odd[2:layers]
    for k in range(layers - 2):
        inner[k] = middle[k] + (even_below[k] + even_above[k]) + (odd_above[k] - odd_below[k])
    out[0] = 0.5 * own[0] + even[1] + odd[1]
    out[layers - 1] = 0.5 * own[layers - 1] + even[layers - 2] - odd[layers - 2]


@njit
def _ends(pencils, point, displacement, force):
    """The odd block E that only the first and the last layer have."""
    for end in range(2):
        layer, sign = (0, 1.0) if end == 0 else (pencils.layers - 1, -1.0)
        x, y, z = 0.0, 0.0, 0.0
        for q in range(pencils.first[point], pencils.first[point + 1]):
            node, e = pencils.neighbour[q] + layer, pencils.coefficients[q, 14:18]
            x += e[0] * displacement[1, node] + e[1] * displacement[2, node]
            y += e[2] * displacement[0, node]
            z += e[3] * displacement[0, node]
        node = point * pencils.stride + layer
        force[0, node] += sign * x
        force[1, node] += sign * y
        force[2, node] += sign * z
