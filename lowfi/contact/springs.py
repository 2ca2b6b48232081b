"""Contact between pad faces and rail walls, one point per face at its centre.

With x the face's centre in platform axes, n its outward normal, along y or z, and u the velocity of
the pad's point relative to the rail's point at the same place (both inertial, so the rotation of
the frame is included)::

    p = n . x - wall,     p_dot = n . u,     F = -N n - mu(s)/s N (u - p_dot n),     N = max(0, raw)

``raw`` is the law in ``scenes.effects.contact``. For warm walls, ``lowfi.contact.thermal_offset``
defines p and n. ``lowfi.contact.wall_ends`` has the ends of the walls.
"""

from typing import NamedTuple

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.thermal_offset import offset_and_slope
from tipoff.lowfi.faces import NORMAL_Y, NORMAL_Z, NUMBER, WALL
from tipoff.lowfi.state import velocity_at
from tipoff.mechanics.absent import rubs
from tipoff.mechanics.laws import contact as law
from tipoff.mechanics.laws.friction import coefficient_over_speed


class Load(NamedTuple):
    """Load of a touching face on the payload; vectors in scene axes."""

    point: tuple  # m, point of action
    normal: tuple  # N, normal force
    drag: tuple  # N, two-step friction
    slip: tuple  # m/s, slip velocity
    closing: float  # m/s, penetration rate
    elastic: float  # N, elastic part of the normal force
    raw: float  # N, normal force before it is cut off at zero


@kernel
def relative_pose(platform, body, base):
    """Place (m) and rotation (nine numbers) of the payload in platform axes."""
    if platform.free:
        d = (
            body.place[0] - base.place[0],
            body.place[1] - base.place[1],
            body.place[2] - base.place[2],
        )
        return rotation.unrotate(base.turn, d), _relative_turn(base.turn, body.turn)
    return body.place, body.turn


@kernel
def _relative_turn(a, b):
    """A' B of two matrices."""
    return (
        a[0] * b[0] + a[3] * b[3] + a[6] * b[6],
        a[0] * b[1] + a[3] * b[4] + a[6] * b[7],
        a[0] * b[2] + a[3] * b[5] + a[6] * b[8],
        a[1] * b[0] + a[4] * b[3] + a[7] * b[6],
        a[1] * b[1] + a[4] * b[4] + a[7] * b[7],
        a[1] * b[2] + a[4] * b[5] + a[7] * b[8],
        a[2] * b[0] + a[5] * b[3] + a[8] * b[6],
        a[2] * b[1] + a[5] * b[4] + a[8] * b[7],
        a[2] * b[2] + a[5] * b[5] + a[8] * b[8],
    )


@kernel
def relative_motion(platform, body, base, place, turn):
    """Rates of change of ``place`` (m/s) and ``turn`` (1/s), the payload's pose in platform
    axes."""
    spin = rotation.unrotate(base.turn, body.rate)
    drift = rotation.unrotate(base.turn, body.velocity)
    if platform.free:
        drift, spin = _seen_from_platform(body, base, place, spin)
    swing = (
        spin[1] * turn[6] - spin[2] * turn[3],
        spin[1] * turn[7] - spin[2] * turn[4],
        spin[1] * turn[8] - spin[2] * turn[5],
        spin[2] * turn[0] - spin[0] * turn[6],
        spin[2] * turn[1] - spin[0] * turn[7],
        spin[2] * turn[2] - spin[0] * turn[8],
        spin[0] * turn[3] - spin[1] * turn[0],
        spin[0] * turn[4] - spin[1] * turn[1],
        spin[0] * turn[5] - spin[1] * turn[2],
    )
    return drift, swing


@kernel
def _seen_from_platform(body, base, place, spin):
    v, V = body.velocity, base.velocity
    own = rotation.unrotate(base.turn, base.rate)
    a, b = (
        rotation.unrotate(base.turn, (v[0] - V[0], v[1] - V[1], v[2] - V[2])),
        rotation.cross(own, place),
    )
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2]), (
        spin[0] - own[0],
        spin[1] - own[1],
        spin[2] - own[2],
    )


@kernel
def approach_of_straight(face, drift, swing):
    """Rate (m/s) of the penetration of ``face`` into a straight wall, from the rates of the pose."""
    y = drift[1] + swing[3] * face[0] + swing[4] * face[1] + swing[5] * face[2]
    z = drift[2] + swing[6] * face[0] + swing[7] * face[1] + swing[8] * face[2]
    return face[NORMAL_Y] * y + face[NORMAL_Z] * z


@kernel
def approach(offset, face, place, turn, drift, swing):
    """Rate (m/s) of the penetration of ``face``, from the pose and its rates."""
    rate = approach_of_straight(face, drift, swing)
    if offset is not None:
        x = drift[0] + swing[0] * face[0] + swing[1] * face[1] + swing[2] * face[2]
        rate -= offset_and_slope(offset, int(face[NUMBER]), along(face, place, turn))[1] * x
    return rate


