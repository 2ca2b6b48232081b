"""Rails without contact: their modes are free oscillators with a known solution. So they do not
limit the step.

    q'' + d q' + omega^2 q = 0,    q(t) = e^(-d t / 2) (q_0 C + (q_0' + q_0 d / 2) S)

with C = cos(w t), S = sin(w t) / w and w^2 = omega^2 - d^2 / 4, or cosh and sinh for damping above
critical (any text on the linear oscillator). The loss of their energy is the work of damping.

A vibrating wall may reach a pad near it, and such a touch must not be missed between the ends of a
step. The energy of a mode does not grow, so its amplitude is at most a = sqrt(q^2 + (q' /
omega)^2). The **swing** of the wall, the sum of a times the largest shape under the face, bounds
its motion. A face whose gap stays above its swing cannot touch. With a smaller gap, a step ends
early enough that the cubic through its ends has an error of at most ``_MISSED``; this error is h^4
a omega^4 / 384 (Hermite interpolation).
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant.modes import reach
from tipoff.lowfi.contact.wall_ends import (
    BEYOND,
    CLOSING,
    DEPTH,
    NEAR,
    NEARING,
    turning_point,
)
from tipoff.lowfi.state import STATE_SIZE, STRUCTURAL

_MISSED = 1e-9  # m, below the roughness of pads and walls
_HERMITE = 384.0
_SHORT_OF = 0.99  # of the way to a wall within reach; a step that begins there is then short
_CRITICAL = 1e-7  # of omega^2; a smaller w^2 is rounding


class Faces(NamedTuple):
    """The faces in a step."""

    rail: np.ndarray  # (f,) number of the rail of each
    touching: np.ndarray  # (f,) whether it touches in the step
    engaged: np.ndarray  # (f,) whether it is over its wall
    before: np.ndarray  # (f, SURVEY_SIZE) survey of the start
    after: np.ndarray  # (f, SURVEY_SIZE) survey of the end


@kernel
def advance(compliance, touching, dt, start, end, with_work):
    """Fill the modes of rails without a ``touching`` (f,) face in ``end``, ``dt`` (s) after ``start``,
    and add the work of damping if there is damping."""
    lost = _advance(compliance.modes, compliance.members, touching, dt, start, end)
    if with_work:
        end[STRUCTURAL] += lost


@kernel
def _advance(modes, members, touching, dt, start, end):
    """Advance the modes of one rail; returns the energy (J) lost to damping."""
    lost = 0.0
    if modes.square.size > 0:
        number = modes.square.shape[1]
        for rail in range(modes.square.shape[0]):
            if not is_pressed(members, rail, touching):
                first = STATE_SIZE + rail * number
                for i in range(first, first + number):
                    j = i + modes.square.size
                    q, rate = start[i], start[j]
                    end[i], end[j] = q, rate
                    if q != 0.0 or rate != 0.0:
                        square, drag = modes.square[rail, i - first], modes.drag[rail, i - first]
                        end[i], end[j] = oscillated(square, drag, dt, q, rate)
                        if drag > 0.0:
                            lost += 0.5 * (rate * rate - end[j] * end[j])
                            lost += 0.5 * square * (q * q - end[i] * end[i])
    return lost


@kernel
def oscillated(square, drag, time, q, rate):
    """Amplitude and rate of a free oscillator after ``time`` (s); omega^2 is ``square`` (1/s2) and d
    is ``drag`` (1/s)."""
    half = 0.5 * drag
    beyond = half * half - square
    if abs(beyond) <= _CRITICAL * square:
        c, s = np.exp(-half * time), time * np.exp(-half * time)
    elif beyond < 0.0:
        fast, decay = np.sqrt(-beyond), np.exp(-half * time)
        c, s = decay * np.cos(fast * time), decay * np.sin(fast * time) / fast
    else:
        # half - slow without cancellation
        slow = np.sqrt(beyond)
        later, sooner = np.exp(-square / (half + slow) * time), np.exp(-(half + slow) * time)
        c, s = 0.5 * (later + sooner), 0.5 * (later - sooner) / slow
    return q * c + (rate + half * q) * s, rate * c - (half * rate + square * q) * s


@kernel
def is_pressed(members, rail, touching):
    """Whether a ``touching`` (f,) face is on ``rail``."""
    for k in range(members.shape[1]):
        face = members[rail, k]
        if face >= 0 and touching[face]:
            return True
    return False


@kernel
def note_reach(modes, rail, face, count, speed, state, row):
    """Fill the ``row`` of a survey with an upper bound of the depth (m) of a face while its rail
    vibrates freely, and its rate for a wall at rest. ``speed`` (m/s): speed of the wall due to its
    modes. No bound if ``count`` faces press the rail."""
    if modes.square.size > 0:
        row[NEAR], row[NEARING] = np.inf, 0.0
        if count == 0:
            row[NEAR], row[NEARING] = _nearest(modes, rail, face, speed, state, row)


@kernel
def _nearest(modes, rail, face, speed, state, row):
    number, swing = modes.square.shape[1], 0.0
    first, rates = STATE_SIZE + rail * number, STATE_SIZE + modes.square.size + rail * number
    for i in range(number):
        swing += reach(modes, face, i) * _amplitude(
            modes.square[rail, i], state[first + i], state[rates + i]
        )
    # the present depth may be one swing less than that on a wall at rest
    return row[DEPTH] + 2.0 * swing, row[CLOSING] + speed


@kernel
def _amplitude(square, q, rate):
    return np.sqrt(q * q + rate * rate / square) if q != 0.0 or rate != 0.0 else 0.0


@kernel
def cannot_touch(modes, before, after, dt):
    """Whether free vibration of the rail cannot bring the wall to an open face in a step of ``dt`` (s)
    between two rows of a survey."""
    away = False
    if modes.square.size > 0:
        turn = turning_point(before[NEAR], after[NEAR], dt * before[NEARING], dt * after[NEARING])
        away = max(before[NEAR], after[NEAR], turn[1]) <= BEYOND
    return away


@kernel
def longest_step(modes, rail, touching, engaged, before, state):
    """Longest step (s) from ``state`` at which vibration cannot hide a touch of an ``engaged`` (f,)
    face on its ``rail`` (f,), by the survey ``before`` (f, SURVEY_SIZE)."""
    longest = np.inf
    if modes.square.size > 0:
        for face in range(engaged.size):
            if engaged[face] and not touching[face] and BEYOND < before[face, NEAR] < np.inf:
                longest = min(longest, _resolved(modes, rail[face], face, state))
    return longest


@kernel
def _resolved(modes, rail, face, state):
    """Step (s) whose cubic has an error of ``_MISSED`` at the wall under a face."""
    number, total = modes.square.shape[1], 0.0
    first, rates = STATE_SIZE + rail * number, STATE_SIZE + modes.square.size + rail * number
    for i in range(number):
        square = modes.square[rail, i]
        amplitude = _amplitude(square, state[first + i], state[rates + i])
        total += reach(modes, face, i) * amplitude * square * square
    return (_MISSED * _HERMITE / total) ** 0.25 if total > 0.0 else np.inf


@kernel
def shortened(modes, faces, state, dt):
    """``dt`` (s), or a shorter step to try if a face comes near a vibrating wall in it."""
    shortest = dt
    if modes.square.size > 0:
        for face in range(faces.engaged.size):
            before, after = faces.before[face], faces.after[face]
            if faces.engaged[face] and not faces.touching[face] and before[NEAR] < np.inf:
                longest = _resolved(modes, faces.rail[face], face, state)
                if dt > longest * (1.0 + 1e-6) and not cannot_touch(modes, before, after, dt):
                    up_to = 0.5  # of the step: both ends are away from the wall
                    if after[NEAR] > BEYOND:
                        up_to = _SHORT_OF * before[NEAR] / (before[NEAR] - after[NEAR])
                    shortest = min(shortest, max(longest, up_to * dt))
    return shortest
