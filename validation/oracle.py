"""An independent implementation of the same physics: fixed-step Runge-Kutta of order four on
Newton's and Euler's equations.

    m v' = F,    I w' = M - w x I w    (w and M in body axes, M about the body's own mass centre),    q' = q w / 2

It shares only the laws in ``mechanics.laws``, the thermal offset (``lowfi.contact.thermal_offset``) and
the rotations with the fast solver. It has other state variables, another integrator, no events and no
error control, and it continues after a pad strikes an edge of a wall. Tests compare the fast solver with
it; benchmarks use it as the baseline.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel, njit
from tipoff.lowfi.contact import thermal_offset
from tipoff.lowfi.faces import BACK, NUMBER, SIDE_MIDDLE, SIDE_REACH
from tipoff.lowfi.models import require_walls
from tipoff.lowfi.system import System, build
from tipoff.mechanics.laws import contact as law
from tipoff.mechanics.laws.body_force import acceleration
from tipoff.mechanics.laws.friction import coefficient_over_speed
from tipoff.mechanics.laws.thrust import magnitude
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import scene_model
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.rail_compliance import of_scene
from tipoff.scenes.scene import Scene

_BODY = 13  # place, velocity, quaternion, body rate
_SIZE = 2 * _BODY


class Samples(NamedTuple):
    """Motion of the payload at n samples."""

    time: np.ndarray  # (n,) s
    position: np.ndarray  # (n, 3) m, scene axes
    velocity: np.ndarray  # (n, 3) m/s, scene axes
    quaternion: np.ndarray  # (n, 4)
    rate: np.ndarray  # (n, 3) rad/s, body axes
    evaluations: int  # evaluations of the right-hand side


class Motion(NamedTuple):
    """Motion of a body at one instant."""

    place: tuple  # m, scene axes
    velocity: tuple  # m/s, scene axes
    quaternion: tuple
    body_rate: tuple  # rad/s, body axes
    turn: tuple  # nine numbers of the rotation matrix
    rate: tuple  # rad/s, scene axes


def solve(
    scene: Scene,
    steps_per_sample: int,
    samples: int | None = None,
    interval: float | None = None,
    compliance: RailCompliance | None = None,
) -> Samples:
    """Motion of the payload of ``scene`` with ``steps_per_sample`` equal steps between samples, to
    the scene's duration; a warm scene needs a rigid ``compliance``."""
    interval = interval or scene.output.interval
    samples = samples if samples is not None else round(scene.time_limit / interval)
    job, rows = prepared(scene, steps_per_sample, samples, interval, compliance)
    integrate(*job, rows)
    return Samples(
        np.arange(len(rows)) * interval,
        rows[:, 0:3],
        velocity=rows[:, 3:6],
        quaternion=rows[:, 6:10],
        rate=rows[:, 10:13],
        evaluations=4 * steps_per_sample * (len(rows) - 1),
    )


def prepared(
    scene: Scene,
    steps_per_sample: int,
    samples: int,
    interval: float,
    compliance: RailCompliance | None = None,
) -> tuple[tuple[System, np.ndarray, np.ndarray, float, int], np.ndarray]:
    """All arguments of ``integrate`` but the last, and the last argument: rows (samples + 1, 26),
    with only the first row filled.

    Raises SceneError for friction that sticks.
    """
    require_two_step(scene)
    model = scene_model.build(scene)
    platform_inertia = model.platform.inertia if model.platform is not None else np.eye(3)
    rows = np.zeros((samples + 1, _SIZE))
    rows[0] = _start(model)
    require_walls(scene, compliance)
    walls = of_scene(compliance, scene) if compliance and scene.contact else None
    return (
        build(model, thermal_offset=thermal_offset.under_pads(model, walls)),
        model.payload.inertia,
        platform_inertia,
        interval / steps_per_sample,
        steps_per_sample,
    ), rows


def _start(model) -> np.ndarray:
    first = model.initial
    payload = [
        *np.add(model.payload.mass_centre, first.position),
        *first.velocity,
        *rotation.exponential(first.attitude),
        *first.rate,
    ]
    if model.platform is None:
        return np.array(payload + [0.0] * 6 + [1.0] + [0.0] * 6)
    return np.array(
        [
            *payload,
            *model.platform.mass_centre,
            *first.platform_velocity,
            1.0,
            0.0,
            0.0,
            0.0,
            *first.platform_rate,
        ]
    )


