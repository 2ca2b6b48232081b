"""Mean and standard deviation of a population from few runs of the reference, with the surrogate as
control variate.

The reference gives y on n draws. The surrogate gives x on the same n draws and on N >= n draws.

    mean    m = mean_n(y) + b (mean_N(x) - mean_n(x)),            b = cov(y, x) / var(x)
    spread  ln s = ln s_n(y) + c (ln s_N(x) - ln s_n(x)),         c as b for the squared deviations
    variance of m: [1 - (1 - n/N) r^2] var(y) / n,                r the correlation of y and x

b is the optimal coefficient (Ng and Willcox, Int. J. Numer. Methods Eng. 100 (2014) 746). The logarithm
keeps the standard deviation positive. Intervals: the variance of the n draws by the jackknife, which
includes the error of b; the variance of the N draws by the delta method; Student's t.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

FEWEST = 4  # draws; a coefficient and a variance need three


class Pairs(NamedTuple):
    """A quantity of the ``reference`` (n,) and of the ``surrogate`` (n,) on the same draws, and of
    the surrogate on a ``population`` (N,) of independent draws that contains them; n >= FEWEST."""

    reference: np.ndarray
    surrogate: np.ndarray
    population: np.ndarray


@dataclass(frozen=True)
class Estimate:
    """The corrected ``value`` with its bounds ``low`` and ``high``; the same from the reference
    alone, ``plain`` with ``plain_low`` and ``plain_high``; ``surrogate``, the uncorrected value of
    the population. None if it does not exist."""

    value: float
    low: float | None
    high: float | None
    plain: float | None
    plain_low: float | None
    plain_high: float | None
    surrogate: float


def correlation(one: np.ndarray, other: np.ndarray) -> float | None:
    """Correlation of two columns (n,); None if one is constant."""
    spread = one.std() * other.std()
    if not spread > 0.0:
        return None
    return float(((one - one.mean()) * (other - other.mean())).mean() / spread)


def equivalent_runs(found: Estimate, runs: int) -> float | None:
    """Number of runs of the reference alone that would give an interval as narrow as that of
    ``found`` from ``runs``, since widths are proportional to 1/sqrt(n). None without both
    intervals."""
    width, plain = _width(found.low, found.high), _width(found.plain_low, found.plain_high)
    return runs * (plain / width) ** 2 if width and plain is not None else None


_Bounds = tuple[float | None, float | None]


def _estimate(
    value: float, bounds: _Bounds, plain: float, plain_bounds: _Bounds, surrogate: float
) -> Estimate:
    low, high = bounds
    plain_low, plain_high = plain_bounds
    return Estimate(
        value,
        low,
        high=high,
        plain=plain,
        plain_low=plain_low,
        plain_high=plain_high,
        surrogate=surrogate,
    )


def _width(low: float | None, high: float | None) -> float | None:
    return None if low is None or high is None else high - low


def mean(pairs: Pairs, confidence: float = 0.95) -> Estimate:
    """The mean."""
    reference, surrogate, population = pairs
    far, plain = float(population.mean()), float(reference.mean())
    coefficient = float(_slope(reference, surrogate))
    error = coefficient**2 * float(population.var()) / population.size

    def corrected(own: np.ndarray, beside: np.ndarray) -> np.ndarray:
        return _mean(own)[..., 0] + _slope(own, beside) * (far - _mean(beside)[..., 0])

    corrected_bounds = _interval(corrected, pairs, error, confidence)
    bounds = _interval(lambda own, _: _mean(own)[..., 0], pairs, 0.0, confidence)
    value = float(corrected(reference, surrogate))
    return _estimate(value, corrected_bounds, plain, bounds, far)


def standard_deviation(pairs: Pairs, confidence: float = 0.95) -> Estimate:
    """The standard deviation. If it is zero in the reference, it has no interval. If it is zero in
    the surrogate, it is not corrected."""
    reference, surrogate, population = pairs
    far, plain = (float(values.std(ddof=1)) for values in (population, reference))
    if not plain > 0.0:
        return _estimate(0.0, (None, None), 0.0, (None, None), far)

    def logarithm(own: np.ndarray, _: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log(own.std(axis=-1, ddof=1))

    def corrected(own: np.ndarray, beside: np.ndarray) -> np.ndarray:
        share = _slope(_squares(own), _squares(beside))
        return logarithm(own, own) + share * (math.log(far) - logarithm(beside, beside))

    plain_bounds = _exponentials(_interval(logarithm, pairs, 0.0, confidence))
    if not (far > 0.0 and surrogate.std() > 0.0):
        return _estimate(plain, plain_bounds, plain, plain_bounds, far)
    share = float(_slope(_squares(reference), _squares(surrogate)))
    squares = (population - population.mean()) ** 2
    error = share**2 * float(squares.var()) / (4.0 * far**4 * population.size)
    bounds = _exponentials(_interval(corrected, pairs, error, confidence))
    value = math.exp(corrected(reference, surrogate))
    return _estimate(value, bounds, plain, plain_bounds, far)


def _exponentials(bounds: tuple[float, float]) -> _Bounds:
    """None in place of infinite bounds, which occur if a single draw differs from all others."""
    low, high = (math.exp(each) if math.isfinite(each) else None for each in bounds)
    return low, high


def _mean(values: np.ndarray) -> np.ndarray:
    return values.mean(axis=-1, keepdims=True)


def _slope(values: np.ndarray, control: np.ndarray) -> np.ndarray:
    """Coefficient of the regression of (..., n) on (..., n); zero where the control is constant."""
    moved = control - _mean(control)
    square, product = (moved * moved).sum(axis=-1), (moved * (values - _mean(values))).sum(axis=-1)
    return np.divide(product, square, out=np.zeros_like(square), where=square > 0.0)


def _squares(values: np.ndarray) -> np.ndarray:
    """Squared deviations over their mean; zero if all values are equal."""
    squares = (values - _mean(values)) ** 2
    mean_square = np.broadcast_to(_mean(squares), squares.shape)
    return np.divide(squares, mean_square, out=np.zeros_like(squares), where=mean_square > 0.0)


def _interval(
    statistic: Callable[[np.ndarray, np.ndarray], np.ndarray],
    pairs: Pairs,
    error: float,
    confidence: float,
) -> tuple[float, float]:
    """Bounds of a ``statistic`` of the reference and the surrogate (..., n), by the jackknife, with
    a further variance ``error``."""
    count = pairs.reference.size
    others = ~np.eye(count, dtype=bool)
    without_each = [
        np.broadcast_to(values, (count, count))[others].reshape(count, count - 1)
        for values in (pairs.reference, pairs.surrogate)
    ]
    value = float(statistic(pairs.reference, pairs.surrogate))
    with np.errstate(invalid="ignore"):
        variance = (count - 1) * float(statistic(*without_each).var()) + error
    half = float(student.ppf(0.5 * (1.0 + confidence), count - 2)) * math.sqrt(variance)
    return value - half, value + half
