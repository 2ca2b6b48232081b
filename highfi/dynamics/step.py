"""The time loop: explicit central differences (leapfrog) for rail nodes, payload and platform
together.

At time n places and forces are known and velocities stand at n - 1/2. One step is: kick ``v += dt
f/m``, drift (``pose``), forces::

    rail node   w += dt f / m                    f = -K u - damping + contact
    payload     v += dt F / m,  h += dt M
    platform    P += dt (F_c - sum f),  spin += dt (T_c - sum (X + u) x f)      sums over the moving nodes

The platform's share is the elastic force at the clamps in its variational form: the force and
moment that the strain energy u'Ku/2 exerts on the frame when the nodes stay where they are in
space. With it linear *and* angular momentum are exact; the sum of clamp forces alone would lose sum
u x f. F_c and T_c are contact on all rail nodes, clamped or not. As K u has no resultant and no
moment about the undeformed places, both sums need the dense nodal arrays for u x K u only. The same
holds for the part of structural damping (``damping``) that is proportional to K; the part
proportional to mass is summed node by node.

Nodes are moved and loaded, and contact is searched, by all threads of the team; the first one moves
the bodies before.
"""

from tipoff.highfi.contact.pads import collect_contact, contact_forces
from tipoff.highfi.dynamics.damping import begin_damping, collect_damping
from tipoff.highfi.dynamics.elastic import elastic_force, finish_load, hold_blocks, move_and_load
from tipoff.highfi.dynamics.ending import follow
from tipoff.highfi.dynamics.loads import add_external_impulse, add_work, pull_on_nodes, thrust_load
from tipoff.highfi.state.pose import drift_body, seen_from_frame, small_turn, triple
from tipoff.highfi.state.records import (
    DAMPING_RATIO,
    FRAME_VELOCITY,
    FRICTION_FORCE,
    MOMENT,
    MOMENT_ON_RAIL,
    NORMAL_FORCE,
    PULL,
    RATE,
    TURN,
)
from tipoff.highfi.state.threads import deal, meet
from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel


@kernel
def evaluate(rail, surface, faces, payload, frame, penalty, friction, state, active, team, dt):
    """All forces at the present places of rails at rest in their frame, by one thread."""
    elastic_force(rail, state.displacement, state.resistance, state.turning, team)
    begin_damping(state.history, state)
    hold_blocks(rail, state, 0, 1)
    pose = seen_from_frame(state, payload, frame)
    deal(team)
    contact_forces(rail, surface, faces, frame, penalty, friction, state, active, pose, team, dt)
    collect(surface, penalty, rail, state, active)


@kernel
def collect(surface, penalty, rail, state, active):
    """Sum up: ``state.reaction``, and contact into the resistance."""
    state.reaction[:] = 0.0
    for part in range(state.turning.shape[0]):
        for i in range(3):
            state.reaction[i] += state.clamping[part, i]
            state.reaction[3 + i] += state.clamping[part, 3 + i] - state.turning[part, i]
    collect_damping(state.history, state)
    if penalty is not None:
        collect_contact(rail, surface, state, active)


