"""Spring pushers of the surrogate: their travel, their segments, and their energy.

In a step each pusher follows the line of one segment of its force, also a little beyond it. The step
ends where the travel passes the end of the segment (``dynamics.events``). So the force is smooth in
every step, and a step ends exactly where a stroke is used up.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.kernels.reference import by_reference
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.springs import relative_pose
from tipoff.lowfi.contact.step_limit import inverse_mass
from tipoff.mechanics.laws import pushers as law

_NEAR = 1e-12  # m, distance from a knot at which it counts as passed


@by_reference
class Pushing(NamedTuple):
    """Pushers and their evolving values."""

    law: law.Pushers
    segment: np.ndarray  # (n,) number of the present segment of each
    before: np.ndarray  # (n,) m, travel at the start of the step
    after: np.ndarray  # (n,) m, travel at its end
    inertia: "Inertia"  # of none if no pusher has mass


@by_reference
class Inertia(NamedTuple):
    """Evolving values of pushers with mass, and work space."""

    kept: np.ndarray  # (n,) J, kinetic energy at the end of the stroke, zero before
    speed: np.ndarray  # (n,) m/s, of the travel at the end of the step
    matrix: np.ndarray  # (n,n)
    pairs: np.ndarray  # (n,) N


def pushing(pushers: law.Pushers) -> Pushing:
    """A record for one run of ``pushers``, which may be none."""
    count = len(pushers.point)
    return Pushing(
        law=pushers,
        segment=np.zeros(count, dtype=np.int64),
        before=np.zeros(count),
        after=np.zeros(count),
        inertia=_inertia(pushers.mass.size),
    )


def _inertia(count: int) -> Inertia:
    return Inertia(
        kept=np.zeros(count),
        speed=np.zeros(count),
        matrix=np.zeros((count, count)),
        pairs=np.zeros(count),
    )


@kernel
def reset(pushing):
    """Begin at the surveyed travel."""
    for i in range(pushing.segment.size):
        pushing.segment[i] = law.segment_at(pushing.law, i, pushing.after[i])
    pushing.inertia.kept[:] = 0.0


@kernel
def survey(pushing, platform, payload, state):
    """Fill the travel at the end of the step, which has this ``state``."""
    if pushing.segment.size > 0:
        body, base = slot.motion(payload, state, slot.PAYLOAD), slot.frame(platform, state)
        place, turn = relative_pose(platform, body, base)
        for i in range(pushing.segment.size):
            pushing.after[i] = law.travel(pushing.law, i, place, turn)
        for i in range(pushing.inertia.speed.size):
            pushing.inertia.speed[i] = speed_of(pushing, i, platform, body, base)


@kernel
def begin_step(pushing):
    """Go on to the segments of the travel that is reached; True if any changed. A pusher whose
    stroke is used up stays off."""
    changed = False
    for i in range(pushing.segment.size):
        pushing.before[i] = pushing.after[i]
        moved = _go_on(pushing, i)
        if moved:
            _stop(pushing.inertia, pushing.law.mass, pushing, i)
        changed = moved or changed
    return changed


@kernel
def _stop(inertia, mass, pushing, i):
    """Keep the kinetic energy of a pusher whose stroke is used up."""
    if mass.size > 0:
        if pushing.segment[i] == law.last_segment(pushing.law, i):
            inertia.kept[i] = 0.5 * mass[i] * inertia.speed[i] * inertia.speed[i]


@kernel
def _go_on(pushing, i):
    knots, first = pushing.law.travel, pushing.law.first[i]
    s, began, last = pushing.after[i], pushing.segment[i], law.last_segment(pushing.law, i)
    while pushing.segment[i] < last and s >= knots[first + pushing.segment[i] + 1] - _NEAR:
        pushing.segment[i] += 1
    while 0 < pushing.segment[i] < last and s < knots[first + pushing.segment[i]] - _NEAR:
        pushing.segment[i] -= 1
    return began != pushing.segment[i]


@kernel
def passed(pushing, i):
    """Travel (m) of the end of its segment that pusher ``i`` passes in the step; NaN if none."""
    segment, first = pushing.segment[i], pushing.law.first[i]
    if segment < law.last_segment(pushing.law, i):
        high = pushing.law.travel[first + segment + 1]
        if pushing.after[i] > high:
            return high
        low = pushing.law.travel[first + segment] - 2.0 * _NEAR
        if segment > 0 and pushing.after[i] < low:
            return low
    return np.nan


@kernel
def travel_at(pushing, i, platform, payload, state):
    """Travel (m) of pusher ``i`` at a ``state``."""
    body, base = slot.motion(payload, state, slot.PAYLOAD), slot.frame(platform, state)
    place, turn = relative_pose(platform, body, base)
    return law.travel(pushing.law, i, place, turn)


class Push(NamedTuple):
    """Forces of one pusher on the payload, in scene axes."""

    point: tuple  # m, point of action
    force: tuple  # N, of the spring
    drag: tuple  # N, friction of the pusher
    slip: tuple  # m/s, velocity of the payload's point relative to the platform's


@kernel
def push_of(pushing, i, platform, body, base):
    """Forces of pusher ``i``."""
    place, turn = relative_pose(platform, body, base)
    point = place_of(pushing, i, body)
    e = rotation.rotate(base.turn, law.direction_of(pushing.law, i))
    slip = slip_at(body, base, point)
    segment = pushing.segment[i]
    size = law.force(pushing.law, i, segment, law.travel(pushing.law, i, place, turn))
    held = law.friction(pushing.law, i, segment, rotation.dot(e, slip))
    return Push(
        point,
        (size * e[0], size * e[1], size * e[2]),
        (-held * e[0], -held * e[1], -held * e[2]),
        slip,
    )


@kernel
def fastest_rate(pushing, platform, payload, state):
    """Bound (1/s) of the eigenvalues of the pushers at ``state``, as that of contact springs
    (``contact.step_limit``): K = sum |dF/ds| w, C = sum |df/d(ds/dt)| w."""
    stiffness, damping = 0.0, 0.0
    if pushing.segment.size > 0:
        body, base = slot.motion(payload, state, slot.PAYLOAD), slot.frame(platform, state)
        for i in range(pushing.segment.size):
            e = rotation.rotate(base.turn, law.direction_of(pushing.law, i))
            push = push_of(pushing, i, platform, body, base)
            across = inverse_mass(platform, payload, body, base, push.point, e)
            segment, speed = pushing.segment[i], rotation.dot(e, push.slip)
            stiffness += abs(law.slope(pushing.law, i, segment)) * across
            damping += law.damping(pushing.law, i, segment, speed) * across
    return 0.5 * damping + np.sqrt(0.25 * damping * damping + stiffness)


@kernel
def work(pushing, integrated, platform, body, base):
    """Work (J) of the thrust: the energy that the pushers have given up, by their potential;
    without pushers the ``integrated`` one."""
    total = integrated
    if pushing.segment.size > 0:
        total = 0.0
        place, turn = relative_pose(platform, body, base)
        for i in range(pushing.segment.size):
            s = law.travel(pushing.law, i, place, turn)
            total += law.given_up(pushing.law, i, pushing.segment[i], s)
        total -= _in_pushers(pushing.inertia, pushing.law.mass, pushing, platform, body, base)
    return total


@kernel
def _in_pushers(inertia, mass, pushing, platform, body, base):
    """Kinetic energy (J) that the pushers have or have kept."""
    total = 0.0
    for i in range(inertia.kept.size):
        total += inertia.kept[i]
        if pushing.segment[i] != law.last_segment(pushing.law, i):
            speed = speed_of(pushing, i, platform, body, base)
            total += 0.5 * mass[i] * speed * speed
    return total


@kernel
def place_of(pushing, i, body):
    """Point (m) of pusher ``i`` in scene axes."""
    arm = rotation.rotate(body.turn, law.point_of(pushing.law, i))
    return (body.place[0] + arm[0], body.place[1] + arm[1], body.place[2] + arm[2])


@kernel
def slip_at(body, base, point):
    """Velocity (m/s) of the payload at a ``point`` relative to the platform there."""
    there, here = slot.velocity_at(body, point), slot.velocity_at(base, point)
    return (there[0] - here[0], there[1] - here[1], there[2] - here[2])


@kernel
def speed_of(pushing, i, platform, body, base):
    """Speed (m/s) of the travel of pusher ``i``."""
    e = rotation.rotate(base.turn, law.direction_of(pushing.law, i))
    return rotation.dot(e, slip_at(body, base, place_of(pushing, i, body)))
