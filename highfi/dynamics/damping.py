"""Structural damping of the rails, C = alpha M + beta K, on their motion relative to the frame.

With e(n) = K u(n) and d(n) = u(n) - u(n-1), the displacement of a step in frame axes, the
resistance of the nodes grows by

    f(n) = (beta / dt) [e(n) - e(n-1)] + (alpha / dt) m d(n)

so the velocity lags by half a step, the scheme stays explicit (``limits`` has its step), and the
elastic force, kept for one step, spares a second product with K. A rail that turns or falls with
its frame has d = 0 and feels nothing. The opposite of f acts on the frame where the node is: that
of the part with K is already in how ``step`` sums elastic forces, that of the part with m is summed
here. The energy taken is the work of f in halves around each kick, f(n) [d(n) + d(n+1)] / 2, which
knows nothing of strain and kinetic energy.

What it costs: on the reference scene at 4 mm a step takes 1.6 times as long (1.5 to 1.7; three more
nodal arrays to read and write), and steps get shorter, because the part with K grows with
frequency: a ratio of 0.001 at 500 Hz and 5 kHz is 0.10 at the highest frequency of the mesh and
takes 9 % off the step (500 to 455 ns), 0.01 is 1.0 there and takes 59 % (207 ns). Finer meshes pay
more: at 2 mm 0.01 takes 75 % (275 to 69 ns). Damping that is given at higher frequencies, or that
mass carries, costs less.
"""

import numpy as np

from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.state.records import STRUCTURAL_DAMPING
from tipoff.kernels.jit import kernel


@kernel
def add_damping(damping, history, rail, state, block, dt, lanes):
    """Add damping to the elastic force that nodes of ``block`` have as their resistance; not
    compiled when ``damping`` is None.

    ``lanes`` (4, LANES) is room for sums taken lane by lane, in an order that does not hang on who
    computes them.
    """
    if damping is not None:
        stiff, heavy = damping.stiffness_time / dt, damping.mass_rate / dt
        first, last = np.uint64(rail.blocks[block]), np.uint64(rail.blocks[block + 1])
        u, r, before, elastic, force = (
            state.displacement.T,
            state.resistance.T,
            history.displacement.T,
            history.elastic.T,
            history.force.T,
        )
        drag = history.drag[block]
        drag[:] = 0.0
        history.loss[block] = 0.0
        for i in range(3):
            # The moment of a force along axis i about the other two.
            j, k = (i + 1) % 3, (i + 2) % 3
            lanes[:] = 0.0
            _add_inertial(
                rail.mass,
                rail.points.T[j],
                rail.points.T[k],
                u[i],
                before[i],
                heavy,
                first,
                last,
                lanes,
            )
            _add_loss(
                rail.mass,
                u[i],
                before[i],
                r[i],
                elastic[i],
                force[i],
                stiff,
                heavy,
                first,
                last,
                lanes,
            )
            _damp_component(
                rail.mass, u[i], before[i], r[i], elastic[i], force[i], stiff, heavy, first, last
            )
            for lane in range(LANES):
                history.loss[block] += lanes[0, lane]
                drag[i] += lanes[1, lane]
                drag[3 + j] += lanes[3, lane]
                drag[3 + k] -= lanes[2, lane]


# One sum or one array a loop: with more of them the compiler gives up telling whether they overlap,
# and vectorises none.
@kernel
def _add_inertial(mass, beside, above, displacement, before, heavy, first, last, lanes):
    for start in range(first, last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            inertial = heavy * mass[node] * (displacement[node] - before[node])
            lanes[1, lane] += inertial
            lanes[2, lane] += beside[node] * inertial
            lanes[3, lane] += above[node] * inertial


@kernel
def _add_loss(
    mass, displacement, before, resistance, elastic, force, stiff, heavy, first, last, lanes
):
    for start in range(first, last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            change = displacement[node] - before[node]
            added = _added(mass[node], change, resistance[node] - elastic[node], stiff, heavy)
            lanes[0, lane] += 0.5 * (force[node] + added) * change


@kernel
def _added(mass, change, elastic_change, stiff, heavy):
    return stiff * elastic_change + heavy * mass * change


@kernel
def _damp_component(
    mass, displacement, before, resistance, elastic, force, stiff, heavy, first, last
):
    for node in range(first, last):
        force[node] = _added(
            mass[node],
            displacement[node] - before[node],
            resistance[node] - elastic[node],
            stiff,
            heavy,
        )
    for node in range(first, last):
        elastic[node] = resistance[node]
        resistance[node] += force[node]
    for node in range(first, last):
        before[node] = displacement[node]


@kernel
def begin_damping(history, state):
    """Rails at rest in their frame: the present elastic force and places are those of the step
    before, too."""
    if history is not None:
        for i in range(3):
            _copy(state.displacement.T[i], history.displacement.T[i])
            _copy(state.resistance.T[i], history.elastic.T[i])
        history.force[:] = 0.0
        history.drag[:] = 0.0
        history.loss[:] = 0.0


@kernel
def _copy(source, target):
    for node in range(source.size):
        target[node] = source[node]


@kernel
def collect_damping(history, state):
    """What the part with m does to the frame into ``state.reaction``, the energy taken over the
    step into ``state.work``."""
    if history is not None:
        for block in range(history.loss.size):
            state.work[STRUCTURAL_DAMPING] += history.loss[block]
            for i in range(6):
                state.reaction[i] -= history.drag[block, i]
