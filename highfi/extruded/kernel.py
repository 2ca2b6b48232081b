"""Internal force of an extruded mesh: sums over the neighbouring columns for each column, then a
filter along the layers. With the blocks of ``mesh``, for equal layers

    d = sum D u,  l = sum L u,  o = sum O u,      f(k) = d(k) + (l - o)(k-1) + (l + o)(k+1)

and for layers of any length h(k), from node k to k+1, with the weights v and w of Q and R

    q = sum Q u,  r = sum R u,  s = sum S u,  o = sum O u
    f(k) = [v(k-1) + v(k)] q(k) + [w(k-1) + w(k)] r(k)
           + h(k-1) s(k-1) - v(k-1) q(k-1) - w(k-1) r(k-1) - o(k-1)
           + h(k) s(k+1) - v(k) q(k+1) - w(k) r(k+1) + o(k+1)

The sums, nine or twelve, stay in vector registers during the loop over the neighbours: those of 16 layers
on a processor with vectors of 512 bits and 32 registers, those of four layers on others (``vectors.fitting_part``). The
result is the same to the last bit. Neighbours that are mirror images are folded into one (see ``folding``).
Numba does not keep the sums in registers in a Python loop, so this loop is written as LLVM code.
"""

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from tipoff.highfi.extruded.folding import EQUAL, KINDS, VARIANTS, Layout
from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.extruded.vectors import INTEGER, WIDTH, ZERO, Part, Vectors, fitting_part
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel

_HALVES = LANES // WIDTH


class _Arrays(NamedTuple):
    """Flat arrays that one column reads and writes; pointers to them in the LLVM code."""

    values: np.ndarray  # (3 * plane,) m, displacement
    members: np.ndarray  # see ``folding.Groups``
    numbers: np.ndarray
    counts: np.ndarray
    weights: np.ndarray  # see ``mesh.Columns``
    force: np.ndarray  # (3 * plane,) N
    lanes: np.ndarray  # (3 * WIDTH,) N m, sums of u x f


class _Place(NamedTuple):
    """Place of one column in the arrays."""

    variant: int  # index in VARIANTS
    kind: int  # its first entry in ``counts``
    first_member: int
    first_number: int
    base: int  # its first node
    layers: int  # its padded length
    plane: int  # nodes of all columns


