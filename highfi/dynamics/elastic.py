"""Elastic force of the rails and the motion of their nodes, shared among threads.

On an extruded mesh each thread takes its own chunks of columns. After a chunk and all chunks that
it depends on have moved, its force follows while they are still in the cache. Chunks that depend on
a chunk of another thread wait for the barrier. Any other mesh is cut into slabs along X: elements
of two even slabs share no node, nor do those of two odd ones.
"""

from tipoff.highfi.dynamics.damping import add_damping
from tipoff.highfi.dynamics.mounts import add_mounts
from tipoff.highfi.extruded.kernel import column_force
from tipoff.highfi.state.nodes import hold, move_nodes, sum_turning
from tipoff.highfi.state.records import DAMPING, MOUNTS
from tipoff.highfi.state.threads import barrier
from tipoff.highfi.statics.operator import add_internal_force
from tipoff.kernels.jit import entry, kernel
from tipoff.mechanics.absent import damps


@entry
def elastic_force(rail, displacement, force, turn, mounting, team):
    """Set ``force`` (n,3) to K u (N), joints included, ``turn`` (b,3) to each block's part of the
    sum of u x K u (N m), and ``mounting`` (b,6) to the sums of the joints, if there are joints; the
    work of one thread."""
    for chunk in range(turn.shape[0]):
        _force_of_chunk(rail.columns, displacement, force, chunk, turn, team.lanes[0])
    _force_of_elements(rail.elements, rail, displacement, force, turn, team.lanes[0])
    if rail.mounts.node.size > 0:
        for block in range(turn.shape[0]):
            add_mounts(rail.mounts, rail, displacement, force, block, turn[block], mounting)


@kernel
def _force_of_chunk(columns, displacement, force, chunk, turn, lanes):
    if columns is not None:
        column_force(
            columns,
            displacement.T,
            force.T,
            columns.chunks[chunk],
            columns.chunks[chunk + 1],
            lanes,
            turn[chunk],
        )


@kernel
def _force_of_elements(elements, rail, displacement, force, turn, lanes):
    if elements is not None:
        force[:] = 0.0
        add_internal_force(
            displacement,
            elements.cells,
            elements.shape_class,
            elements.stiffness,
            force,
            0,
            elements.cells.shape[0],
            lanes.reshape(lanes.size),
        )
        _turn_blocks(rail, displacement, force, turn, 0, 1, lanes)


@kernel
def _turn_blocks(rail, displacement, force, turn, first, step, lanes):
    for block in range(first, turn.shape[0], step):
        sum_turning(
            displacement, force, rail.blocks[block], rail.blocks[block + 1], lanes, turn[block]
        )


@kernel
def hold_blocks(rail, state, first, step):
    """Move the resistance of clamped nodes into ``state.clamping``, every ``step`` blocks from
    ``first`` on."""
    for block in range(first, state.clamping.shape[0], step):
        hold(
            rail,
            state.resistance,
            rail.first_clamped[block],
            rail.first_clamped[block + 1],
            state.clamping[block],
        )


@kernel
def move_and_load(rail, frame, state, team, thread, dt):
    """Kick and drift all nodes, then set the elastic part of the new forces; called by every thread
    of ``team``.

    On return all places are up to date. The forces are complete after ``finish_load`` and one more
    barrier.
    """
    _sweep_columns(rail.columns, rail, frame, state, team, thread, dt)
    _move_blocks(rail.elements, rail, frame, state, team, thread, dt)
    barrier(team)


@kernel
def finish_load(rail, state, team, thread, dt):
    """Compute the forces that need the motion of all nodes."""
    _load_borders(rail.columns, rail, state, team, thread, dt)
    _load_slabs(rail.elements, rail, state, team, thread, dt)


@kernel
def _share(stepped, team, thread):
    """First and last place of a thread's part of the stepped chunks."""
    count = stepped.in_use[0]
    return count * thread // team.size, count * (thread + 1) // team.size


@kernel
def _load_chunk(columns, rail, state, chunk, lanes, dt):
    _force_of_chunk(columns, state.displacement, state.resistance, chunk, state.turning, lanes)
    _join(rail, state, chunk)
    _damp(rail, state, chunk, dt, lanes)
    hold(
        rail,
        state.resistance,
        rail.first_clamped[chunk],
        rail.first_clamped[chunk + 1],
        state.clamping[chunk],
    )


@kernel
def _join(rail, state, block):
    if rail.mounts.node.size > 0:
        _count(state, MOUNTS, block)
        add_mounts(
            rail.mounts,
            rail,
            state.displacement,
            state.resistance,
            block,
            state.turning[block],
            state.mounting,
        )


@kernel
def _damp(rail, state, block, dt, lanes):
    if damps(rail.damping):
        _count(state, DAMPING, block)
        add_damping(rail, state, block, dt, lanes)
        sum_turning(
            state.displacement,
            state.resistance,
            rail.blocks[block],
            rail.blocks[block + 1],
            lanes,
            state.turning[block],
        )


@kernel
def _count(state, effect, block):
    """Count the evaluation of an effect of all blocks, at the first one, which one thread loads. Others
    must not write: adding zero could undo the count of that thread."""
    if block == state.stepped.block[0]:
        state.evaluated[effect] += 1


@kernel
def _sweep_columns(columns, rail, frame, state, team, thread, dt):
    if columns is not None:
        order = state.stepped.block
        first, last = _share(state.stepped, team, thread)
        following = first
        for k in range(first, last):
            chunk = order[k]
            move_nodes(rail, frame, state, dt, rail.blocks[chunk], rail.blocks[chunk + 1])
            # A chunk depends only on chunks of its own rail, which are stepped as well.
            while following < last and columns.highest[order[following]] <= chunk:
                if columns.lowest[order[following]] >= order[first]:
                    _load_chunk(columns, rail, state, order[following], team.lanes[thread], dt)
                following += 1


@kernel
def _load_borders(columns, rail, state, team, thread, dt):
    if columns is not None:
        order = state.stepped.block
        first, last = _share(state.stepped, team, thread)
        for k in range(first, last):
            chunk = order[k]
            if columns.lowest[chunk] < order[first] or columns.highest[chunk] > order[last - 1]:
                _load_chunk(columns, rail, state, chunk, team.lanes[thread], dt)


@kernel
def _move_blocks(elements, rail, frame, state, team, thread, dt):
    if elements is not None:
        for k in range(thread, state.stepped.in_use[0], team.size):
            block = state.stepped.block[k]
            first, last = rail.blocks[block], rail.blocks[block + 1]
            move_nodes(rail, frame, state, dt, first, last)
            state.resistance[first:last] = 0.0


@kernel
def _load_slabs(elements, rail, state, team, thread, dt):
    if elements is not None:
        # Elements are not sorted by rails, so all rails are stepped or none is.
        if state.stepped.in_use[0] == 0:
            return
        lanes = team.lanes[thread]
        for parity in range(2):
            for slab in range(parity + 2 * thread, elements.slabs.size - 1, 2 * team.size):
                add_internal_force(
                    state.displacement,
                    elements.cells,
                    elements.shape_class,
                    elements.stiffness,
                    state.resistance,
                    elements.slabs[slab],
                    elements.slabs[slab + 1],
                    lanes.reshape(lanes.size),
                )
            barrier(team)
        _turn_blocks(
            rail, state.displacement, state.resistance, state.turning, thread, team.size, lanes
        )
        for block in range(thread, state.turning.shape[0], team.size):
            _join(rail, state, block)
            _damp(rail, state, block, dt, lanes)
        hold_blocks(rail, state, thread, team.size)
