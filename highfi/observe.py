"""One sample of a run: places, velocities, energies and momenta *at* time n, from velocities at n - 1/2 and n + 1/2.

    v(n) = (v(n-1/2) + v(n+1/2)) / 2,     kinetic energy = v(n-1/2) M v(n+1/2) / 2

The second form makes kinetic plus strain energy an exact invariant of central differences for a linear system.
"""

import numpy as np

from highfi.elastic import elastic_force
from highfi.pose import body_matrix, triple
from highfi.records import STORED
from highfi.step import kick
from scenes import rotation
from scenes.jit import njit

# Slots of the sample vector.
POSITION, VELOCITY, QUATERNION, RATE = 0, 3, 6, 10
PLATFORM_POSITION, PLATFORM_VELOCITY, PLATFORM_QUATERNION, PLATFORM_RATE = 13, 16, 19, 23
KINETIC, AXIAL_KINETIC, STRAIN, CONTACT, LINEAR, ANGULAR, IMPULSE = 26, 27, 28, 29, 30, 33, 36
SAMPLE_SIZE = 42


@njit
def observe(rail, payload, frame, drive, gravity, state, pose, thrust, dt, sample):
    """Fill ``sample`` (SAMPLE_SIZE,). The state is left as it was."""
    before = _velocities(state)
    rail_before = state.velocity.copy()
    kick(rail, payload, frame, drive, gravity, state, pose, thrust, dt)
    after = _velocities(state)
    _places(state, sample)
    _energies(rail, payload, frame, state, pose, before, after, rail_before, sample)
    _momenta(rail, payload, frame, state, pose, before, after, rail_before, sample)
    _rates(payload, frame, state, before, after, sample)
    state.velocity[:] = rail_before
    _restore(state, before)


@njit
def _velocities(state):
    """Everything a kick changes except nodal velocities, in one vector (24,)."""
    values = np.empty(21)
    values[0:3] = state.payload.velocity
    values[3:6] = state.payload.spin
    values[6:9] = state.platform.velocity
    values[9:12] = state.platform.spin
    values[12:15] = state.rail_momentum
    values[15:21] = state.impulse
    return values


@njit
def _restore(state, values):
    state.payload.velocity[:] = values[0:3]
    state.payload.spin[:] = values[3:6]
    state.platform.velocity[:] = values[6:9]
    state.platform.spin[:] = values[9:12]
    state.rail_momentum[:] = values[12:15]
    state.impulse[:] = values[15:21]


@njit
def _places(state, sample):
    sample[POSITION:POSITION + 3] = state.payload.position
    sample[QUATERNION:QUATERNION + 4] = state.payload.quaternion
    sample[PLATFORM_POSITION:PLATFORM_POSITION + 3] = state.platform.position
    sample[PLATFORM_QUATERNION:PLATFORM_QUATERNION + 4] = state.platform.quaternion


@njit
def _rates(payload, frame, state, before, after, sample):
    middle = 0.5 * (before + after)
    sample[VELOCITY:VELOCITY + 3] = middle[0:3]
    sample[IMPULSE:IMPULSE + 6] = middle[15:21]
    sample[RATE:RATE + 3] = payload.inverse_inertia @ np.array(rotation.unrotate(body_matrix(state.payload), triple(middle[3:6])))
    sample[PLATFORM_VELOCITY:PLATFORM_VELOCITY + 3] = middle[6:9]
    if frame is not None:
        spin = np.array(rotation.unrotate(body_matrix(state.platform), triple(middle[9:12])))
        sample[PLATFORM_RATE:PLATFORM_RATE + 3] = frame.inverse_inertia @ spin


@njit
def _energies(rail, payload, frame, state, pose, before, after, rail_before, sample):
    kinetic = 0.5 * payload.mass * (before[0:3] * after[0:3]).sum() + _spin_energy(
        body_matrix(state.payload), payload.inverse_inertia, triple(before[3:6]), triple(after[3:6]))
    axial = 0.5 * payload.mass * before[0] * after[0]
    strain = np.zeros_like(state.resistance)
    elastic_force(rail, state.displacement, strain)
    stored = 0.0
    for node in range(rail.mass.size):
        moving = rail.inverse_mass[node] > 0.0
        for i in range(3):
            stored += 0.5 * state.displacement[node, i] * strain[node, i]
            if moving:
                kinetic += 0.5 * rail.mass[node] * rail_before[node, i] * state.velocity[node, i]
    if frame is not None:
        kinetic += 0.5 * frame.mass * (before[6:9] * after[6:9]).sum() + _spin_energy(
            pose.frame, frame.inverse_inertia, triple(before[9:12]), triple(after[9:12]))
        axial += 0.5 / frame.total_mass * _axial(frame, pose, before) * _axial(frame, pose, after)
    sample[KINETIC], sample[AXIAL_KINETIC], sample[STRAIN], sample[CONTACT] = kinetic, axial, stored, state.load[STORED]


@njit
def _axial(frame, pose, values):
    """X momentum of platform and rails (N s)."""
    return frame.mass * values[6] + rotation.rotate(pose.frame, triple(values[12:15]))[0]


@njit
def _spin_energy(turn, inverse_inertia, before, after):
    return 0.5 * rotation.dot(before, rotation.angular_velocity(turn, inverse_inertia, after))


@njit
def _momenta(rail, payload, frame, state, pose, before, after, rail_before, sample):
    """Linear and angular momentum (about the scene origin) summed anew over every node and body."""
    linear = np.zeros(3)
    angular = np.zeros(3)
    for node in range(rail.mass.size):
        if rail.inverse_mass[node] > 0.0:
            half = 0.5 * rail.mass[node]
            p = (half * (rail_before[node, 0] + state.velocity[node, 0]),
                 half * (rail_before[node, 1] + state.velocity[node, 1]),
                 half * (rail_before[node, 2] + state.velocity[node, 2]))
            place = (rail.points[node, 0] + state.displacement[node, 0], rail.points[node, 1] + state.displacement[node, 1],
                     rail.points[node, 2] + state.displacement[node, 2])
            turn = rotation.cross(place, p)
            for i in range(3):
                linear[i] += p[i]
                angular[i] += turn[i]
    origin = triple(state.platform.position)
    carried = rotation.rotate(pose.frame, triple(linear))
    turned = rotation.rotate(pose.frame, triple(angular))
    orbit = rotation.cross(origin, carried)
    middle = 0.5 * (before + after)
    sample[LINEAR:LINEAR + 3] = np.array(carried) + payload.mass * middle[0:3]
    own = rotation.cross(triple(state.payload.position), triple(payload.mass * middle[0:3]))
    sample[ANGULAR:ANGULAR + 3] = np.array(turned) + np.array(orbit) + np.array(own) + middle[3:6]
    if frame is not None:
        sample[LINEAR:LINEAR + 3] += frame.mass * middle[6:9]
        sample[ANGULAR:ANGULAR + 3] += np.array(rotation.cross(origin, triple(frame.mass * middle[6:9]))) + middle[9:12]
