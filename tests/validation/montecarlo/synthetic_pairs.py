"""Two models of a known population: a biased surrogate, and a reference that is correlated with it.

u and v are standard normal with correlation r. Normal: y = 1 + 2 v, x = 1.3 + 1.5 u. Exponential:
y and x - 0.2 over 1.3 are -ln(1 - Phi(.)) of v and u, so y has the mean and the standard deviation
one and the quantile -ln(1 - p)."""

import math
from collections.abc import Iterator

import numpy as np
from scipy import stats

from validation.montecarlo.control_variate import Pairs


class Normal:
    """Mean 1, standard deviation 2."""

    mean, sd = 1.0, 2.0

    @staticmethod
    def quantile(share: float) -> float:
        return 1.0 + 2.0 * float(stats.norm.ppf(share))

    @staticmethod
    def models(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return 1.3 + 1.5 * u, 1.0 + 2.0 * v


class Exponential:
    """Mean 1, standard deviation 1."""

    mean, sd = 1.0, 1.0

    @staticmethod
    def quantile(share: float) -> float:
        return -math.log1p(-share)

    @staticmethod
    def models(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return 0.2 - 1.3 * stats.norm.logsf(u), -stats.norm.logsf(v)


def repetitions(
    law, correlation: float, runs: int, cases: int, count: int, seed: int = 1
) -> Iterator[Pairs]:
    """``count`` independent studies of ``runs`` draws among ``cases``."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        u, other = random.normal(size=cases), random.normal(size=runs)
        v = correlation * u[:runs] + math.sqrt(1.0 - correlation**2) * other
        surrogate, reference = law.models(u, v)
        yield Pairs(reference, surrogate[:runs], surrogate)


def covered(bounds, truth: float) -> float:
    """Share of the pairs ``bounds`` that contain the ``truth``; a bound None is infinite."""
    inside = [
        (low is None or low <= truth) and (high is None or truth <= high) for low, high in bounds
    ]
    return sum(inside) / len(inside)