class _Sweep:
    """Writes the code that sets the force of one column with this ``layout``. Fields of ``arrays`` are
    LLVM pointers, fields of ``place`` LLVM integers."""

    def __init__(self, builder, layout: Layout, arrays: _Arrays, place: _Place, part: Part):
        self.builder, self.code, self.arrays, self.place = builder, Vectors(builder), arrays, place
        self.layout, self.part, self.narrow = layout, part, Vectors(builder, part.width)
        self.held = [
            [self.narrow.variable() for _ in range(part.vectors)] for _ in range(3 * layout.blocks)
        ]
        # sums of 16 layers, on the stack
        self.kept = [self.code.numbers(LANES) for _ in range(3 * layout.blocks)]
        self.below, self.pending, self.turning = (
            [self.code.variable() for _ in range(3)] for _ in range(3)
        )

    def write(self, pattern):
        """All layers; numbers of groups in the ``pattern`` are constants of the code."""
        self._clear(self.below, self.pending, self.turning)
        start, step = ir.Constant(INTEGER, 0), ir.Constant(INTEGER, LANES)
        with cgutils.for_range_slice(self.builder, start, self.place.layers, step, INTEGER) as (
            layer,
            _,
        ):
            size = self.part.width * self.part.vectors
            if size == LANES:
                self._sum_part(layer, start, pattern)
            else:
                with cgutils.for_range_slice(
                    self.builder, start, step, ir.Constant(INTEGER, size), INTEGER
                ) as (first, _):
                    self._sum_part(self.builder.add(layer, first), first, pattern)
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

    def _sum_part(self, layer, first, pattern):
        """Sums of the layers of a part, from ``layer`` on; ``first`` is their place among the 16."""
        for parts in self.held:
            for part in parts:
                self.builder.store(self.narrow.zero, part)
        self._add_groups(layer, pattern)
        for parts, kept in zip(self.held, self.kept):
            for k, part in enumerate(parts):
                at = self.code.plus(first, k * self.part.width)
                self.narrow.write(self.builder.load(part), kept, at)

    def _clear(self, *variables):
        for parts in variables:
            for part in parts:
                self.builder.store(ZERO, part)

    def _add_groups(self, layer, pattern):
        code, member, number = self.code, self.place.first_member, self.place.first_number
        for k, (group, used) in enumerate(zip(KINDS, self.layout.used)):
            if pattern[k] is not None:
                count = ir.Constant(INTEGER, pattern[k])
                for index in range(pattern[k]):
                    self._add_group(k, layer, member, number, ir.Constant(INTEGER, index))
            else:
                count = code.number(self.arrays.counts, code.plus(self.place.kind, k))
                with cgutils.for_range(self.builder, count, intp=INTEGER) as loop:
                    self._add_group(k, layer, member, number, loop.index)
            member = self.builder.add(member, code.times(count, group.members))
            number = self.builder.add(number, code.times(count, len(used)))

    def _add_group(self, kind, layer, member, number, index):
        """Add the products of the group of a ``kind`` with this ``index``; its members and numbers
        start at ``member`` and ``number``."""
        code, builder, places = self.code, self.builder, self.layout.places
        group, used = KINDS[kind], self.layout.used[kind]
        at = builder.add(member, code.times(index, group.members))
        starts = [
            builder.add(code.number(self.arrays.members, code.plus(at, m)), layer)
            for m in range(group.members)
        ]
        own = builder.add(number, code.times(index, len(used)))
        for component in range(3):
            rows = [builder.add(start, code.times(self.place.plane, component)) for start in starts]
            factors = {
                places[n]: self.narrow.spread(code.number(self.arrays.numbers, code.plus(own, k)))
                for k, n in enumerate(used)
                if places[n].column == component
            }
            for k in range(self.part.vectors):
                starts_of_vectors = [code.plus(row, self.part.width * k) for row in rows]
                folded = self._fold(
                    group,
                    [self.narrow.read(self.arrays.values, each) for each in starts_of_vectors],
                )
                for place, factor in factors.items():
                    total, value = (
                        self.held[3 * place.block + place.row][k],
                        folded[tuple(map(place.odd, group.folded))],
                    )
                    added = self.narrow.multiply_add(factor, value, builder.load(total))
                    builder.store(added, total)

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
        parts = _equal if self.layout == EQUAL else _unequal
        own, below, above = zip(*(parts(self, layer, component, half) for half in range(_HALVES)))
        last, pending = self.below[component], self.pending[component]
        before = add(self.builder.load(pending), code.slide(ZERO, above[0], 1))
        around = add(
            code.slide(self.builder.load(last), below[0], WIDTH - 1),
            code.slide(above[0], above[1], 1),
        )
        here = self._sum(own[0], around)
        around = add(code.slide(below[0], below[1], WIDTH - 1), code.slide(above[1], ZERO, 1))
        self.builder.store(self._sum(own[1], around), pending)
        self.builder.store(below[1], last)
        return before, here

    def _sum(self, products, total):
        """``total`` and all ``products`` of two factors."""
        for factor, other in products:
            total = self.code.multiply_add(factor, other, total)
        return total

    def sums(self, component, half):
        """One component of the sums of all blocks, of eight layers."""
        return [
            self.code.read(self.kept[3 * block + component], ir.Constant(INTEGER, WIDTH * half))
            for block in range(self.layout.blocks)
        ]

    def weights(self, row, layer, half):
        """Eight of the weights in a ``row``, see ``mesh.Columns``."""
        length = self.code.plus(self.place.layers, LANES)
        start = self.builder.add(self.code.times(length, row), layer)
        return self.code.read(self.arrays.weights, self.code.plus(start, WIDTH * half))

    def _store(self, force, layer, void=None):
        """Store eight forces and add their u x f, unless ``void``."""
        code, at = self.code, self.builder.add(self.place.base, layer)
        rows = [
            self.builder.add(at, code.times(self.place.plane, component)) for component in range(3)
        ]
        places = [self.builder.gep(self.arrays.values, [row]) for row in rows]
        if void:
            zeros = self.code.plus(self.place.layers, LANES - WIDTH)
            nothing = self.builder.gep(self.arrays.weights, [zeros])
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


def _equal(sweep, layer, component, half):
    """Products whose sum is the contribution of eight nodes to their own force, and the contributions
    to the nodes above and below them, for equal layers."""
    own, even, odd = sweep.sums(component, half)
    weight = sweep.weights(0, layer, half)
    return [(weight, own)], sweep.builder.fsub(even, odd), sweep.builder.fadd(even, odd)


def _unequal(sweep, layer, component, half):
    """The same for layers of any lengths."""
    builder, code = sweep.builder, sweep.code
    *sums, odd = sweep.sums(component, half)
    here = code.plus(layer, WIDTH)
    after, before = (
        [sweep.weights(row, place, half) for row in range(len(sums))]
        for place in (here, code.plus(here, -1))
    )
    contributions = []
    for (v, w, length), total in ((after, builder.fneg(odd)), (before, odd)):
        factors = (builder.fneg(v), builder.fneg(w), length)
        for factor, value in zip(factors, sums):
            total = code.multiply_add(factor, value, total)
        contributions.append(total)
    own = [(builder.fadd(one, other), value) for one, other, value in zip(before, after, sums[:2])]
    return own, *contributions


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
        size = fitting_part(context.codegen())
        sweeps = {layout: _Sweep(builder, layout, pointers, at, size) for layout, _ in VARIANTS}
        last, after = (builder.append_basic_block(name) for name in ("variant", "after"))
        switch = builder.switch(at.variant, last)
        for number, (layout, pattern) in enumerate(VARIANTS):
            block = last
            if number < len(VARIANTS) - 1:
                block = builder.append_basic_block("variant")
                switch.add_case(ir.Constant(INTEGER, number), block)
            builder.position_at_end(block)
            sweeps[layout].write(pattern)
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
            variant=groups.variant[point],
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
