"""The 95 % range of rates, speed and time of a launch under the random errors that its scene states.

The ends are the 2.5 and 97.5 % quantiles of independent cases of compliant contact. Half the distance of
the 95 % bounds of an end, as a share of the range, is 1.35 / sqrt(n) for n cases of a normal distribution
and 2.2 / sqrt(n) for a half normal one: 4,000 cases give 2 to 4 %. If it is above 5 % for a rate, 16,000
cases are drawn instead. The page states the accuracy.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tipoff.comparison import order_statistics
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes import halving, uncertainty
from tipoff.scenes.scene import Scene
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.answers import Quantity
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.workspace.study import Study

SHARES = (0.025, 0.975)
CASES = (4000, 16_000)  # the second if the first is not accurate enough
ACCURACY = 0.05  # largest half distance of the bounds of an end, as a share of the range of a rate
_CONFIDENCE = 0.95
_FEWEST = 100  # settled cases: fewer give no 2.5 % quantile


def _speed(found: Any) -> np.ndarray:
    return found.velocity[:, 0]


def _time(found: Any) -> np.ndarray:
    return 1e3 * found.exit_time


SPEED = Quantity("velocity_x_m_s", "velocity along X", "m/s", _speed)
TIME = Quantity("exit_time_ms", "time of the exit", "ms", _time)
_RATES = (answers.TOTAL_RATE, *answers.RATES)
QUANTITIES = (*_RATES, SPEED, TIME)


@dataclass(frozen=True, kw_only=True)
class Range:
    """Both ends, each with its 95 % bounds; a bound is None if the cases are too few."""

    low: float
    high: float
    low_bounds: tuple[float | None, float | None]
    high_bounds: tuple[float | None, float | None]

    @property
    def doubt(self) -> float:
        """Half the distance of the bounds of the worse end, as a share of the range; infinite if an
        end lacks a bound, zero if all values are equal."""
        width, worst = self.high - self.low, 0.0
        for low, high in (self.low_bounds, self.high_bounds):
            if low is None or high is None:
                return math.inf
            worst = max(worst, high - low)
        return 0.5 * worst / width if width > 0.0 else 0.0


@dataclass(frozen=True, kw_only=True)
class Spread:
    """``errors``: the file of distributions as named in the scene; ``sizes``: 95 % of the values of each
    tolerance (``scenes.halving``); ``at``: the instant of velocity and rates; ``ranges`` by the names of
    ``QUANTITIES``, None if fewer than 100 of the ``cases`` settled."""

    errors: str
    sizes: dict[str, str]
    seed: int
    cases: int
    settled: int
    model: str
    at: str
    shares: tuple[float, float]
    ranges: dict[str, Range] | None
    store: str


def of_scene(study: Study, scene: Scene) -> Spread | None:
    """Ranges of ``QUANTITIES`` of ``scene`` by compliant contact, at the exit or settled by the rule of
    ``mechanics.instant``; None if the scene states no errors.

    Raises SceneError for distributions that do not fit the scene, StudyError when the store fails.
    """
    if (stated := uncertainty.of_scene(scene)) is None:
        return None
    model = Surrogate(scene, None, study.rail_compliance(scene)).watched(None)
    for cases in CASES:
        asked = Drawn(stated._replace(cases=cases, sampling="random"))
        found = population.run(study, "errors", model, asked)
        ranges = _ranges(found)
        if ranges is None or all(ranges[item.name].doubt <= ACCURACY for item in _RATES):
            break
    assert scene.studies is not None and scene.studies.errors is not None
    return Spread(
        errors=scene.studies.errors,
        sizes=halving.sizes(stated),
        seed=stated.seed,
        cases=cases,
        settled=int(found.settled.sum()),
        model=COMPLIANT,
        at=model.instant.at,
        shares=SHARES,
        ranges=ranges,
        store=found.store,
    )


def _ranges(found: Population) -> dict[str, Range] | None:
    if (settled := found.settled).sum() < _FEWEST:
        return None
    return {item.name: range_of(item.of(found.results)[settled]) for item in QUANTITIES}


def range_of(values: np.ndarray) -> Range:
    """The 2.5 and 97.5 % quantiles of independent ``values`` (n,)."""
    low, high = np.quantile(values, SHARES).tolist()
    of_low, of_high = (order_statistics.bounds(values, share, _CONFIDENCE) for share in SHARES)
    return Range(low=low, high=high, low_bounds=of_low, high_bounds=of_high)
