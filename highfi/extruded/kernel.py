"""Internal force of an extruded mesh: three sums over the neighbouring columns for each column,
then a filter along the layers.

    d = sum D u,  l = sum L u,  o = sum O u,      f(k) = d(k) + (l - o)(k-1) + (l + o)(k+1)

The nine sums of 16 layers stay in vector registers during the loop over the neighbours; so do the
values of the 16 layers before that the filter needs. Neighbours that are mirror images are folded
into one (see ``folding``). Numba does not keep the sums in registers in a Python loop, so this loop
is written as LLVM code. A processor with narrower vectors splits them.
"""

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from tipoff.highfi.extruded.folding import KINDS, PATTERNS, PLACES, odd
from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.extruded.vectors import INTEGER, WIDTH, ZERO, Vectors
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel

_HALVES = LANES // WIDTH
_SUMS = 9
# The sum each number goes to: sums 0-2 are d, 3-5 are l, 6-8 are o.
_TARGETS = tuple(
    3 * (0 if n < 5 else 1 if n < 10 else 2) + row for n, (row, _) in enumerate(PLACES)
)


class _Arrays(NamedTuple):
    """Flat arrays that one column reads and writes; pointers to them in the LLVM code."""

    values: np.ndarray  # (3 * plane,) m, displacement
    members: np.ndarray  # see ``folding.Groups``
    numbers: np.ndarray
    counts: np.ndarray
    weights: np.ndarray  # share of D in each layer, then WIDTH zeros
    force: np.ndarray  # (3 * plane,) N
    lanes: np.ndarray  # (3 * WIDTH,) N m, sums of u x f


class _Place(NamedTuple):
    """Place of one column in the arrays."""

    pattern: int  # index in PATTERNS
    kind: int  # its first entry in ``counts``
    first_member: int
    first_number: int
    base: int  # its first node
    layers: int  # its padded length
    plane: int  # nodes of all columns


