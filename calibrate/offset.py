"""Offset in time of measured curves: y(t) = f(t - offset).

v_x during the thrust determines the offset, because contact hardly changes v_x. The offset is found
by least squares of v_x, first on a grid. Its uncertainty contains noise and model error
(``discrepancy``).
"""

from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.discrepancy import VELOCITY, Curve, deviations, likeliest
from tipoff.calibration.objective import Target, sampled
from tipoff.calibration.refine import STEP, UNIT
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import launch

_GRID = 201
_LEVEL = 1.96  # standard deviations of a 95 % interval


class Offset(NamedTuple):
    """Offset of curves in time."""

    value: float  # s, positive for late curves
    half: float  # s, half width of its 95 % interval
    step: float  # s, median step of the samples

    @property
    def is_seen(self) -> bool:
        """Whether it is larger than its uncertainty and than a sample interval."""
        return abs(self.value) > max(self.half, self.step)

    def words(self, name: str) -> str:
        """A sentence on a condition ``name``."""
        late = "late" if self.value > 0.0 else "early"
        return f"the curves of {name} are {1e3 * abs(self.value):.4g} +- {1e3 * self.half:.2g} ms {late}"


def estimate(wanted: Target, run: Trajectory) -> Offset:
    """The offset of the curves ``wanted`` from a run, at most the duration of the thrust in both
    directions."""
    (limit,) = thrust.burnouts(
        ends.over_time(launch.of_scene(wanted.scene)), (1e-3,), wanted.scene.time_limit
    )
    limit = float(min(limit, 0.5 * wanted.time[-1]))

    def squares(offset: float) -> float:
        left = wanted.velocity - sampled(run, wanted.time - offset)[:, 0]
        return float(wanted.weights @ left**2)

    grid = np.linspace(-limit, limit, _GRID)
    best = int(np.argmin([squares(value) for value in grid]))
    around = grid[max(best - 1, 0)], grid[min(best + 1, _GRID - 1)]
    value = float(
        scipy.optimize.minimize_scalar(
            squares, bounds=around, method="bounded", options={"xatol": 1e-9}
        ).x
    )
    if squares(0.0) <= squares(value):
        value = 0.0
    step = UNIT * STEP
    ahead, own, behind = (
        sampled(run, wanted.time - value - shift)[:, 0] for shift in (step, 0.0, -step)
    )
    size = wanted.amplitudes[0] / np.sqrt(wanted.weights.sum())
    slope = ((ahead - behind) / (2.0 * STEP))[:, None]
    curve = Curve(wanted.time, wanted.velocity - own, slope, float(size), VELOCITY)
    deviation = deviations([curve], likeliest([curve]), np.eye(1))[1][0]
    return Offset(value, _LEVEL * UNIT * float(deviation), step_of(wanted))


def step_of(wanted: Target) -> float:
    """Median step (s) of the samples."""
    return float(np.median(np.diff(wanted.time)))
