"""Time integration: explicit central differences (leapfrog) for rail nodes, payload and platform
together.

At time n, places and forces are of n and velocities of n - 1/2. One step is: kick ``v += dt f/m``,
drift (``pose``), forces::

    rail node   w += dt f / m                    f = -K u - damping + contact
    payload     v += dt F / m,  h += dt M
    platform    P += dt (F_c - sum f),  spin += dt (T_c - sum (X + u) x f)      sums over the moving nodes

The platform takes the elastic force at the clamps in its variational form: the force and moment of
the strain energy u'Ku/2 on the frame while the nodes keep their places in space. So linear *and*
angular momentum are exact; the sum of clamp forces alone would lose sum u x f. F_c and T_c are
contact on all rail nodes, clamped or not. As K u has no resultant and no moment about the
undeformed places, both sums need the dense nodal arrays only for u x K u. The same holds for the
part of structural damping (``damping``) that is proportional to K. Three parts are summed node by
node: the part proportional to mass, the forces of joints under the mounts, and their damping
(``mounts``). They have a resultant. On joints all nodes of the rail move.

All threads of the team move and load nodes and search contact; before that the first one moves the
bodies.

Python calls one entry, ``perform``, with a ``Task``: the code that unpacks the records for an entry
takes a second to compile.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.contact.pads import collect_contact, contact_forces
from tipoff.highfi.dynamics.damping import begin_damping, collect_damping
from tipoff.highfi.dynamics.elastic import elastic_force, finish_load, hold_blocks, move_and_load
from tipoff.highfi.dynamics.ending import begin, follow
from tipoff.highfi.dynamics.guide_loads import begin_loads, follow_loads
from tipoff.highfi.dynamics.hold_down import hold
from tipoff.highfi.dynamics.loads import (
    accelerate,
    add_external_impulse,
    add_work,
    body_force_in_frame,
    thrust_load,
)
from tipoff.highfi.dynamics.mounts import collect_mounts
from tipoff.highfi.dynamics.observe import find_fastest, sum_nodes
from tipoff.highfi.dynamics.pushers import begin_pushers, kick_pushers, load_pushers
from tipoff.highfi.state.nodes import kick_nodes
from tipoff.highfi.state.pose import drift_body, less, plus, pose_in_frame, small_turn, triple
from tipoff.highfi.state.records import PLATFORM
from tipoff.highfi.state.threads import barrier, reset_queue
from tipoff.kernels import rotation
from tipoff.kernels.jit import entry, inlined, kernel

EVALUATE, KICK, OBSERVE, OPEN, ADVANCE = range(5)


class Task(NamedTuple):
    """Task of ``perform``."""

    kind: int  # EVALUATE, KICK, OBSERVE, OPEN or ADVANCE
    first_step: int  # number of the step to begin with, whose places are the present ones
    steps: int = 0  # to advance by at most, of length ``Constants.dt``
    span: float = 0.0  # s, of a kick
    stride: int = 1  # increase of the number of the step per step
    most_damping: float = np.inf  # 1/s, friction damping / mass that such steps can follow


@entry
def perform(constants, state, active, book, team, thread, task):
    """Do the ``task`` as one ``thread`` of ``team``.

    EVALUATE: all forces at the present places of rails at rest in their frame. KICK: advance all
    velocities, but no place, by the present forces. OBSERVE: advance those
    of the bodies only, and fill ``State.sums``. OPEN: begin the
    ``book`` (``mechanics.books``) at ignition, with the velocities of half a step before. ADVANCE:
    take steps; call it in all threads of the team. It returns early, after whole steps of
    ``Constants.substeps``, if a pad comes near a rail at rest or friction damps a node faster than
    ``Task.most_damping``. Returns the number of steps, and the largest friction damping / mass
    (1/s) of a node before any of them.
    """
    if task.kind == ADVANCE:
        return _advance(constants, state, active, book, team, thread, task)
    if task.kind == EVALUATE:
        _evaluate(constants, state, active, team)
    elif task.kind == KICK or task.kind == OBSERVE:
        _kick(constants, state, task)
    else:
        begin(constants, state, book)
        begin_loads(constants, state)
    return 0, 0.0


@inlined
def _evaluate(constants, state, active, team):
    rail = constants.rail
    elastic_force(rail, state.displacement, state.resistance, state.turning, state.mounting, team)
    begin_damping(state.history, state)
    hold_blocks(rail, state, 0, 1)
    pose = pose_in_frame(state, constants.payload, constants.frame)
    reset_queue(team)
    contact_forces(constants, state, active, pose, team)
    collect(constants, state, active)
    begin_pushers(constants.pushers, constants.frame, state, pose)


@inlined
def _kick(constants, state, task):
    pose = pose_in_frame(state, constants.payload, constants.frame)
    unit = constants.dt / task.stride
    if task.kind == OBSERVE:
        find_fastest(constants.surface.walls, state, pose.velocity)
    thrust = thrust_load(constants, state, task.first_step * unit)
    _kick_bodies(constants, state, pose, thrust, task.span)
    hold(constants.hold_down, constants, state, pose, task.first_step * unit, task.span)
    acceleration = body_force_in_frame(constants.body_force, state, pose)
    if task.kind == OBSERVE:
        sum_nodes(constants, state, pose, acceleration)
    else:
        inverse_mass = constants.rail.inverse_mass
        kick_nodes(inverse_mass, state.velocity, state.resistance, acceleration, task.span)


@inlined
def collect(constants, state, active):
    """Sum ``state.reaction``, and add contact to the resistance."""
    state.reaction[:] = 0.0
    for part in range(state.turning.shape[0]):
        for i in range(3):
            state.reaction[i] += state.clamping[part, i]
            state.reaction[3 + i] += state.clamping[part, 3 + i] - state.turning[part, i]
    collect_mounts(constants.rail.mounts, state)
    collect_damping(state.history, state)
    if constants.interface_stiffness > 0.0:
        collect_contact(constants.rail, constants.surface, state, active)


@inlined
def _kick_bodies(constants, state, pose, thrust, dt):
    """Advance all velocities except those of the nodes over ``dt`` by the present forces; adds the
    external impulse."""
    load, total, moment = state.load[0], triple(state.reaction), triple(state.reaction[3:])
    n, f = load.normal_force, load.friction_force
    on_rail = (-n[0] - f[0], -n[1] - f[1], -n[2] - f[2])
    # Force and moment of the rails on the frame, in inertial axes.
    force = rotation.rotate(pose.frame, less(on_rail, total))
    couple = rotation.rotate(pose.frame, less(load.moment_on_rail, moment))
    add_external_impulse(constants.frame, constants, state, pose, thrust, (force, couple), dt)
    acceleration = body_force_in_frame(constants.body_force, state, pose)
    for i in range(3):
        state.rail_momentum[i] += dt * (total[i] + constants.drive.moving_mass * acceleration[i])
    _kick_payload(constants, state, pose, thrust, dt)
    _kick_platform(constants.frame, constants, state, pose, (force, couple), thrust, dt)
    kick_pushers(constants.pushers, constants, state, pose, dt)


@inlined
def _kick_payload(constants, state, pose, thrust, dt):
    load, body = state.load[0], state.payload
    contact = rotation.rotate(pose.frame, plus(load.normal_force, load.friction_force))
    moment = rotation.rotate(pose.frame, triple(load.moment))
    for i in range(3):
        body.velocity[i] += dt * (contact[i] + thrust[0][i]) / constants.payload.mass
        body.spin[i] += dt * (moment[i] + thrust[1][i])
    accelerate(constants.body_force, body, dt)


@inlined
def _kick_platform(frame, constants, state, pose, rails, thrust, dt):
    """``rails``: force (N) and moment about the frame's origin (N m) of the rails on the frame, in
    inertial axes."""
    if frame.free:
        body, (force, couple) = state.platform, rails
        offset = rotation.rotate(pose.frame, triple(frame.centre))
        couple = less(couple, rotation.cross(offset, force))
        back = (0.0, 0.0, 0.0)
        turn = (0.0, 0.0, 0.0)
        if constants.drive.reacts_on_platform:
            point, push = thrust[2], thrust[0]
            back = (-push[0], -push[1], -push[2])
            turn = rotation.cross(less(point, triple(body.position)), back)
        for i in range(3):
            body.velocity[i] += dt * (force[i] + back[i]) / frame.mass
            body.spin[i] += dt * (couple[i] + turn[i])
        accelerate(constants.body_force, body, dt)


@inlined
def drift_bodies(constants, state, pose):
    """Advance the places of the bodies over a step; fills ``state.motion`` for the nodes."""
    dt, acceleration = constants.dt, body_force_in_frame(constants.body_force, state, pose)
    for i in range(3):
        state.motion.acceleration[i] = acceleration[i]
    drift_body(state.payload, constants.payload.inverse_inertia, dt)
    for i in range(3):
        state.rail_moment[i] += dt * state.rail_momentum[i]
    _drift_frame(constants.frame, constants.drive, state, pose, dt)


@kernel
def _drift_frame(frame, drive, state, pose, dt):
    if frame.free:
        state.evaluated[PLATFORM] += 1
        motion = state.motion
        velocity = rotation.unrotate(pose.frame, triple(state.platform.velocity))
        rate = rotation.unrotate(pose.frame, drift_body(state.platform, frame.inverse_inertia, dt))
        turn = small_turn(rate, dt)
        for i in range(3):
            motion.velocity[i], motion.rate[i] = velocity[i], rate[i]
            state.rail_moment[i] -= dt * drive.moving_mass * velocity[i]
        for i in range(9):
            motion.turn[i] = turn[i]
        m, c, whole = drive.moving_mass, frame.centre, state.rail_moment
        moment, momentum = (
            rotation.rotate(turn, (whole[0] - m * c[0], whole[1] - m * c[1], whole[2] - m * c[2])),
            rotation.rotate(turn, triple(state.rail_momentum)),
        )
        for i in range(3):
            state.rail_moment[i] += moment[i]
            state.rail_momentum[i] += momentum[i]


@inlined
def _advance(constants, state, active, book, team, thread, task):
    """``book`` follows the payload off the rail. On entry and on return, forces are at the present
    places and work is complete up to the present time."""
    rail, frame, dt = constants.rail, constants.frame, constants.dt
    unit, damping, taken = dt / task.stride, 0.0, 0
    while taken < task.steps and not (
        taken % constants.substeps == 0 and _ends_early(state, active, task.most_damping)
    ):
        n = task.first_step + taken * task.stride
        if thread == 0:
            damping = max(damping, state.load[0].damping_rate)
            pose = pose_in_frame(state, constants.payload, frame)
            thrust = thrust_load(constants, state, n * unit)
            _kick_bodies(constants, state, pose, thrust, dt)
            hold(constants.hold_down, constants, state, pose, n * unit, dt)
            pose = pose_in_frame(state, constants.payload, frame)
            add_work(constants, state, active, pose, thrust, dt)
            drift_bodies(constants, state, pose)
            follow(constants, state, book, n * unit)
            reset_queue(team)
        barrier(team)
        move_and_load(rail, frame, state, team, thread, dt)
        pose = pose_in_frame(state, constants.payload, frame)
        contact_forces(constants, state, active, pose, team)
        finish_load(rail, state, team, thread, dt)
        barrier(team)
        if thread == 0:
            collect(constants, state, active)
            load_pushers(constants.pushers, frame, state, pose)
            thrust = thrust_load(constants, state, (n + task.stride) * unit)
            add_work(constants, state, active, pose, thrust, 0.0)
            follow_loads(constants, state, (n + task.stride) * unit)
        taken += 1
    return taken, damping


@kernel
def _ends_early(state, active, most_damping):
    """Whether a pad is near a rail at rest, or friction damps a node too fast. All threads get the
    same answer: both values change only between the two barriers of a step."""
    for group in range(active.near.size):
        if active.near[group] or state.loads[group].damping_rate > most_damping:
            return True
    return False