class _Sweep:
    """Writes the code that sets the force of one column. Fields of ``arrays`` are LLVM pointers,
    fields of ``place`` LLVM integers."""

    def __init__(self, builder, arrays: _Arrays, place: _Place):
        self.builder, self.code, self.arrays, self.place = builder, Vectors(builder), arrays, place
        self.held = [[self.code.variable() for _ in range(_HALVES)] for _ in range(_SUMS)]
        self.below, self.pending, self.turning = (
            [self.code.variable() for _ in range(3)] for _ in range(3)
        )

    def write(self, pattern):
        """All layers; with a ``pattern`` the numbers of groups are constants of the code."""
        self._clear(self.below, self.pending, self.turning)
        start, step = ir.Constant(INTEGER, 0), ir.Constant(INTEGER, LANES)
        with cgutils.for_range_slice(self.builder, start, self.place.layers, step, INTEGER) as (
            layer,
            _,
        ):
            self._clear(*self.held)
            self._add_groups(layer, pattern)
            self._finish(layer)
        self._store(
            [self.builder.load(part) for part in self.pending],
            self.code.plus(self.place.layers, -WIDTH),
        )
        for component, turning in enumerate(self.turning):
            place = ir.Constant(INTEGER, WIDTH * component)
            total = self.builder.fadd(
                self.code.read(self.arrays.lanes, place), self.builder.load(turning)
            )
            self.code.write(total, self.arrays.lanes, place)

    def _clear(self, *variables):
        for parts in variables:
            for part in parts:
                self.builder.store(ZERO, part)

    def _add_groups(self, layer, pattern):
        code, member, number = self.code, self.place.first_member, self.place.first_number
        for k, group in enumerate(KINDS):
            count = (
                ir.Constant(INTEGER, pattern[k])
                if pattern
                else code.number(self.arrays.counts, code.plus(self.place.kind, k))
            )
            if pattern:
                for index in range(pattern[k]):
                    self._add_group(group, layer, member, number, ir.Constant(INTEGER, index))
            else:
                with cgutils.for_range(self.builder, count, intp=INTEGER) as loop:
                    self._add_group(group, layer, member, number, loop.index)
            member = self.builder.add(member, code.times(count, group.members))
            number = self.builder.add(number, code.times(count, len(group.numbers)))

    def _add_group(self, group, layer, member, number, index):
        """Add the products of the group with this ``index``; its members and numbers start at
        ``member`` and ``number``."""
        code, builder = self.code, self.builder
        at = builder.add(member, code.times(index, group.members))
        starts = [
            builder.add(code.number(self.arrays.members, code.plus(at, m)), layer)
            for m in range(group.members)
        ]
        own = builder.add(number, code.times(index, len(group.numbers)))
        for component in range(3):
            rows = [builder.add(start, code.times(self.place.plane, component)) for start in starts]
            factors = {
                n: code.spread(code.number(self.arrays.numbers, code.plus(own, k)))
                for k, n in enumerate(group.numbers)
                if PLACES[n][1] == component
            }
            for half in range(_HALVES):
                folded = self._fold(
                    group,
                    [code.read(self.arrays.values, code.plus(row, WIDTH * half)) for row in rows],
                )
                for n, factor in factors.items():
                    total, value = (
                        self.held[_TARGETS[n]][half],
                        folded[tuple(odd(n, axis) for axis in group.folded)],
                    )
                    builder.store(code.multiply_add(factor, value, builder.load(total)), total)

    def _fold(self, group, parts):
        """Sums and differences of the members' values, by their parity in each folded axis."""
        folded = {(): parts}
        for _ in group.folded:
            # Members of + and - alternate: those of the first axis are adjacent.
            folded = {
                (*key, sign): [combine(a, b) for a, b in zip(values[0::2], values[1::2])]
                for key, values in folded.items()
                for sign, combine in ((False, self.builder.fadd), (True, self.builder.fsub))
            }
        return {key: value for key, (value,) in folded.items()}

    def _finish(self, layer):
        """Store the forces of the 16 layers that are complete: eight that waited and the first
        eight of these 16. The last eight wait for the layer above them."""
        first = self.builder.icmp_signed("==", layer, ir.Constant(INTEGER, 0))
        before, here = zip(*(self._filter(layer, component) for component in range(3)))
        # Before the first layer, the stored values have no meaning. They are overwritten at once
        # and must not enter the moment.
        self._store(before, self.builder.select(first, layer, self.code.plus(layer, -WIDTH)), first)
        self._store(here, layer)

    def _filter(self, layer, component):
        """One component of the eight waiting forces and of the next eight."""
        code, add = self.code, self.builder.fadd
        weights = [
            code.read(self.arrays.weights, code.plus(layer, WIDTH * half))
            for half in range(_HALVES)
        ]
        own, even, odds = (
            [self.builder.load(part) for part in self.held[3 * k + component]] for k in range(3)
        )
        below, above = (
            [combine(one, other) for one, other in zip(even, odds)]
            for combine in (self.builder.fsub, add)
        )
        last, pending = self.below[component], self.pending[component]
        before = add(self.builder.load(pending), code.slide(ZERO, above[0], 1))
        around = add(
            code.slide(self.builder.load(last), below[0], WIDTH - 1),
            code.slide(above[0], above[1], 1),
        )
        here = code.multiply_add(weights[0], own[0], around)
        around = add(code.slide(below[0], below[1], WIDTH - 1), code.slide(above[1], ZERO, 1))
        self.builder.store(code.multiply_add(weights[1], own[1], around), pending)
        self.builder.store(below[1], last)
        return before, here

    def _store(self, force, layer, void=None):
        """Store eight forces and add their u x f, unless ``void``."""
        code, at = self.code, self.builder.add(self.place.base, layer)
        rows = [
            self.builder.add(at, code.times(self.place.plane, component)) for component in range(3)
        ]
        places = [self.builder.gep(self.arrays.values, [row]) for row in rows]
        if void:
            nothing = self.builder.gep(self.arrays.weights, [self.place.layers])
            places = [self.builder.select(void, nothing, place) for place in places]
        values = [code.read(place, ir.Constant(INTEGER, 0)) for place in places]
        for component, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
            code.write(force[component], self.arrays.force, rows[component])
            total = code.multiply_add(
                values[j], force[k], self.builder.load(self.turning[component])
            )
            self.builder.store(
                code.multiply_add(self.builder.fneg(values[k]), force[j], total),
                self.turning[component],
            )


