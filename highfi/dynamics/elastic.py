"""Internal force of the rails and the motion of their nodes, by whichever kernel the mesh allows,
shared among threads.

On an extruded mesh each thread sweeps over its own chunks of pencils: a chunk moves, and the force
of a chunk follows as soon as all it hangs on has moved, while that is still in the cache. Chunks
that hang on another thread's wait for the barrier. A general mesh is cut into slabs along X:
elements of two even slabs share no node, nor do those of two odd ones.
"""

from tipoff.highfi.dynamics.damping import add_damping
from tipoff.highfi.extruded.kernel import pencil_force
from tipoff.highfi.state.nodes import hold, move_nodes, turning
from tipoff.highfi.state.threads import meet
from tipoff.highfi.statics.operator import add_internal_force
from tipoff.kernels.jit import kernel


@kernel
def elastic_force(rail, displacement, force, turn, team):
    """Set ``force`` (n,3) to K u (N), and ``turn`` (b,3) to each block's part of the sum of u x K u
    (N m); one thread's work."""
    for chunk in range(turn.shape[0]):
        _force_of_chunk(rail.pencils, displacement, force, chunk, turn, team.lanes[0])
    _force_of_elements(rail.elements, rail, displacement, force, turn, team.lanes[0])


@kernel
def _force_of_chunk(pencils, displacement, force, chunk, turn, lanes):
    if pencils is not None:
        pencil_force(
            pencils,
            displacement.T,
            force.T,
            pencils.chunks[chunk],
            pencils.chunks[chunk + 1],
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
        turning(displacement, force, rail.blocks[block], rail.blocks[block + 1], lanes, turn[block])


@kernel
def hold_blocks(rail, state, first, step):
    """Move the resistance of clamped nodes into ``state.clamping``, every ``step`` blocks from
    ``first`` on."""
    for block in range(first, state.clamping.shape[0], step):
        hold(rail, state.resistance, rail.held[block], rail.held[block + 1], state.clamping[block])


@kernel
def move_and_load(rail, frame, state, team, thread, dt):
    """Kick and drift all nodes, then set the elastic part of the new forces; every thread of
    ``team`` takes a part of it.

    On return all places are up to date; forces are once ``finish_load`` has been called and the
    team has met again.
    """
    _sweep_pencils(rail.pencils, rail, frame, state, team, thread, dt)
    _move_blocks(rail.elements, rail, frame, state, team, thread, dt)
    meet(team)


@kernel
def finish_load(rail, state, team, thread, dt):
    """What could not be computed before all nodes had moved."""
    _load_borders(rail.pencils, rail, state, team, thread, dt)
    _load_slabs(rail.elements, rail, state, team, thread, dt)


@kernel
def _share(pencils, team, thread):
    """First and last chunk of a thread."""
    chunks = pencils.chunks.size - 1
    return chunks * thread // team.size, chunks * (thread + 1) // team.size


@kernel
def _load_chunk(pencils, rail, state, chunk, lanes, dt):
    _force_of_chunk(pencils, state.displacement, state.resistance, chunk, state.turning, lanes)
    _damp(rail.damping, rail, state, chunk, dt, lanes)
    hold(rail, state.resistance, rail.held[chunk], rail.held[chunk + 1], state.clamping[chunk])


@kernel
def _damp(damping, rail, state, block, dt, lanes):
    if damping is not None:
        add_damping(damping, state.history, rail, state, block, dt, lanes)
        turning(
            state.displacement,
            state.resistance,
            rail.blocks[block],
            rail.blocks[block + 1],
            lanes,
            state.turning[block],
        )


@kernel
def _sweep_pencils(pencils, rail, frame, state, team, thread, dt):
    if pencils is not None:
        first, last = _share(pencils, team, thread)
        following = first
        for chunk in range(first, last):
            move_nodes(rail, frame, state, dt, rail.blocks[chunk], rail.blocks[chunk + 1])
            while following < last and pencils.highest[following] <= chunk:
                if pencils.lowest[following] >= first:
                    _load_chunk(pencils, rail, state, following, team.lanes[thread], dt)
                following += 1


@kernel
def _load_borders(pencils, rail, state, team, thread, dt):
    if pencils is not None:
        first, last = _share(pencils, team, thread)
        for chunk in range(first, last):
            if pencils.lowest[chunk] < first or pencils.highest[chunk] >= last:
                _load_chunk(pencils, rail, state, chunk, team.lanes[thread], dt)


@kernel
def _move_blocks(elements, rail, frame, state, team, thread, dt):
    if elements is not None:
        for block in range(thread, state.turning.shape[0], team.size):
            first, last = rail.blocks[block], rail.blocks[block + 1]
            move_nodes(rail, frame, state, dt, first, last)
            state.resistance[first:last] = 0.0


@kernel
def _load_slabs(elements, rail, state, team, thread, dt):
    if elements is not None:
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
            meet(team)
        _turn_blocks(
            rail, state.displacement, state.resistance, state.turning, thread, team.size, lanes
        )
        for block in range(thread, state.turning.shape[0], team.size):
            _damp(rail.damping, rail, state, block, dt, lanes)
        hold_blocks(rail, state, thread, team.size)
