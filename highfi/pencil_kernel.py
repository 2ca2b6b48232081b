"""Internal force of an extruded mesh, pencil by pencil: three sums over the neighbouring pencils, then a filter along the layers.

    d = sum D u,  l = sum L u,  o = sum O u,      f(k) = d(k) + (l - o)(k-1) + (l + o)(k+1)

The nine sums of 16 layers stay in vector registers while the neighbours stream by. Numba does not keep them there from a loop in
Python, so that one loop is written as LLVM code; a processor with narrower vectors splits them.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from highfi.memory import zeros
from highfi.pencils import COEFFICIENTS, LANES
from scenes.jit import kernel

_WIDTH = 8
_HALVES = LANES // _WIDTH
# (sum, coefficient, component): sums 0-2 are d, 3-5 are l, 6-8 are o; written out as d, l - o, l + o.
_PRODUCTS = ((0, 0, 0), (1, 1, 1), (1, 2, 2), (2, 3, 1), (2, 4, 2), (3, 5, 0), (4, 6, 1), (4, 7, 2), (5, 8, 1), (5, 9, 2),
             (6, 10, 1), (6, 11, 2), (7, 12, 0), (8, 13, 0))
_SUMS = 9
_GHOSTS = 8  # zeros on either side of a row of sums: what lies beyond the end layers


@intrinsic
def _sum_neighbours(typing, values, neighbour, coefficients, first, last, layer, plane, sums, stride):
    """Rows ``layer`` to ``layer + 16`` of d, l - o and l + o, summed over the neighbours q in first..last.

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
        for h in range(_HALVES):
            own, even, odd = ([builder.load(held[3 * group + c][h]) for c in range(3)] for group in range(3))
            below, above = ([combine(l, o) for l, o in zip(even, odd)] for combine in (builder.fsub, builder.fadd))
            for target, total in enumerate([*own, *below, *above]):
                row = builder.add(layer, builder.mul(stride, ir.Constant(integer, target)))
                builder.store(total, vector_at(data(7), plus(row, _WIDTH * h)), align=8)
        return context.get_dummy_value()

    return signature, generate


def room_for_sums(stride: int, threads: int = 1) -> np.ndarray:
    """Room (threads, _SUMS, stride + 2 _GHOSTS) for the sums of one pencil, rows on cache lines and zero beside the pencil."""
    # An odd number of cache lines: rows a power of two apart would compete for the same places in the cache.
    return zeros((threads, _SUMS, stride + 2 * _GHOSTS + (_GHOSTS if (stride // _GHOSTS) % 2 == 0 else 0)))


@kernel
def pencil_force(pencils, displacement, force, first, last, sums):
    """Set the part of ``force`` (N) at section points ``first`` to ``last`` to that of K u, both (3, s * stride) in rows."""
    plane, stride, row = displacement.shape[1], pencils.stride, sums.shape[1]
    values, coefficients = displacement.reshape(displacement.size), pencils.coefficients.reshape(pencils.coefficients.size)
    inside = sums.reshape(sums.size)[_GHOSTS:]
    for point in range(first, last):
        for layer in range(0, stride, LANES):
            _sum_neighbours(values, pencils.neighbour, coefficients, pencils.first[point], pencils.first[point + 1], layer, plane,
                            inside, row)
        _filter(sums, force, np.uint64(point * stride), np.uint64(stride))
        _ends(pencils, point, displacement, force, sums)


@kernel
def _filter(sums, force, base, stride):
    # Unsigned, because an index that might be negative would keep the loop from being vectorised.
    ghosts, one = np.uint64(_GHOSTS), np.uint64(1)
    for component in range(3):
        own, below, above = np.uint64(component), np.uint64(3 + component), np.uint64(6 + component)
        for k in range(stride):
            here = ghosts + k
            force[own, base + k] = sums[own, here] + (sums[below, here - one] + sums[above, here + one])


@kernel
def _ends(pencils, point, displacement, force, sums):
    """The end layers have half the own block and, with opposite signs, the odd block E; what the filter left beyond is no force."""
    base, layers = point * pencils.stride, pencils.layers
    x, y, z, far_x, far_y, far_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(pencils.first[point], pencils.first[point + 1]):
        node = pencils.neighbour[q]
        far = node + layers - 1
        xy, xz, yx, zx = (pencils.coefficients[q, 14], pencils.coefficients[q, 15], pencils.coefficients[q, 16],
                          pencils.coefficients[q, 17])
        x += xy * displacement[1, node] + xz * displacement[2, node]
        y += yx * displacement[0, node]
        z += zx * displacement[0, node]
        far_x += xy * displacement[1, far] + xz * displacement[2, far]
        far_y += yx * displacement[0, far]
        far_z += zx * displacement[0, far]
    first, last = _GHOSTS, _GHOSTS + layers - 1
    force[0, base] += x - 0.5 * sums[0, first]
    force[1, base] += y - 0.5 * sums[1, first]
    force[2, base] += z - 0.5 * sums[2, first]
    force[0, base + layers - 1] -= far_x + 0.5 * sums[0, last]
    force[1, base + layers - 1] -= far_y + 0.5 * sums[1, last]
    force[2, base + layers - 1] -= far_z + 0.5 * sums[2, last]
    for component in range(3):
        for node in range(base + layers, base + pencils.stride):
            force[component, node] = 0.0