@intrinsic
def _column(typing, arrays, place):
    """Force of one column, without the odd block of its end layers; adds its sum of u x f to the
    rows of ``arrays.lanes``. Bounds are not checked. The most frequent patterns of groups have
    their own code without loops over the groups."""
    signature = types.void(arrays, place)

    def generate(context, builder, signature, arguments):
        kinds, given = signature.args[0].types, cgutils.unpack_tuple(builder, arguments[0])
        pointers = _Arrays(
            *(
                context.make_array(kind)(context, builder, value=value).data
                for kind, value in zip(kinds, given)
            )
        )
        at = _Place(*cgutils.unpack_tuple(builder, arguments[1]))
        sweep = _Sweep(builder, pointers, at)
        other, after = (builder.append_basic_block(name) for name in ("other", "after"))
        switch = builder.switch(at.pattern, other)
        for number, pattern in enumerate(PATTERNS):
            block = builder.append_basic_block("pattern")
            switch.add_case(ir.Constant(INTEGER, number), block)
            builder.position_at_end(block)
            sweep.write(pattern)
            builder.branch(after)
        builder.position_at_end(other)
        sweep.write(None)
        builder.branch(after)
        builder.position_at_end(after)
        return context.get_dummy_value()

    return signature, generate


@kernel
def column_force(columns, displacement, force, first, last, lanes, turn):
    """Set ``force`` (N) at section points ``first`` to ``last`` to K u; both are (3, s * stride) in
    rows. Set ``turn`` (3,) to the sum of u x K u (N m). ``lanes``: workspace of (3, WIDTH) numbers
    on a cache line."""
    groups, plane = columns.groups, displacement.shape[1]
    kinds, counts = groups.counts.shape[1], groups.counts.reshape(groups.counts.size)
    values, forces, flat = (
        displacement.reshape(displacement.size),
        force.reshape(force.size),
        lanes.reshape(lanes.size),
    )
    flat[:] = 0.0
    turn[:] = 0.0
    arrays = _Arrays(
        values=values,
        members=groups.members,
        numbers=groups.numbers,
        counts=counts,
        weights=columns.weights,
        force=forces,
        lanes=flat,
    )
    for point in range(first, last):
        place = _Place(
            pattern=groups.pattern[point],
            kind=point * kinds,
            first_member=groups.first_member[point],
            first_number=groups.first_number[point],
            base=point * columns.stride,
            layers=columns.stride,
            plane=plane,
        )
        _column(arrays, place)
        _add_ends(columns, point, displacement, force, turn)
    for component in range(3):
        for lane in range(WIDTH):
            turn[component] += flat[WIDTH * component + lane]


@kernel
def _add_ends(columns, point, displacement, force, turn):
    """Add the odd block E of the end layers, with opposite signs; values that the filter left
    beyond them are no forces."""
    base, layers = point * columns.stride, columns.layers
    x, y, z, far_x, far_y, far_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    # Unsigned, because a signed index needs a test for negative values.
    to_far = np.uint64(layers - 1)
    for q in range(np.uint64(columns.first[point]), np.uint64(columns.first[point + 1])):
        node = np.uint64(columns.neighbour[q])
        far = node + to_far
        xy, xz, yx, zx = (
            columns.ends[q, 0],
            columns.ends[q, 1],
            columns.ends[q, 2],
            columns.ends[q, 3],
        )
        x += xy * displacement[1, node] + xz * displacement[2, node]
        y += yx * displacement[0, node]
        z += zx * displacement[0, node]
        far_x += xy * displacement[1, far] + xz * displacement[2, far]
        far_y += yx * displacement[0, far]
        far_z += zx * displacement[0, far]
    _add_force(displacement, force, base, (x, y, z), turn)
    _add_force(displacement, force, base + layers - 1, (-far_x, -far_y, -far_z), turn)
    for component in range(3):
        for node in range(base + layers, base + columns.stride):
            force[component, node] = 0.0


@kernel
def _add_force(displacement, force, node, extra, turn):
    moment = rotation.cross(
        (displacement[0, node], displacement[1, node], displacement[2, node]), extra
    )
    for component in range(3):
        force[component, node] += extra[component]
        turn[component] += moment[component]