@njit
def integrate(system, inertia, platform_inertia, dt, steps_per_sample, rows):
    """Fill ``rows`` (n, 26) from the first one."""
    state, trial, k = rows[0].copy(), np.empty(_SIZE), np.zeros((4, _SIZE))
    for number in range(1, rows.shape[0]):
        for part in range(steps_per_sample):
            time = ((number - 1) * steps_per_sample + part) * dt
            slope(system, inertia, platform_inertia, time, state, k[0])
            for stage, fraction in ((1, 0.5), (2, 0.5), (3, 1.0)):
                for j in range(_SIZE):
                    trial[j] = state[j] + fraction * dt * k[stage - 1, j]
                slope(system, inertia, platform_inertia, time + fraction * dt, trial, k[stage])
            for j in range(_SIZE):
                state[j] += dt / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])
        for j in range(_SIZE):
            rows[number, j] = state[j]


@njit
def slope_of(system, inertia, platform_inertia, time, state):
    """Time derivative (26,) of ``state`` (26,), for integrators in Python."""
    out = np.empty(_SIZE)
    slope(system, inertia, platform_inertia, time, state, out)
    return out


@kernel
def slope(system, inertia, platform_inertia, time, state, out):
    """Time derivative ``out`` of ``state`` (26,)."""
    body, base = _motion(state, 0), _motion(state, _BODY)
    r, R = body.place, base.place
    force, moment = thrust(system.thrust, system.thrust_offset, time, body.turn)
    # The wrench on the platform about its own mass centre is opposite to that on the payload and
    # acts at the same points.
    reacts = system.reacts_on_platform
    F = (-force[0], -force[1], -force[2]) if reacts else (0.0, 0.0, 0.0)
    M = _reversed(force, moment, r, R) if reacts else (0.0, 0.0, 0.0)
    place = rotation.unrotate(base.turn, (r[0] - R[0], r[1] - R[1], r[2] - R[2]))
    x = _column(base.turn, body.turn, 0)
    y, z = _column(base.turn, body.turn, 1), _column(base.turn, body.turn, 2)
    axes = (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])
    for i in range(system.faces.shape[0]):
        push, arm = pad_contact(system.contact, system, system.faces[i], place, axes, body, base)
        if push[0] != 0.0 or push[1] != 0.0 or push[2] != 0.0:
            twist = rotation.cross(arm, push)
            force, moment = _sum(force, push), _sum(moment, twist)
            F, M = _sum(F, (-push[0], -push[1], -push[2])), _sum(M, _reversed(push, twist, r, R))
    fall = acceleration(system.body_force)
    _newton_euler(system.payload, inertia, body, (force, moment), fall, out[:_BODY])
    _platform(system.platform, platform_inertia, base, (F, M), fall, out[_BODY:])


@kernel
def _column(frame, turn, i):
    """Body axis ``i`` in platform axes."""
    return rotation.unrotate(frame, (turn[i], turn[3 + i], turn[6 + i]))


@kernel
def _platform(platform, inertia, motion, wrench, fall, out):
    if platform is None:
        for j in range(_BODY):
            out[j] = 0.0
    if platform is not None:
        _newton_euler(platform, inertia, motion, wrench, fall, out)


@kernel
def _newton_euler(body, inertia, motion, wrench, fall, out):
    w, (force, moment) = motion.body_rate, wrench
    h = (
        inertia[0, 0] * w[0] + inertia[0, 1] * w[1] + inertia[0, 2] * w[2],
        inertia[1, 0] * w[0] + inertia[1, 1] * w[1] + inertia[1, 2] * w[2],
        inertia[2, 0] * w[0] + inertia[2, 1] * w[1] + inertia[2, 2] * w[2],
    )
    gyro, body_moment = rotation.cross(w, h), rotation.unrotate(motion.turn, moment)
    turning = rotation.product(motion.quaternion, (0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]))
    for i in range(3):
        out[i], out[3 + i], out[10 + i] = motion.velocity[i], force[i] / body.mass + fall[i], 0.0
        for j in range(3):
            out[10 + i] += body.inverse_inertia[i, j] * (body_moment[j] - gyro[j])
    for i in range(4):
        out[6 + i] = turning[i]


