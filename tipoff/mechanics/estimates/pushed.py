"""Estimate of the motion of a payload that springs push along rails without friction.

The speed at the travel s follows from energy, and the time from the speed::

    v^2 / 2 = v_0^2 / 2 + integral of (g F + p) ds,     t = integral of ds / v

with the acceleration g per force and p of a body force. F is the sum of all springs less the friction
and the inertia of their pushers, of mass m in all: f - m (g F + p) of the rest f. Speed and time are exact
in a cell of s with constant force.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.mechanics.laws.thrust import Curve

if TYPE_CHECKING:
    from tipoff.mechanics.laws.pushers import Pushers

_CELLS = 1000


class Pushed(NamedTuple):
    """The motion up to the end of the longest stroke, or up to standstill; k points."""

    time: np.ndarray  # (k,) s
    travel: np.ndarray  # (k,) m
    speed: np.ndarray  # (k,) m/s


def motion(pushers: "Pushers", gain: float, pull: float, begun: float) -> Pushed:
    """Motion from zero travel at the speed ``begun`` (m/s), with ``gain`` (1/kg) and ``pull``
    (m/s2). A payload that does not start stays where it is."""
    knots = pushers.travel
    # Closely spaced at the start, where the speed grows with the root of the travel.
    travel = np.unique(np.append(knots.max() * np.linspace(0.0, 1.0, _CELLS + 1) ** 2, knots))
    middle, steps = 0.5 * (travel[1:] + travel[:-1]), np.diff(travel)
    gained = np.cumsum((gain * net_force(pushers, middle, gain, pull) + pull) * steps)
    squares = max(begun, 0.0) ** 2 + 2.0 * np.concatenate([[0.0], gained])
    stands = np.flatnonzero(squares[1:] <= 0.0)
    count = stands[0] + 1 if stands.size else travel.size
    speed = np.sqrt(squares[:count])
    time = np.concatenate([[0.0], np.cumsum(2.0 * steps[: count - 1] / (speed[1:] + speed[:-1]))])
    return Pushed(time, travel[:count], speed)


def net_force(pushers: "Pushers", s: np.ndarray, gain: float, pull: float) -> np.ndarray:
    """Force (n,) N of all springs on the payload at the travel ``s`` (n,) m, up to their strokes."""
    total, moving = np.zeros(np.shape(s)), np.zeros(np.shape(s))
    for travel, force, held, mass in each(pushers):
        pushes = s <= travel[-1]
        total += np.where(pushes, np.interp(s, travel, force) - held, 0.0)
        moving += np.where(pushes, mass, 0.0)
    return (total - moving * pull) / (1.0 + gain * moving)


def each(pushers: "Pushers") -> Iterator[tuple[np.ndarray, np.ndarray, float, float]]:
    """Travel (k,) m and force (k,) N at the knots, friction (N) and moving mass (kg) of each pusher."""
    for i, (first, after) in enumerate(pairwise(pushers.first)):
        mass = pushers.mass[i] if pushers.mass.size else 0.0
        yield pushers.travel[first:after], pushers.force[first:after], pushers.friction[i], mass


def energy(pushers: "Pushers") -> float:
    """Energy (J) of all springs over their strokes, less the loss by the friction of their pushers."""
    given = float(sum(pushers.energy[pushers.first[1:] - 1]))
    lost = float(sum(held * travel[-1] for travel, _, held, _ in each(pushers)))
    return given - lost


def over_time(pushers: "Pushers", gain: float, pull: float, begun: float) -> Curve:
    """Sum of all forces (N) over time (s) in this motion; of n >= 2 points."""
    found = motion(pushers, gain, pull, begun)
    before = net_force(pushers, found.travel, gain, pull)
    after = net_force(pushers, np.nextafter(found.travel, np.inf), gain, pull)
    jumps = before != after
    times = np.repeat(found.time, 1 + jumps)
    forces = np.repeat(before, 1 + jumps)
    forces[np.cumsum(1 + jumps)[jumps] - 1] = after[jumps]
    if times.size < 2:
        return Curve(np.array([0.0, 1.0]), np.zeros(2))
    return Curve(times, forces)


def impulses(pushers: "Pushers", gain: float, pull: float, begun: float) -> np.ndarray:
    """Impulse (n,) N s of each spring in this motion."""
    found = motion(pushers, gain, pull, begun)
    middle = 0.5 * (found.travel[1:] + found.travel[:-1])
    gained = gain * net_force(pushers, middle, gain, pull) + pull
    return np.array(
        [
            np.where(
                middle <= travel[-1],
                np.interp(middle, travel, force) - held - mass * gained,
                0.0,
            )
            @ np.diff(found.time)
            for travel, force, held, mass in each(pushers)
        ]
    )
