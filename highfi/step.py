"""The time loop: explicit central differences (leapfrog) for rail nodes, payload and platform together.

At time n places and forces are known and velocities stand at n - 1/2. One step is: kick ``v += dt f/m``, drift (``pose``), forces::

    rail node   w += dt f / m                    f = -K u + contact
    payload     v += dt F / m,  h += dt M
    platform    P += dt (F_c - sum f),  spin += dt (T_c - sum (X + u) x f)      sums over the moving nodes

The platform's share is the elastic force at the clamps in its variational form: the force and moment that the strain energy
u'Ku/2 exerts on the frame when the nodes stay where they are in space. With it linear *and* angular momentum are exact; the sum of
clamp forces alone would lose sum u x f. F_c and T_c are contact on all rail nodes, clamped or not.
"""

from highfi.contact import contact_forces
from highfi.elastic import elastic_force
from highfi.loads import add_external_impulse, add_work, thrust_load
from highfi.nodes import drift_nodes, drift_nodes_in_frame, hold_clamped, kick_nodes, weigh_nodes
from highfi.pose import drift_body, seen_from_frame, small_turn, triple
from highfi.records import DAMPING_RATIO, FRICTION_FORCE, MOMENT, MOMENT_ON_RAIL, NORMAL_FORCE
from scenes import rotation
from scenes.jit import njit


@njit
def evaluate(rail, surface, faces, payload, frame, penalty, friction, state, active, dt):
    """Forces at the present places; returns the pose of the payload."""
    pose = seen_from_frame(state, payload, frame)
    elastic_force(rail, state.displacement, state.resistance)
    contact_forces(rail, surface, faces, penalty, friction, state, active, pose, dt)
    for node in rail.clamped:
        state.resistance[node, 0] = 0.0
        state.resistance[node, 1] = 0.0
        state.resistance[node, 2] = 0.0
    return pose


@njit
def kick(rail, payload, frame, drive, gravity, state, pose, thrust, dt):
    """Advance all velocities over ``dt`` by the present forces; counts the external impulse of the step."""
    total, moment = kick_nodes(rail.points, rail.inverse_mass, state.displacement, state.velocity, state.resistance, dt)
    for i in range(3):
        state.rail_momentum[i] += dt * total[i]
    rail_mass, centre = weigh_nodes(rail, gravity, state, pose, dt)
    load = state.load
    on_rail = (-load[NORMAL_FORCE] - load[FRICTION_FORCE], -load[NORMAL_FORCE + 1] - load[FRICTION_FORCE + 1],
               -load[NORMAL_FORCE + 2] - load[FRICTION_FORCE + 2])
    # What the rails pass on to the frame, in inertial axes.
    force = rotation.rotate(pose.frame, (on_rail[0] - total[0], on_rail[1] - total[1], on_rail[2] - total[2]))
    couple = rotation.rotate(pose.frame, (load[MOMENT_ON_RAIL] - moment[0], load[MOMENT_ON_RAIL + 1] - moment[1],
                                          load[MOMENT_ON_RAIL + 2] - moment[2]))
    add_external_impulse(payload, frame, drive, gravity, state, thrust, rail_mass, centre, (force, couple), dt)
    _kick_payload(payload, gravity, state, pose, thrust, dt)
    _kick_platform(frame, drive, gravity, state, force, couple, thrust, dt)


@njit
def _kick_payload(payload, gravity, state, pose, thrust, dt):
    load, body = state.load, state.payload
    contact = rotation.rotate(pose.frame, (load[NORMAL_FORCE] + load[FRICTION_FORCE],
                                           load[NORMAL_FORCE + 1] + load[FRICTION_FORCE + 1],
                                           load[NORMAL_FORCE + 2] + load[FRICTION_FORCE + 2]))
    moment = rotation.rotate(pose.frame, (load[MOMENT], load[MOMENT + 1], load[MOMENT + 2]))
    for i in range(3):
        body.velocity[i] += dt * (contact[i] + thrust[0][i]) / payload.mass
        body.spin[i] += dt * (moment[i] + thrust[1][i])
    if gravity is not None:
        body.velocity[0] += dt * gravity.x
        body.velocity[1] += dt * gravity.y
        body.velocity[2] += dt * gravity.z


@njit
def _kick_platform(frame, drive, gravity, state, force, couple, thrust, dt):
    if frame is not None:
        body = state.platform
        back = (0.0, 0.0, 0.0)
        turn = (0.0, 0.0, 0.0)
        if drive.reacts_on_platform:
            point, push = thrust[2], thrust[0]
            back = (-push[0], -push[1], -push[2])
            p = body.position
            turn = rotation.cross((point[0] - p[0], point[1] - p[1], point[2] - p[2]), back)
        for i in range(3):
            body.velocity[i] += dt * (force[i] + back[i]) / frame.mass
            body.spin[i] += dt * (couple[i] + turn[i])
        if gravity is not None:
            body.velocity[0] += dt * gravity.x
            body.velocity[1] += dt * gravity.y
            body.velocity[2] += dt * gravity.z


@njit
def drift(rail, payload, frame, state, pose, dt):
    """Advance all places over ``dt`` at the present velocities."""
    drift_body(state.payload, payload.inverse_inertia, dt)
    if frame is None:
        drift_nodes(state.displacement, state.velocity, dt)
    if frame is not None:
        _drift_with_frame(rail, frame, state, pose, dt)


@njit
def _drift_with_frame(rail, frame, state, pose, dt):
    velocity = rotation.unrotate(pose.frame, triple(state.platform.velocity))
    rate = rotation.unrotate(pose.frame, drift_body(state.platform, frame.inverse_inertia, dt))
    turn = small_turn(rate, dt)
    drift_nodes_in_frame(rail.points, state.displacement, state.velocity, velocity, turn, dt)
    hold_clamped(rail, state, velocity, rate)
    momentum = triple(state.rail_momentum)
    change = rotation.rotate(turn, momentum)
    for i in range(3):
        state.rail_momentum[i] = momentum[i] + change[i]


@njit
def advance(rail, surface, faces, payload, frame, drive, pulses, curve, offset, penalty, friction, gravity, state, active,
            first_step, steps, dt):
    """Take ``steps`` steps from step number ``first_step``. Returns the largest step * friction damping / mass met.

    On entry and on return forces are those of the present places and work is counted up to the present time.
    """
    pose = seen_from_frame(state, payload, frame)
    thrust = thrust_load(state, drive, pulses, curve, offset, first_step * dt)
    damping = 0.0
    for n in range(first_step, first_step + steps):
        kick(rail, payload, frame, drive, gravity, state, pose, thrust, dt)
        pose = seen_from_frame(state, payload, frame)
        add_work(rail, surface, payload, frame, drive, friction, gravity, state, active, pose, thrust, 0.5 * dt)
        drift(rail, payload, frame, state, pose, dt)
        pose = evaluate(rail, surface, faces, payload, frame, penalty, friction, state, active, dt)
        thrust = thrust_load(state, drive, pulses, curve, offset, (n + 1) * dt)
        add_work(rail, surface, payload, frame, drive, friction, gravity, state, active, pose, thrust, 0.5 * dt)
        damping = max(damping, state.load[DAMPING_RATIO])
    return damping
