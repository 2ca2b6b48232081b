"""Samples of a run: positions, velocities, energies and momenta *at* time n, from velocities at n -
1/2 and n + 1/2.

    v(n) = (v(n-1/2) + v(n+1/2)) / 2,     kinetic energy = v(n-1/2) M v(n+1/2) / 2

The second form makes kinetic plus strain energy an exact invariant of central differences for a
linear system. Plain NumPy: a kernel would not repay its compilation, as a sample is taken once in a
hundred steps.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.elastic import elastic_force
from tipoff.highfi.state import records
from tipoff.kernels import rotation
from tipoff.kernels.memory import zeros

# Slots of the sample vector.
POSITION, VELOCITY, QUATERNION, RATE = 0, 3, 6, 10
PLATFORM_POSITION, PLATFORM_VELOCITY, PLATFORM_QUATERNION, PLATFORM_RATE = 13, 16, 19, 23
KINETIC, AXIAL_KINETIC, STRAIN, CONTACT, LINEAR, ANGULAR, IMPULSE = 26, 27, 28, 29, 30, 33, 36
# Sums of the magnitudes of the momenta of all bodies and nodes, as ``momenta.Sizes``.
SIZES = 42
SAMPLE_SIZE = 45


class Moving(NamedTuple):
    """Copy of all values that a kick changes."""

    velocity: np.ndarray  # (3,) m/s, of the payload
    spin: np.ndarray  # (3,) kg m2/s, of the payload
    platform_velocity: np.ndarray  # (3,) m/s
    platform_spin: np.ndarray  # (3,) kg m2/s
    nodes: np.ndarray  # (p,3) m/s, those of ``System.nodes``
    rail_momentum: np.ndarray  # (3,) kg m/s
    impulse: np.ndarray  # (6,) N s, N m s
    pushers: np.ndarray  # (4,n) values of n pushers with mass


def moving(system, state: records.State) -> Moving:
    """Copy of the values that a kick changes; of the nodes only ``system.nodes``."""
    return Moving(*(part.copy(order="K") for part in _changed(system, state)))


def restore(system, state: records.State, saved: Moving) -> None:
    """Restore the values that ``moving`` copied."""
    for part, value in zip(_changed(system, state), saved):
        part[:] = value


def _changed(system, state):
    return (
        state.payload.velocity,
        state.payload.spin,
        state.platform.velocity,
        state.platform.spin,
        state.velocity[system.nodes],
        state.rail_momentum,
        state.impulse,
        state.pushing.inertia.values,
    )


def sample(system, team, state: records.State, before: Moving, after: Moving) -> np.ndarray:
    """Sample vector (SAMPLE_SIZE,) of the present places and the velocities half a step before and
    after them."""
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
    row[KINETIC], row[AXIAL_KINETIC] = kinetic_energy(system, state, before, after)
    row[STRAIN], row[CONTACT] = strain(system, state, team), float(state.load[0]["stored"])
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


def kinetic_energy(
    system, state: records.State, before: Moving, after: Moving
) -> tuple[float, float]:
    """Kinetic energy (J) of everything, and its axial part, from the velocities half a step before
    and after the present places."""
    payload, frame = system.model.payload, system.frame
    turn, base = (rotation.single(body.quaternion) for body in (state.payload, state.platform))
    mass = system.moving_mass[system.nodes]
    nodes = sum((mass * (a * b)).sum() for a, b in zip(before.nodes.T, after.nodes.T))
    kinetic = 0.5 * (payload.mass * before.velocity @ after.velocity + nodes)
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
    part, origin = system.nodes, state.platform.position
    px, py, pz = (system.moving_mass[part] * component for component in middle.nodes.T)
    x, y, z = (system.rail.points[part] + state.displacement[part]).T
    rails = base @ [px.sum(), py.sum(), pz.sum()]
    turning = base @ [(y * pz - z * py).sum(), (z * px - x * pz).sum(), (x * py - y * px).sum()]
    if system.frame is not None:
        origin = origin - base @ system.frame.centre
    own = system.model.payload.mass * middle.velocity
    bodies = [(state.payload.position, own, middle.spin)]
    linear = own + rails
    angular = _cross(state.payload.position, own) + middle.spin + turning + _cross(origin, rails)
    if system.frame is not None:
        carried = system.frame.mass * middle.platform_velocity
        bodies.append((state.platform.position, carried, middle.platform_spin))
        linear = linear + carried
        angular = angular + _cross(state.platform.position, carried) + middle.platform_spin
    # in the axes of the frame, as the nodes are
    a, b, c = base.T @ origin
    parts = [_sizes_of_nodes((x + a, y + b, z + c), (px, py, pz))]
    parts += [_sizes_of_body(*body) for body in bodies]
    return linear, angular, np.sum(parts, axis=0)


def _sizes_of_nodes(place, momentum) -> tuple[float, float, float]:
    """Sums over nodes of |p|, |r x p| and |r| |p|, of the components (n,) of each."""
    (x, y, z), (px, py, pz) = place, momentum
    own = np.sqrt(px * px + py * py + pz * pz)
    turning = np.sqrt((y * pz - z * py) ** 2 + (z * px - x * pz) ** 2 + (x * py - y * px) ** 2)
    reach = np.sqrt(x * x + y * y + z * z)
    return float(own.sum()), float(turning.sum()), float((reach * own).sum())


def _sizes_of_body(place, momentum, spin) -> tuple[float, float, float]:
    own, turning = math.hypot(*momentum), math.hypot(*spin)
    orbit = math.hypot(*_cross(place, momentum))
    return own, orbit + turning, math.hypot(*place) * own + turning


def _cross(a, b) -> np.ndarray:
    """Vector product of two triples; numpy's function takes far longer, to identify the axis."""
    (x, y, z), (p, q, r) = a.tolist(), b.tolist()
    return np.array([y * r - z * q, z * p - x * r, x * q - y * p])
