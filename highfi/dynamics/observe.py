"""Samples of a run: positions, velocities, energies and momenta *at* time n, from velocities at n -
1/2 and n + 1/2.

    v(n) = (v(n-1/2) + v(n+1/2)) / 2,     kinetic energy = v(n-1/2) M v(n+1/2) / 2

The second form makes kinetic plus strain energy an exact invariant of central differences for a
linear system. A kernel makes the sums over nodes, block by block, so that they lose few digits. The
strain energy u'K u / 2 comes from the present resistance less damping and contact. The bodies are
plain NumPy: their kernel would not repay its compilation, as a sample is taken once in a hundred
steps.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.elastic import elastic_force
from tipoff.highfi.state import records
from tipoff.highfi.state.nodes import kicked
from tipoff.highfi.state.pose import origin_of_frame, triple
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.kernels.memory import zeros

# Slots of the sample vector.
POSITION, VELOCITY, QUATERNION, RATE = 0, 3, 6, 10
PLATFORM_POSITION, PLATFORM_VELOCITY, PLATFORM_QUATERNION, PLATFORM_RATE = 13, 16, 19, 23
KINETIC, AXIAL_KINETIC, STRAIN, CONTACT, LINEAR, ANGULAR, IMPULSE = 26, 27, 28, 29, 30, 33, 36
# Sums of the magnitudes of the momenta of all bodies and nodes, as ``momenta.Sizes``.
SIZES = 42
SAMPLE_SIZE = 45

# Slots of ``State.sums``, over the stepped nodes: of m v(n-1/2) v(n+1/2), of u r (J) less damping, of the
# momenta in frame axes (about the scene origin), and of their magnitudes.
_KINETIC, _STRAIN, _LINEAR, _ANGULAR, _SIZES = 0, 1, 2, 5, 8
FASTEST = 11  # m/s across the rail, of a wall node from the payload half a step before
SUMS_SIZE = 12


class Moving(NamedTuple):
    """Copy of the values of bodies that a kick changes."""

    velocity: np.ndarray  # (3,) m/s, of the payload
    spin: np.ndarray  # (3,) kg m2/s, of the payload
    platform_velocity: np.ndarray  # (3,) m/s
    platform_spin: np.ndarray  # (3,) kg m2/s
    rail_momentum: np.ndarray  # (3,) kg m/s
    impulse: np.ndarray  # (6,) N s, N m s
    pushers: np.ndarray  # (4,n) values of n pushers with mass


def moving(state: records.State) -> Moving:
    """Copy of the values of bodies that a kick changes."""
    return Moving(*(part.copy() for part in _changed(state)))


def restore(state: records.State, saved: Moving) -> None:
    """Restore the values that ``moving`` copied."""
    for part, value in zip(_changed(state), saved):
        part[:] = value


def _changed(state):
    return (
        state.payload.velocity,
        state.payload.spin,
        state.platform.velocity,
        state.platform.spin,
        state.rail_momentum,
        state.impulse,
        state.pushing.inertia.values,
    )


def sample(system, state: records.State, before: Moving, after: Moving) -> np.ndarray:
    """Sample vector (SAMPLE_SIZE,) of the present places and the velocities half a step before and
    after them; ``state.sums`` are those of the nodes."""
    row = np.zeros(SAMPLE_SIZE)
    middle = Moving(*(0.5 * (a + b) for a, b in zip(before, after)))
    turn, base = (rotation.single(body.quaternion) for body in (state.payload, state.platform))
    row[POSITION : POSITION + 3], row[QUATERNION : QUATERNION + 4] = (
        state.payload.position,
        state.payload.quaternion,
    )
    row[PLATFORM_POSITION : PLATFORM_POSITION + 3] = state.platform.position
    row[PLATFORM_QUATERNION : PLATFORM_QUATERNION + 4] = state.platform.quaternion
    row[VELOCITY : VELOCITY + 3], row[PLATFORM_VELOCITY : PLATFORM_VELOCITY + 3] = (
        middle.velocity,
        middle.platform_velocity,
    )
    row[RATE : RATE + 3] = system.model.payload.inverse_inertia @ (turn.T @ middle.spin)
    if system.frame is not None:
        rate = system.frame.inverse_inertia @ (base.T @ middle.platform_spin)
        row[PLATFORM_RATE : PLATFORM_RATE + 3] = rate
        row[PLATFORM_POSITION : PLATFORM_POSITION + 3] -= base @ system.frame.centre
        row[PLATFORM_VELOCITY : PLATFORM_VELOCITY + 3] -= base @ _cross(rate, system.frame.centre)
    row[IMPULSE : IMPULSE + 6] = middle.impulse
    row[KINETIC], row[AXIAL_KINETIC] = _kinetic_energy(system, state, before, after)
    load = state.load[0]
    row[STRAIN] = 0.5 * (state.sums[_STRAIN] - load["on_walls"])
    row[CONTACT] = load["stored"]
    row[LINEAR : LINEAR + 3], row[ANGULAR : ANGULAR + 3], row[SIZES:] = _momenta(
        system, state, base, middle
    )
    return row


def strain(system, state: records.State, team) -> float:
    """Strain energy (J) of the rails."""
    part = system.nodes
    if part.start == part.stop:
        return 0.0
    force = zeros(state.displacement.shape, order="F")
    turn, mounting = np.empty_like(state.turning), np.empty_like(state.mounting)
    elastic_force(system.rail, state.displacement, force, turn, mounting, team)
    # Not a BLAS product: with several runs on one machine, its threads would wait for each
    # other.
    return 0.5 * float((state.displacement * force).sum())


def _kinetic_energy(
    system, state: records.State, before: Moving, after: Moving
) -> tuple[float, float]:
    """Kinetic energy (J) of everything, and its axial part, from the velocities half a step before
    and after the present places."""
    payload, frame = system.model.payload, system.frame
    turn, base = (rotation.single(body.quaternion) for body in (state.payload, state.platform))
    kinetic = 0.5 * (payload.mass * before.velocity @ after.velocity + state.sums[_KINETIC])
    kinetic += _spin_energy(turn, payload.inverse_inertia, before.spin, after.spin)
    axial = 0.5 * payload.mass * before.velocity[0] * after.velocity[0]
    if frame is not None:
        kinetic += 0.5 * frame.mass * before.platform_velocity @ after.platform_velocity
        kinetic += _spin_energy(
            base, frame.inverse_inertia, before.platform_spin, after.platform_spin
        )
        first, second = (
            frame.mass * part.platform_velocity[0] + (base @ part.rail_momentum)[0]
            for part in (before, after)
        )
        axial += 0.5 * first * second / frame.total_mass
    return float(kinetic), float(axial)


def _spin_energy(turn, inverse_inertia, before, after) -> float:
    return 0.5 * float((turn.T @ before) @ inverse_inertia @ (turn.T @ after))


def _momenta(system, state, base, middle: Moving) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Linear and angular momentum (about the scene origin), summed anew over every node and body, and
    the sums (3,) of the magnitudes of all of them."""
    own = system.model.payload.mass * middle.velocity
    bodies = [(state.payload.position, own, middle.spin)]
    sums = state.sums
    linear = own + base @ sums[_LINEAR : _LINEAR + 3]
    angular = base @ sums[_ANGULAR : _ANGULAR + 3] + _cross(state.payload.position, own)
    angular = angular + middle.spin
    if system.frame is not None:
        carried = system.frame.mass * middle.platform_velocity
        bodies.append((state.platform.position, carried, middle.platform_spin))
        linear = linear + carried
        angular = angular + _cross(state.platform.position, carried) + middle.platform_spin
    sizes = [sums[_SIZES : _SIZES + 3], *(_sizes_of_body(*body) for body in bodies)]
    return linear, angular, np.sum(sizes, axis=0)