@kernel
def thrust(record, offset, time, turn):
    """Force (N) and moment about the payload's mass centre (N m), scene axes."""
    size = magnitude(record.pulses, record.curve, time)
    force, moment = (size * turn[0], size * turn[3], size * turn[6]), (0.0, 0.0, 0.0)
    if offset is not None:
        d = offset.direction
        force = rotation.rotate(turn, (size * d[0], size * d[1], size * d[2]))
        moment = rotation.cross(rotation.rotate(turn, offset.arm), force)
    return force, moment


@kernel
def pad_contact(contact, system, face, place, axes, body, base):
    """Force (N) of one face on the payload and its arm from the payload's mass centre (m), scene
    axes.

    ``place`` (m) and ``axes`` (nine numbers) of the payload are in platform axes.
    """
    force, arm = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if contact is not None:
        c = rotation.rotate(axes, (face[0], face[1], face[2]))
        x = (place[0] + c[0], place[1] + c[1], place[2] + c[2])
        away, slope = _thermal_offset(contact.thermal_offset, face, x[0])
        p = face[3] * x[1] + face[4] * x[2] - face[5] - away
        side = (x[1] if face[3] == 0.0 else x[2]) - face[SIDE_MIDDLE]
        if (
            0.0 < p < face[BACK]
            and system.rail_start <= x[0] <= system.rail_end
            and abs(side) <= face[SIDE_REACH]
        ):
            r, v, R, V = body.place, body.velocity, base.place, base.velocity
            arm = rotation.rotate(body.turn, (face[0], face[1], face[2]))
            d = (r[0] + arm[0] - R[0], r[1] + arm[1] - R[1], r[2] + arm[2] - R[2])
            a, b = rotation.cross(body.rate, arm), rotation.cross(base.rate, d)
            u = rotation.unrotate(
                base.turn,
                (v[0] + a[0] - V[0] - b[0], v[1] + a[1] - V[1] - b[1], v[2] + a[2] - V[2] - b[2]),
            )
            n = (-slope, face[3], face[4])
            closing = rotation.dot(n, u)
            elastic, damping = law.parts(contact.law, p, closing)
            normal = max(0.0, elastic + damping)
            off = closing / rotation.dot(n, n)
            slip = (u[0] - off * n[0], u[1] - off * n[1], u[2] - off * n[2])
            drag = normal * _drag(system.friction, slip)
            force = rotation.rotate(
                base.turn,
                (
                    -normal * n[0] - drag * slip[0],
                    -normal * n[1] - drag * slip[1],
                    -normal * n[2] - drag * slip[2],
                ),
            )
    return force, arm


@kernel
def _thermal_offset(offset, face, x):
    """Thermal offset (m) of the wall at ``x`` (m), and its slope."""
    if offset is not None:
        return thermal_offset.offset_and_slope(offset, int(face[NUMBER]), x)
    return 0.0, 0.0


@kernel
def _drag(friction, slip):
    return coefficient_over_speed(friction, np.sqrt(rotation.dot(slip, slip)))


@kernel
def _reversed(force, moment, r, R):
    """Moment about R of the opposite of ``force``, whose moment about r is ``moment``."""
    carried = rotation.cross((r[0] - R[0], r[1] - R[1], r[2] - R[2]), force)
    return (-moment[0] - carried[0], -moment[1] - carried[1], -moment[2] - carried[2])


@kernel
def _sum(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def _motion(state, first):
    """Motion of the body whose slots begin at ``first``."""
    quaternion = (state[first + 6], state[first + 7], state[first + 8], state[first + 9])
    turn = rotation.matrix(quaternion)
    body_rate = (state[first + 10], state[first + 11], state[first + 12])
    return Motion(
        place=(state[first], state[first + 1], state[first + 2]),
        velocity=(state[first + 3], state[first + 4], state[first + 5]),
        quaternion=quaternion,
        body_rate=body_rate,
        turn=turn,
        rate=rotation.rotate(turn, body_rate),
    )