@kernel
def along(face, place, turn):
    """X (m) of the centre of ``face``, a row of the table of faces, in platform axes."""
    return place[0] + turn[0] * face[0] + turn[1] * face[1] + turn[2] * face[2]


@kernel
def penetration_of_straight(face, place, turn):
    """Penetration (m) of ``face`` into a straight wall, negative across the gap."""
    y = place[1] + turn[3] * face[0] + turn[4] * face[1] + turn[5] * face[2]
    z = place[2] + turn[6] * face[0] + turn[7] * face[1] + turn[8] * face[2]
    return face[NORMAL_Y] * y + face[NORMAL_Z] * z - face[WALL]


@kernel
def penetration(offset, face, place, turn):
    """Penetration (m) of ``face`` into its wall, negative across the gap."""
    p = penetration_of_straight(face, place, turn)
    if offset is not None:
        p -= offset_and_slope(offset, int(face[NUMBER]), along(face, place, turn))[0]
    return p


@kernel
def forward(face, drift, swing):
    """Rate (m/s) of ``along``, from the rates of the pose."""
    return drift[0] + swing[0] * face[0] + swing[1] * face[1] + swing[2] * face[2]


@kernel
def across(face, place, turn):
    """Place (m) of the centre of ``face`` on the axis across rail and normal, in platform axes."""
    if face[NORMAL_Y] == 0.0:
        return place[1] + turn[3] * face[0] + turn[4] * face[1] + turn[5] * face[2]
    return place[2] + turn[6] * face[0] + turn[7] * face[1] + turn[8] * face[2]


@kernel
def sideways(face, drift, swing):
    """Rate (m/s) of ``across``, from the rates of the pose."""
    if face[NORMAL_Y] == 0.0:
        return drift[1] + swing[3] * face[0] + swing[4] * face[1] + swing[5] * face[2]
    return drift[2] + swing[6] * face[0] + swing[7] * face[1] + swing[8] * face[2]


@kernel
def outward(face, base):
    """Outward normal of ``face`` in scene axes, the wall being straight."""
    return rotation.rotate(base.turn, (0.0, face[NORMAL_Y], face[NORMAL_Z]))


@kernel
def along_width(face, size):
    """Vector of ``size`` along the width of ``face``: in its plane, across the rail, in the axes of
    payload or platform."""
    aside = size if face[NORMAL_Y] == 0.0 else 0.0
    return (0.0, aside, size - aside)


@kernel
def gradient(offset, face, base, point):
    """Gradient of the penetration by the pad's ``point`` (scene axes): the normal of the wall."""
    if offset is not None:
        return _gradient_with_offset(offset, face, base, point)
    return outward(face, base)


@kernel
def _gradient_with_offset(offset, face, base, point):
    place = rotation.unrotate(
        base.turn, (point[0] - base.place[0], point[1] - base.place[1], point[2] - base.place[2])
    )
    slope = offset_and_slope(offset, int(face[NUMBER]), place[0])[1]
    return rotation.rotate(base.turn, (-slope, face[NORMAL_Y], face[NORMAL_Z]))


@kernel
def slip_velocity(offset, u, closing, n):
    """The part of ``u`` (m/s) across ``n``; |n| is one for a straight wall."""
    along = closing
    if offset is not None:
        along = closing / rotation.dot(n, n)
    return (u[0] - along * n[0], u[1] - along * n[1], u[2] - along * n[2])


@kernel
def pad_point(face, body):
    """Centre of ``face`` in scene axes (m)."""
    arm = rotation.rotate(body.turn, (face[0], face[1], face[2]))
    return (body.place[0] + arm[0], body.place[1] + arm[1], body.place[2] + arm[2])


@kernel
def relative_velocity(platform, body, base, point):
    """Velocity (m/s) of the payload's point against the platform's point at the same place."""
    u = velocity_at(body, point)
    if platform.free:
        w = velocity_at(base, point)
        return (u[0] - w[0], u[1] - w[1], u[2] - w[2])
    return u


@kernel
def friction_force(friction, normal_force, slip):
    """Friction on the payload (N) at slip velocity ``slip`` (m/s); zero without friction."""
    if rubs(friction):
        factor = -normal_force * coefficient_over_speed(friction, rotation.dot(slip, slip) ** 0.5)
        return (factor * slip[0], factor * slip[1], factor * slip[2])
    return (0.0, 0.0, 0.0)


@kernel
def load(contact, friction, platform, face, p, body, base):
    """Load of ``face`` at penetration ``p`` >= 0."""
    point = pad_point(face, body)
    n = gradient(contact.thermal_offset, face, base, point)
    u = relative_velocity(platform, body, base, point)
    closing = rotation.dot(u, n)
    elastic, damping = law.parts(contact.law, p, closing)
    raw = elastic + damping
    force = max(raw, 0.0)
    slip = slip_velocity(contact.thermal_offset, u, closing, n)
    return Load(
        point=point,
        normal=(-force * n[0], -force * n[1], -force * n[2]),
        drag=friction_force(friction, force, slip),
        slip=slip,
        closing=closing,
        elastic=elastic,
        raw=raw,
    )
