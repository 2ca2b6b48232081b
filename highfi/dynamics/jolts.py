"""Vibration of rails at rest on an accelerated platform, which the rails at rest leave out.

For each term c of the acceleration (``statics.inertial``) a mode with a frequency w is followed,

    s'' = w^2 (c - s)

with the mean of c between two evaluations, in closed form. w is the lowest frequency by Rayleigh's
quotient of the rail's deflections, because modes of higher frequency follow c more closely. The
static deflection has s = c, so a rail at rest leaves out the deflection times the amplitude of s -
c in one mode. Several modes leave out at most ``MODES`` times as much
(tests/highfi/dynamics/test_resting.py).
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.observe import Moving
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.state.records import State
from tipoff.highfi.statics.inertial import TERMS
from tipoff.kernels import rotation

MODES = 4.0


class Jolts(NamedTuple):
    """Evolving values."""

    modes: np.ndarray  # (2,s,TERMS) s and s'/w of each solid in ``Rails.size``
    rates: np.ndarray  # (11,) ``rates`` of the platform at the last evaluation, and its time (s)
    left_out: np.ndarray  # (1,) m, at present
    most: np.ndarray  # (1,) m, largest value at which a rail was stepped again


def rates(system: System, state: State, moving: Moving) -> np.ndarray:
    """Attitude, and velocity of the frame's origin and rate when velocities are ``moving``: (10,)."""
    frame, quaternion = system.frame, state.platform.quaternion
    assert frame is not None
    base = rotation.single(quaternion)
    rate = frame.inverse_inertia @ (base.T @ moving.platform_spin)
    velocity = moving.platform_velocity - base @ (_matrix(rate) @ frame.centre)
    return np.concatenate([quaternion, velocity, rate])


def terms(system: System, before: np.ndarray, after: np.ndarray, span: float) -> np.ndarray:
    """Mean acceleration (TERMS,) of the rails' mounts between two ``rates``, ``span`` (s) apart,
    minus that of the body force."""
    base = rotation.single(after[:4])
    linear = (after[4:7] - before[4:7]) / span
    if system.model.body_force is not None:
        linear = linear - np.array(system.model.body_force)
    spin = _matrix(after[7:10])
    gradient = _matrix((after[7:10] - before[7:10]) / span) + spin @ spin
    # Places in shapes begin at the scene origin.
    return np.concatenate([base.T @ linear - gradient @ system.origin, gradient.ravel()])


def _matrix(rate: np.ndarray) -> np.ndarray:
    """Matrix W with W X = rate x X."""
    x, y, z = rate.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def begin(rails: Rails | None) -> Jolts:
    """Modes at rest."""
    solids = 0 if rails is None else len(rails.size)
    return Jolts(
        modes=np.zeros((2, solids, TERMS)),
        rates=np.zeros(11),
        left_out=np.zeros(1),
        most=np.zeros(1),
    )


def follow(rails: Rails, modes: np.ndarray, amounts: np.ndarray, span: float) -> float:
    """Advance ``modes`` by ``span`` (s) at the ``amounts`` (TERMS,); returns the largest deflection
    (m) of a wall that is left out."""
    angle = rails.frequency * span
    cosine, sine = np.cos(angle), np.sin(angle)
    away, speed = modes[0] - amounts, modes[1].copy()
    modes[0] = amounts + away * cosine + speed * sine
    modes[1] = speed * cosine - away * sine
    return largest(rails, np.hypot(modes[0] - amounts, modes[1]))


def largest(rails: Rails, amplitudes: np.ndarray) -> float:
    """Bound (m) of the vibration of any wall under ``amplitudes`` (s,TERMS) or (TERMS,) of its terms."""
    return MODES * float((rails.size * amplitudes).sum(axis=1).max(initial=0.0))
