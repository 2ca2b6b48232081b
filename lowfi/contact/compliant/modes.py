"""Vibration of the rails: their lowest modes, integrated with the bodies (data:
``mechanics.rail_compliance``).

    U = F_res P + S q,    q_m'' + d_m q_m' + omega_m^2 q_m = sum_ia S_iam P_ia,    d_m = alpha + beta omega_m^2
    S = W + mu / 2 V

with W at the pads. Friction of the coefficient mu drives a mode by its displacement V along X. Of this, S
has the symmetric part, as D of ``solution`` has: half by the force on the mode, half by the displacement of
the wall. The other modes respond without inertia. These are Lagrange's equations of the
potential in ``loads`` and the modes' own energy sum_m (q_m'^2 + omega_m^2 q_m^2) / 2, so both
ledgers close. At ignition a rail is at rest and straight, as in the reference. While
faces press a rail the step size follows its highest mode (``lowfi.dynamics.local_error``,
``lowfi.contact.compliant.step_limit``); otherwise its modes are free oscillators, integrated exactly
(``lowfi.contact.compliant.free_vibration``).

The motion of the mounts with the platform is neglected, in both directions: the inertial load -L_m
a of the modes under the platform's acceleration a, and the momentum L_m q_m' of a vibrating rail,
by which the force on the platform differs from the contact force. L_m^2 is the effective mass of a
mode; their sum is below the mass of the rail. The reference scene has rails of 0.11 kg on a
platform of 81 kg: the effect is a thousandth of the contact force, and 1e-5 m/s of the platform if
a wall vibrates at 10 mm/s. So the momenta of payload and platform are conserved to rounding.
"""

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.contact.compliant import parts, patterns
from tipoff.lowfi.state import STATE_SIZE
from tipoff.mechanics.rail_compliance.patterns import DRAGGED


@kernel
def evaluate(modes, rail, face, station, way, changes, state):
    """Fill shapes, displacement and speed of the modes of ``rail`` under ``face``, ``way`` (m) from
    a station; ``changes`` is the derivative of ``way`` by the place."""
    if modes.square.size > 0:
        count, size = modes.square.shape[1], patterns.count(modes.levels)
        first, rates = STATE_SIZE + rail * count, STATE_SIZE + modes.square.size + rail * count
        modes.offset[face, :] = 0.0
        modes.slope[face, :] = 0.0
        modes.speed[face, :] = 0.0
        for i in range(count):
            q, rate = state[first + i], state[rates + i]
            for a in range(size):
                value, ahead = shape(modes, station, face, i, a, way)
                modes.shape[face, i, a] = value
                modes.offset[face, a] += q * value
                modes.slope[face, a] += q * changes * ahead
                modes.speed[face, a] += rate * value


@inlined
def _between(c, a, way):
    """Value and derivative of one of the cubics ``c`` (4,...)."""
    value = c[0, a] + way * (c[1, a] + way * (c[2, a] + way * c[3, a]))
    return value, c[1, a] + way * (2.0 * c[2, a] + way * 3.0 * c[3, a])


@inlined
def shape(shapes, station, face, i, a, way):
    """S of mode i in pattern a under ``face``, ``way`` (m) from a station, and its derivative; ``shapes`` has
    W and V, ``cubic`` and ``dragged``, the latter without stations if there is no friction."""
    value, ahead = _between(shapes.cubic[station, face, i], a, way)
    rubbed, ahead_rubbed = 0.0, 0.0
    if a < DRAGGED and shapes.dragged.shape[0] > 0:
        rubbed, ahead_rubbed = _between(shapes.dragged[station, face, i], a, way)
    share = 0.5 * shapes.friction[0]
    return value + share * rubbed, ahead + share * ahead_rubbed


@kernel
def reach(modes, face, i):
    """Bound (1/kg^0.5) of the displacement of a point under ``face`` by a unit of mode i."""
    return modes.reach[face, i, 0] + 0.5 * modes.friction[0] * modes.reach[face, i, 1]


@kernel
def is_at_rest(modes, rail, face, state):
    """Whether the modes of ``rail`` are at rest and straight; then no mode moves the wall under
    ``face``."""
    if modes.square.size > 0:
        count = modes.square.shape[1]
        first, rates = STATE_SIZE + rail * count, STATE_SIZE + modes.square.size + rail * count
        for i in range(count):
            if state[first + i] != 0.0 or state[rates + i] != 0.0:
                return False
        modes.speed[face, :] = 0.0
    return True


@kernel
def to_whole(modes, face, part):
    """Replace the values under ``face``, in the patterns of a ``part`` of it, by those of the whole
    face."""
    if modes.square.size > 0:
        for i in range(modes.square.shape[1]):
            parts.to_whole(modes.levels, part, modes.shape[face, i], 0, 1)
        parts.vector_to_whole(modes.levels, part, modes.offset[face], modes.slope[face])
        parts.to_whole(modes.levels, part, modes.speed[face], 0, 1)


@kernel
def offset(modes, face, a):
    """Displacement (m) of the wall in pattern a due to its modes."""
    value = 0.0
    if modes.square.size > 0:
        value = modes.offset[face, a]
    return value


@kernel
def slope(modes, face, a):
    """Derivative of ``offset`` along the rail."""
    value = 0.0
    if modes.square.size > 0:
        value = modes.slope[face, a]
    return value


@kernel
def speed_at(modes, face, xi, eta):
    """Speed (m/s) at which the modes move the point (xi, eta) of the wall away."""
    value = 0.0
    if modes.square.size > 0:
        value = patterns.value(modes.levels, modes.speed[face], xi, eta)
    return value


@kernel
def vibrate(modes, workspace, rail, count, state, out):
    """Fill the derivative ``out`` of the modes of ``rail`` under the ``count`` solved faces;
    returns the power (W) of their damping."""
    loss = 0.0
    number, size = modes.square.shape[1], patterns.count(modes.levels)
    first, rates = STATE_SIZE + rail * number, STATE_SIZE + modes.square.size + rail * number
    for i in range(number):
        rate, pressed = state[rates + i], 0.0
        for k in range(count):
            face = workspace.order[k]
            for a in range(size):
                pressed += modes.shape[face, i, a] * workspace.force[face, a]
        out[first + i] = rate
        out[rates + i] = (
            pressed - modes.square[rail, i] * state[first + i] - modes.drag[rail, i] * rate
        )
        loss += modes.drag[rail, i] * rate * rate
    return loss


@kernel
def energies(modes, state):
    """Kinetic and strain energy (J) of all modes."""
    kinetic, strain = 0.0, 0.0
    if modes.square.size > 0:
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


@kernel
def fastest(modes, rail, pressed):
    """Largest omega^2 (1/s2) and d (1/s) of the modes of a rail; zero if no face presses it."""
    square, drag = 0.0, 0.0
    if modes.square.size > 0:
        for i in range(modes.square.shape[1] if pressed else 0):
            square, drag = max(square, modes.square[rail, i]), max(drag, modes.drag[rail, i])
    return square, drag
