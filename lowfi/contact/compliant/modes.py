"""Vibration of the rails that pads press: their lowest modes, states of their own behind those of
the bodies (data: ``mechanics.rail_compliance``).

    U = F_res P + W q,    q_m'' + d_m q_m' + omega_m^2 q_m = sum_ia W_iam P_ia,    d_m = alpha + beta omega_m^2

with W at the place the pads are at. The other modes follow at once. These are Lagrange's equations
of the potential in ``loads`` with the modes' own energy sum_m (q_m'^2 + omega_m^2 q_m^2) / 2 beside
it, so both ledgers close. At ignition a rail is at rest and straight, as in the reference.
``lowfi.dynamics.local_error`` and ``lowfi.contact.compliant.step_limit`` hold the steps to what the highest mode asks.

Left out, in both directions, is that mounts move with the platform: the inertial load -L_m a of the
modes under its acceleration a, and the momentum L_m q_m' of a rail that swings, which the contact
force, taken to act on the platform at once, lacks or has too much. L_m^2 is the mode's effective
mass, and all of them together are less than the rail weighs. The reference scene has rails of 0.11
kg on a platform of 81 kg: a thousandth of the contact force, and 1e-5 m/s of the platform when a
wall swings at 10 mm/s. The momenta of payload and platform are kept to rounding by that choice.
"""

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.state import STATE_SIZE
from tipoff.mechanics.rail_compliance import PATTERNS, POWERS

_XI, _ETA = POWERS.T.copy()


@kernel
def take_swing(modes, rail, face, station, way, changes, state):
    """Fill what the modes of ``rail`` are under ``face``, ``way`` (m) from a station where that
    changes by ``changes`` with the place."""
    if modes is not None:
        count = modes.square.shape[1]
        first, rates = STATE_SIZE + rail * count, STATE_SIZE + modes.square.size + rail * count
        modes.offset[face, :] = 0.0
        modes.slope[face, :] = 0.0
        modes.speed[face, :] = 0.0
        for i in range(count):
            for a in range(PATTERNS):
                c = modes.cubic[station, face, i, a]
                value = c[0] + way * (c[1] + way * (c[2] + way * c[3]))
                modes.shape[face, i, a] = value
                modes.offset[face, a] += state[first + i] * value
                modes.slope[face, a] += (
                    state[first + i] * changes * (c[1] + way * (2.0 * c[2] + way * 3.0 * c[3]))
                )
                modes.speed[face, a] += state[rates + i] * value


@inlined
def offset(modes, face, a):
    """Displacement (m) of the wall in pattern a by its modes."""
    value = 0.0
    if modes is not None:
        value = modes.offset[face, a]
    return value


@inlined
def slope(modes, face, a):
    """By how much (1) that changes per metre of way."""
    value = 0.0
    if modes is not None:
        value = modes.slope[face, a]
    return value


@inlined
def speed_at(modes, face, xi, eta):
    """Speed (m/s) at which the place (xi, eta) on the wall moves away by the modes."""
    value = 0.0
    if modes is not None:
        for a in range(PATTERNS):
            value += modes.speed[face, a] * xi ** _XI[a] * eta ** _ETA[a]
    return value


@kernel
def swing(modes, room, rail, count, state, out):
    """Fill the derivative ``out`` of the modes of ``rail``, pressed by the ``count`` faces solved
    for; what damping takes (W)."""
    loss = 0.0
    number = modes.square.shape[1]
    first, rates = STATE_SIZE + rail * number, STATE_SIZE + modes.square.size + rail * number
    for i in range(number):
        rate, pressed = state[rates + i], 0.0
        for k in range(count):
            face = room.order[k]
            for a in range(PATTERNS):
                pressed += modes.shape[face, i, a] * room.force[face, a]
        out[first + i] = rate
        out[rates + i] = (
            pressed - modes.square[rail, i] * state[first + i] - modes.drag[rail, i] * rate
        )
        loss += modes.drag[rail, i] * rate * rate
    return loss


@inlined
def energies(modes, state):
    """Kinetic and strain energy (J) of all modes."""
    kinetic, strain = 0.0, 0.0
    if modes is not None:
        count = modes.square.shape[1]
        for rail in range(modes.square.shape[0]):
            for i in range(count):
                q, rate = (
                    state[STATE_SIZE + rail * count + i],
                    state[STATE_SIZE + modes.square.size + rail * count + i],
                )
                kinetic += 0.5 * rate * rate
                strain += 0.5 * modes.square[rail, i] * q * q
    return kinetic, strain


@inlined
def fastest(modes, rail, pressed, state):
    """Largest omega^2 (1/s2) and d (1/s) of the modes of a rail; zero while it is at rest and
    nothing has pressed it, for then it stays so."""
    square, drag = 0.0, 0.0
    if modes is not None:
        count = modes.square.shape[1]
        first, rates = STATE_SIZE + rail * count, STATE_SIZE + modes.square.size + rail * count
        moving = pressed
        for i in range(count):
            moving = moving or state[first + i] != 0.0 or state[rates + i] != 0.0
        for i in range(count if moving else 0):
            square, drag = max(square, modes.square[rail, i]), max(drag, modes.drag[rail, i])
    return square, drag
