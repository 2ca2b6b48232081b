"""A run of the surrogate reduced to what residuals are made of: a posterior takes thousands, and nobody reads their ledgers."""

from typing import NamedTuple

import numpy as np

from lowfi import balance
from lowfi.numerics import Numerics
from lowfi.run import Run, improved
from scenes import comoving, outcome
from scenes.scene import Scene
from scenes.walls import Walls


class Motion(NamedTuple):
    """As in Trajectory: status, time (n,) s, velocity (n,3) m/s, rate (n,3) rad/s, outcome."""

    status: str
    time: np.ndarray
    velocity: np.ndarray
    rate: np.ndarray
    outcome: outcome.Outcome


def run(scene: Scene, numerics: Numerics | None = None, walls: Walls | None = None) -> Motion:
    """The motion of ``lowfi.run``, to the last bit."""
    going = Run(scene, numerics or Numerics(), walls)
    going.begin()
    going.march(None)
    going = improved(going)
    moved, seen_from = balance.motion(going.rows[:going.taken], 0, going.interval), comoving.frame(going.model)
    diverged = going.message or not going.keeps_ledgers()
    status, result = ("diverged", outcome.Outcome()) if diverged else outcome.judge(moved, going.marks)
    result, moved = comoving.outcome(seen_from, result, going.interval), comoving.motion(seen_from, moved)
    return Motion(status, moved.time, moved.velocity, moved.rate, result)
