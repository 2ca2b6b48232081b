"""The proven step limit during contact.

Linearised, the touching faces are springs and dampers on two rigid bodies: s^2 + C s + K = 0 in the
metric of the masses. With the slopes k_i = dF/dp and c_i = dF/d(p_dot) of each face and the inverse
mass w_i at it (payload plus platform, rotation included), the traces bound the spectra of K and C,
hence every eigenvalue s::

    |s| <= S = C/2 + sqrt(C^2/4 + K),   K = sum_i |k_i| w_i(n),   C = sum_i |c_i| w_i(n) + N_i |mu'| (w_i(t1) + w_i(t2))

and no step is longer than ``STABLE_RADIUS / S`` (``lowfi.dynamics.dormand_prince``). |mu'| is the
larger of mu/s and |d mu/ds| at the present slip. Under friction with sticking, a sticking face adds
its spring and damper in both tangents, a sliding one N mu_d/|g| across g
(``lowfi.contact.stick_slip``).
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.springs import (
    gradient,
    load,
    outward,
    penetration,
    relative_pose,
)
from tipoff.lowfi.contact.stick_slip import STICKS, acts, heading
from tipoff.mechanics.absent import SMOOTH, rubs
from tipoff.mechanics.laws import contact as law
from tipoff.mechanics.laws.friction import coefficient_over_speed

# relative change of p or s in a difference quotient: truncation and rounding are both below 1e-5
_NUDGE = 1e-6


@kernel
def fastest_rate(contact, system, touching, stick, state, ahead):
    """Bound S (1/s) of the eigenvalues of the ``touching`` faces (f,) at ``state``; 0 without a
    touching face.

    With a time ``ahead`` (s) it is an estimate of the later bound: every closing face is assumed to
    keep its speed.
    """
    rate = 0.0
    if contact is not None:
        payload, platform = system.payload, system.platform
        body = slot.motion(payload, state, slot.PAYLOAD)
        base = slot.frame(platform, state)
        place, turn = relative_pose(platform, body, base)
        stiffness, damping = 0.0, 0.0
        for i in range(touching.size):
            if touching[i]:
                face = system.faces[i]
                p = penetration(contact.thermal_offset, face, place, turn)
                if p > 0.0:
                    p += ahead * max(
                        load(contact, SMOOTH, platform, face, p, body, base).closing, 0.0
                    )
                    k, c = _normal(contact, system, face, p, body, base)
                    held, rubbed = _tangential(contact, system, stick[i], face, p, body, base)
                    stiffness += k + held
                    damping += c + rubbed
        rate = 0.5 * damping + np.sqrt(0.25 * damping * damping + stiffness)
    return rate


@kernel
def _normal(contact, system, face, p, body, base):
    """Contribution of one face, with two-step friction, to K (1/s2) and C (1/s)."""
    friction, platform, payload = system.friction, system.platform, system.payload
    now = load(contact, friction, platform, face, p, body, base)
    n = gradient(contact.thermal_offset, face, base, now.point)
    more = law.parts(contact.law, p * (1.0 + _NUDGE), now.closing)
    unit = law.parts(contact.law, p, 1.0)
    across = inverse_mass(platform, payload, body, base, now.point, n)
    stiffness = abs(more[0] + more[1] - now.raw) / (_NUDGE * p) * across
    damping = unit[1] * across + friction_damping(friction, now, platform, payload, body, base, n)
    return stiffness, damping


@kernel
def friction_damping(friction, now, platform, payload, body, base, n):
    """Contribution of a face's friction to C (1/s)."""
    damping = 0.0
    if rubs(friction):
        speed = np.sqrt(rotation.dot(now.slip, now.slip)) + _NUDGE * friction.static_speed
        here = coefficient_over_speed(friction, speed)
        there = coefficient_over_speed(friction, speed * (1.0 + _NUDGE)) * (1.0 + _NUDGE)
        slope = max(here, abs(there - here) / _NUDGE)
        a = _tangent(n)
        b = rotation.cross(n, a)
        damping = (
            max(now.raw, 0.0)
            * slope
            * (
                inverse_mass(platform, payload, body, base, now.point, a)
                + inverse_mass(platform, payload, body, base, now.point, b)
            )
        )
    return damping


@kernel
def _tangential(contact, system, row, face, p, body, base):
    """Contribution of friction with sticking to K (1/s2) and C (1/s)."""
    stiffness, damping, sticking = 0.0, 0.0, contact.sticking
    if acts(sticking):
        payload, platform = system.payload, system.platform
        now, n = load(contact, SMOOTH, platform, face, p, body, base), outward(face, base)
        if row[STICKS] != 0.0:
            a = _tangent(n)
            across = inverse_mass(platform, payload, body, base, now.point, a) + inverse_mass(
                platform, payload, body, base, now.point, rotation.cross(n, a)
            )
            stiffness, damping = sticking.stiffness * across, sticking.damping * across
        else:
            g = heading(sticking, row, now.slip, base)
            size = np.sqrt(rotation.dot(g, g))
            a = rotation.cross(n, (g[0] / size, g[1] / size, g[2] / size))
            damping = (
                sticking.dynamic
                * max(now.raw, 0.0)
                / size
                * inverse_mass(platform, payload, body, base, now.point, a)
            )
    return stiffness, damping


@kernel
def _tangent(n):
    """A unit vector across the unit vector ``n``."""
    t = (
        rotation.cross(n, (1.0, 0.0, 0.0))
        if abs(n[0]) < 0.7
        else rotation.cross(n, (0.0, 1.0, 0.0))
    )
    size = np.sqrt(rotation.dot(t, t))
    return (t[0] / size, t[1] / size, t[2] / size)


@kernel
def inverse_mass(platform, payload, body, base, point, direction):
    """Inverse mass (1/kg) of a pair of forces along ``direction`` at ``point``."""
    total = _own(payload.mass, payload.inverse_inertia, body, point, direction)
    if platform.free:
        total += _own(platform.mass, platform.inverse_inertia, base, point, direction)
    return total


@kernel
def _own(mass, inverse_inertia, body, point, direction):
    lever = _lever(body, point, direction)
    return 1.0 / mass + rotation.dot(
        lever, rotation.angular_velocity(body.turn, inverse_inertia, lever)
    )


@kernel
def _lever(body, point, direction):
    p = body.place
    return rotation.cross((point[0] - p[0], point[1] - p[1], point[2] - p[2]), direction)


@kernel
def mobility(platform, payload, body, base, one, other):
    """Change (1/kg) of the relative velocity along and at ``one`` by a unit impulse of a pair along
    and at the ``other``, each a direction and a point."""
    total = _shared(payload, body, one, other)
    if platform.free:
        total += _shared(platform, base, one, other)
    return total


@kernel
def _shared(record, body, one, other):
    lever = _lever(body, other[1], other[0])
    turned = rotation.angular_velocity(body.turn, record.inverse_inertia, lever)
    return rotation.dot(one[0], other[0]) / record.mass + rotation.dot(
        _lever(body, one[1], one[0]), turned
    )