def _sizes_of_body(place, momentum, spin) -> tuple[float, float, float]:
    own, turning = math.hypot(*momentum), math.hypot(*spin)
    orbit = math.hypot(*_cross(place, momentum))
    return own, orbit + turning, math.hypot(*place) * own + turning


def _cross(a, b) -> np.ndarray:
    """Vector product of two triples; numpy's function takes far longer, to identify the axis."""
    (x, y, z), (p, q, r) = a.tolist(), b.tolist()
    return np.array([y * r - z * q, z * p - x * r, x * q - y * p])


@inlined
def sum_nodes(constants, state, pose, acceleration):
    """Fill ``state.sums`` but ``FASTEST``; ``acceleration`` (m/s2) of the nodes by the body force, in
    frame axes."""
    rail, sums, dt = constants.rail, state.sums, constants.dt
    damps = state.history.loss.size > 0
    origin = origin_of_frame(constants.frame, state.platform, pose.frame)
    ox, oy, oz = rotation.unrotate(pose.frame, origin)
    sums[:FASTEST] = 0.0
    ax, ay, az = acceleration
    for k in range(state.stepped.in_use[0]):
        block = state.stepped.block[k]
        kinetic, strain, own, orbits, reached = 0.0, 0.0, 0.0, 0.0, 0.0
        px, py, pz, hx, hy, hz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for node in range(np.uint64(rail.blocks[block]), np.uint64(rail.blocks[block + 1])):
            inverse = rail.inverse_mass[node]
            if inverse > 0.0:
                m, u, r = (
                    rail.mass[node],
                    triple(state.displacement[node]),
                    triple(state.resistance[node]),
                )
                v, x = triple(state.velocity[node]), triple(rail.points[node])
                wx = kicked(v[0], r[0], inverse, ax, dt)
                wy = kicked(v[1], r[1], inverse, ay, dt)
                wz = kicked(v[2], r[2], inverse, az, dt)
                kinetic += m * (v[0] * wx + v[1] * wy + v[2] * wz)
                strain += rotation.dot(u, r)
                if damps:
                    strain -= rotation.dot(u, triple(state.history.force[node]))
                p = 0.5 * m * (v[0] + wx), 0.5 * m * (v[1] + wy), 0.5 * m * (v[2] + wz)
                far = ox + x[0] + u[0], oy + x[1] + u[1], oz + x[2] + u[2]
                h, size = rotation.cross(far, p), np.sqrt(rotation.dot(p, p))
                px, py, pz, hx, hy, hz = (
                    px + p[0],
                    py + p[1],
                    pz + p[2],
                    hx + h[0],
                    hy + h[1],
                    hz + h[2],
                )
                own += size
                orbits += np.sqrt(rotation.dot(h, h))
                reached += np.sqrt(rotation.dot(far, far)) * size
        sums[_KINETIC] += kinetic
        sums[_STRAIN] += strain
        sums[_LINEAR] += px
        sums[_LINEAR + 1] += py
        sums[_LINEAR + 2] += pz
        sums[_ANGULAR] += hx
        sums[_ANGULAR + 1] += hy
        sums[_ANGULAR + 2] += hz
        sums[_SIZES] += own
        sums[_SIZES + 1] += orbits
        sums[_SIZES + 2] += reached


@kernel
def find_fastest(walls, state, velocity):
    """Set ``FASTEST``; ``velocity`` (m/s) of the payload in frame axes."""
    largest = 0.0
    for k in range(walls.size):
        node = walls[k]
        y, z = state.velocity[node, 1] - velocity[1], state.velocity[node, 2] - velocity[2]
        largest = max(largest, y * y + z * z)
    state.sums[FASTEST] = np.sqrt(largest)
