"""Structural damping of the rails, C = alpha M + beta K, on their motion relative to the frame.

With e(n) = K u(n) and d(n) = u(n) - u(n-1), the displacement of a step in frame axes, the
resistance of the nodes grows by

    f(n) = (beta / dt) [e(n) - e(n-1)] + (alpha / dt) m d(n)

so the velocity lags by half a step, the scheme stays explicit (``step_limit`` has its step), and
the elastic force of the last step is stored instead of a second product with K. A rail that moves
with its frame has d = 0 and no damping. K includes the joints under the mounts, so they are damped
like the rail, and the ratio of a mode depends on its frequency as in the surrogate. The opposite of
f acts on the frame at the place of the node: ``step`` already counts it for the part with K when it
sums elastic forces; the parts with m and of joints are summed here. The dissipated energy is the
work of f in halves around each kick, f(n) [d(n) + d(n+1)] / 2; it does not use strain and kinetic
energy.

Cost: on the reference scene at 4 mm a step takes 1.6 times as long (1.5 to 1.7; three more
nodal arrays to read and write), and steps get shorter, because the part with K grows with
frequency: a ratio of 0.001 at 500 Hz and 5 kHz is 0.10 at the highest frequency of the mesh and
takes 9 % off the step (500 to 455 ns), 0.01 is 1.0 there and takes 59 % (207 ns). Finer meshes pay
more: at 2 mm 0.01 takes 75 % (275 to 69 ns). Damping that is given at higher frequencies, or that
mass carries, costs less.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.mounts import begin_mounts, damp_mounts
from tipoff.highfi.extruded.mesh import LANES
from tipoff.highfi.state.records import TOTAL
from tipoff.kernels.jit import kernel


class _Component(NamedTuple):
    """One component of the nodal arrays of a block."""

    mass: np.ndarray  # (n,) kg
    displacement: np.ndarray  # (n,) m
    before: np.ndarray  # (n,) m, displacement one step ago
    resistance: np.ndarray  # (n,) N, K u; damping is added to it
    elastic: np.ndarray  # (n,) N, K u one step ago
    force: np.ndarray  # (n,) N, damping
    stiff: float  # beta / dt
    heavy: float  # alpha / dt, 1/s2
    first: int  # first node of the block
    last: int  # its last node, exclusive


@kernel
def add_damping(rail, state, block, dt, lanes):
    """Add damping to the elastic force that nodes of ``block`` have as their resistance.

    ``lanes`` (4, LANES) is workspace for sums lane by lane, in an order that does not depend on the
    number of threads.
    """
    history, damping = state.history, rail.damping
    drag, points = history.drag[block], rail.points.T
    drag[:] = 0.0
    history.loss[block] = 0.0
    for i in range(3):
        # The moment of a force along axis i about the other two.
        j, k = (i + 1) % 3, (i + 2) % 3
        component = _Component(
            mass=rail.mass,
            displacement=state.displacement.T[i],
            before=history.displacement.T[i],
            resistance=state.resistance.T[i],
            elastic=history.elastic.T[i],
            force=history.force.T[i],
            stiff=damping.stiffness_time / dt,
            heavy=damping.mass_rate / dt,
            first=np.uint64(rail.blocks[block]),
            last=np.uint64(rail.blocks[block + 1]),
        )
        lanes[:] = 0.0
        _add_inertial(component, points[j], points[k], lanes)
        _add_loss(component, lanes)
        _damp_component(component)
        for lane in range(LANES):
            history.loss[block] += lanes[0, lane]
            drag[i] += lanes[1, lane]
            drag[3 + j] += lanes[3, lane]
            drag[3 + k] -= lanes[2, lane]
    if rail.mounts.node.size > 0:
        damp_mounts(state.mounting, history, block, damping.stiffness_time / dt)


# One sum or one array a loop: with more of them the compiler cannot show that they do not overlap,
# and does not vectorise.
@kernel
def _add_inertial(component, beside, above, lanes):
    mass, displacement, before = component.mass, component.displacement, component.before
    for start in range(component.first, component.last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            inertial = component.heavy * mass[node] * (displacement[node] - before[node])
            lanes[1, lane] += inertial
            lanes[2, lane] += beside[node] * inertial
            lanes[3, lane] += above[node] * inertial


@kernel
def _add_loss(component, lanes):
    displacement, before, force = component.displacement, component.before, component.force
    for start in range(component.first, component.last, np.uint64(LANES)):
        for lane in range(np.uint64(LANES)):
            node = start + lane
            change = displacement[node] - before[node]
            lanes[0, lane] += 0.5 * (force[node] + _damping_force(component, node)) * change


@kernel
def _damping_force(component, node):
    change = component.displacement[node] - component.before[node]
    elastic_change = component.resistance[node] - component.elastic[node]
    return component.stiff * elastic_change + component.heavy * component.mass[node] * change


@kernel
def _damp_component(component):
    first, last, force, resistance = (
        component.first,
        component.last,
        component.force,
        component.resistance,
    )
    for node in range(first, last):
        force[node] = _damping_force(component, node)
    for node in range(first, last):
        component.elastic[node] = resistance[node]
        resistance[node] += force[node]
    for node in range(first, last):
        component.before[node] = component.displacement[node]


@kernel
def begin_damping(history, state):
    """Rails at rest in their frame: the present elastic force and places are those of the step
    before, too."""
    if history.loss.size > 0:
        for i in range(3):
            _copy(state.displacement.T[i], history.displacement.T[i])
            _copy(state.resistance.T[i], history.elastic.T[i])
        history.force[:] = 0.0
        history.drag[:] = 0.0
        history.loss[:] = 0.0
        begin_mounts(state.mounting, history)


@kernel
def _copy(source, target):
    for node in range(source.size):
        target[node] = source[node]


@kernel
def collect_damping(history, state):
    """Add the damping forces on the frame, of the parts with m and of joints, to
    ``state.reaction``, and the energy dissipated over the step to ``state.work``."""
    for block in range(history.loss.size):
        state.work[TOTAL].structural_damping += history.loss[block]
        for i in range(6):
            state.reaction[i] -= history.drag[block, i]