@kernel
def _less(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def kick_bodies(payload, frame, drive, gravity, state, pose, thrust, dt):
    """Advance all velocities but those of the nodes over ``dt`` by the present forces; counts the
    external impulse."""
    load, total, moment = state.load, state.reaction[:3], state.reaction[3:]
    on_rail = (
        -load[NORMAL_FORCE] - load[FRICTION_FORCE],
        -load[NORMAL_FORCE + 1] - load[FRICTION_FORCE + 1],
        -load[NORMAL_FORCE + 2] - load[FRICTION_FORCE + 2],
    )
    # What the rails pass on to the frame, in inertial axes.
    force = rotation.rotate(
        pose.frame, (on_rail[0] - total[0], on_rail[1] - total[1], on_rail[2] - total[2])
    )
    couple = rotation.rotate(
        pose.frame,
        (
            load[MOMENT_ON_RAIL] - moment[0],
            load[MOMENT_ON_RAIL + 1] - moment[1],
            load[MOMENT_ON_RAIL + 2] - moment[2],
        ),
    )
    add_external_impulse(payload, frame, drive, gravity, state, pose, thrust, (force, couple), dt)
    pull = pull_on_nodes(gravity, pose)
    for i in range(3):
        state.rail_momentum[i] += dt * (total[i] + drive.moving_mass * pull[i])
    _kick_payload(payload, gravity, state, pose, thrust, dt)
    _kick_platform(frame, drive, gravity, state, force, couple, thrust, dt)


@kernel
def _kick_payload(payload, gravity, state, pose, thrust, dt):
    load, body = state.load, state.payload
    contact = rotation.rotate(
        pose.frame,
        (
            load[NORMAL_FORCE] + load[FRICTION_FORCE],
            load[NORMAL_FORCE + 1] + load[FRICTION_FORCE + 1],
            load[NORMAL_FORCE + 2] + load[FRICTION_FORCE + 2],
        ),
    )
    moment = rotation.rotate(pose.frame, (load[MOMENT], load[MOMENT + 1], load[MOMENT + 2]))
    for i in range(3):
        body.velocity[i] += dt * (contact[i] + thrust[0][i]) / payload.mass
        body.spin[i] += dt * (moment[i] + thrust[1][i])
    _fall(gravity, body, dt)


@kernel
def _kick_platform(frame, drive, gravity, state, force, couple, thrust, dt):
    if frame is not None:
        body = state.platform
        back = (0.0, 0.0, 0.0)
        turn = (0.0, 0.0, 0.0)
        if drive.reacts_on_platform:
            point, push = thrust[2], thrust[0]
            back = (-push[0], -push[1], -push[2])
            turn = rotation.cross(_less(point, triple(body.position)), back)
        for i in range(3):
            body.velocity[i] += dt * (force[i] + back[i]) / frame.mass
            body.spin[i] += dt * (couple[i] + turn[i])
        _fall(gravity, body, dt)


@kernel
def _fall(gravity, body, dt):
    if gravity is not None:
        body.velocity[0] += dt * gravity.x
        body.velocity[1] += dt * gravity.y
        body.velocity[2] += dt * gravity.z


@kernel
def drift_bodies(payload, frame, drive, gravity, state, pose, dt):
    """Advance the places of the bodies over ``dt``; fills ``state.motion`` for the nodes."""
    pull = pull_on_nodes(gravity, pose)
    for i in range(3):
        state.motion[PULL + i] = pull[i]
    drift_body(state.payload, payload.inverse_inertia, dt)
    for i in range(3):
        state.rail_moment[i] += dt * state.rail_momentum[i]
    _drift_frame(drive, frame, state, pose, dt)


@kernel
def _drift_frame(drive, frame, state, pose, dt):
    if frame is not None:
        velocity = rotation.unrotate(pose.frame, triple(state.platform.velocity))
        rate = rotation.unrotate(pose.frame, drift_body(state.platform, frame.inverse_inertia, dt))
        turn = small_turn(rate, dt)
        for i in range(3):
            state.motion[FRAME_VELOCITY + i], state.motion[RATE + i] = velocity[i], rate[i]
            state.rail_moment[i] -= dt * drive.moving_mass * velocity[i]
        for i in range(9):
            state.motion[TURN + i] = turn[i]
        moment, momentum = (
            rotation.rotate(turn, triple(state.rail_moment)),
            rotation.rotate(turn, triple(state.rail_momentum)),
        )
        for i in range(3):
            state.rail_moment[i] += moment[i]
            state.rail_momentum[i] += momentum[i]


@kernel
def advance(
    rail,
    surface,
    faces,
    payload,
    frame,
    drive,
    pulses,
    curve,
    offset,
    penalty,
    friction,
    gravity,
    state,
    active,
    exit_,
    marks,
    ending,
    team,
    thread,
    first_step,
    steps,
    dt,
):
    """Take ``steps`` steps from step number ``first_step``, as one ``thread`` of ``team``; all its
    threads must be called.

    Returns the largest step * friction damping / mass met; the book of ``ending`` is told of each
    step. On entry and on return forces are those of the present places and work is counted up to
    the present time.
    """
    damping = 0.0
    for n in range(first_step, first_step + steps):
        if thread == 0:
            pose = seen_from_frame(state, payload, frame)
            thrust = thrust_load(state, drive, pulses, curve, offset, n * dt)
            kick_bodies(payload, frame, drive, gravity, state, pose, thrust, dt)
            pose = seen_from_frame(state, payload, frame)
            add_work(
                rail,
                surface,
                payload,
                frame,
                drive,
                friction,
                gravity,
                state,
                active,
                pose,
                thrust,
                0.5 * dt,
                dt,
            )
            drift_bodies(payload, frame, drive, gravity, state, pose, dt)
            follow(exit_, payload, frame, state, marks, ending.book, n * dt, dt)
            deal(team)
        meet(team)
        move_and_load(rail, frame, state, team, thread, dt)
        pose = seen_from_frame(state, payload, frame)
        contact_forces(
            rail, surface, faces, frame, penalty, friction, state, active, pose, team, dt
        )
        finish_load(rail, state, team, thread, dt)
        meet(team)
        if thread == 0:
            collect(surface, penalty, rail, state, active)
            thrust = thrust_load(state, drive, pulses, curve, offset, (n + 1) * dt)
            add_work(
                rail,
                surface,
                payload,
                frame,
                drive,
                friction,
                gravity,
                state,
                active,
                pose,
                thrust,
                0.5 * dt,
                0.0,
            )
            damping = max(damping, state.load[DAMPING_RATIO])
    return damping
