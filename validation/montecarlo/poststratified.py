"""Probabilities and quantiles of a population from few runs of the reference, with the surrogate's
answer as stratum.

An event has the indicator a in the reference and b in the surrogate. The surrogate's N draws give the
weights of the strata, the n draws of both the probability of the event in each:

    p = W_1 P(a | b = 1) + W_0 P(a | b = 0),     W_1 = share of b = 1 among the N draws

This is the control variate mean_n(a) + c (mean_N(b) - mean_n(b)) with the optimal coefficient c = P(a | b
= 1) - P(a | b = 0). Each conditional probability has the interval of Wilson (J. Am. Stat. Assoc. 22
(1927) 209), and the sum that of Zou and Donner (Statistics in Medicine 27 (2008) 1693), the recovery of
variances. So an interval has a width above zero even if both models agree on all n draws, and it is that
of Wilson if the surrogate explains nothing. A stratum without a draw keeps the surrogate's answer and the
interval 0 to 1.

The distribution function is corrected in the same way. A quantile is the value at which it reaches the
share. The bounds of the quantile are the values at which the bounds of the function reach the share
(Woodruff, J. Am. Stat. Assoc. 47 (1952) 635).
"""

from typing import NamedTuple

import numpy as np
from scipy.stats import norm

from validation.montecarlo.control_variate import Estimate, Pairs

_GRID = 2000  # values of the population at which its distribution function is corrected


class _Counts(NamedTuple):
    """Events and draws (m,)."""

    events: np.ndarray
    draws: np.ndarray


def probability(
    reference: np.ndarray, surrogate: np.ndarray, share: float, cases: int, confidence: float = 0.95
) -> Estimate:
    """Probability of an event from its indicators (n,) in both models, with its ``share`` in the
    ``cases`` of the population."""
    inside, outside = (
        _Counts(np.array([reference[part].sum()]), np.array([part.sum()]))
        for part in (surrogate, ~surrogate)
    )
    found = _combined(inside, outside, np.array([share]), cases, confidence)
    alone = wilson(inside.events + outside.events, inside.draws + outside.draws, confidence)
    value, low, high, plain, plain_low, plain_high = (float(each[0]) for each in (*found, *alone))
    return Estimate(
        value,
        low,
        high=high,
        plain=plain,
        plain_low=plain_low,
        plain_high=plain_high,
        surrogate=share,
    )


def quantile(pairs: Pairs, share: float, confidence: float = 0.95) -> Estimate:
    """The quantile ``share``; a bound is None if the draws are too few."""
    reference, ordered = np.sort(pairs.reference), np.sort(pairs.population)
    steps = np.linspace(0.0, 1.0, _GRID)
    grid = np.unique(np.concatenate([reference, np.quantile(ordered, steps)]))
    below = pairs.reference[:, None] <= grid
    beside = pairs.surrogate[:, None] <= grid
    inside, outside = (
        _Counts((below & part).sum(axis=0), part.sum(axis=0)) for part in (beside, ~beside)
    )
    weights = np.searchsorted(ordered, grid, side="right") / ordered.size
    corrected = _combined(inside, outside, weights, ordered.size, confidence)
    value, high, low = (_crossing(grid, function, share) for function in corrected)
    plain, plain_high, plain_low = (
        _crossing(grid, function, share)
        for function in wilson(below.sum(axis=0), inside.draws + outside.draws, confidence)
    )
    assert value is not None  # the function is one at the largest value
    return Estimate(
        value,
        low,
        high=high,
        plain=plain,
        plain_low=plain_low,
        plain_high=plain_high,
        surrogate=float(np.quantile(ordered, share)),
    )


def wilson(
    count: np.ndarray, cases: np.ndarray, confidence: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shares ``count`` / ``cases`` (m,) with their bounds; without cases NaN, 0 and 1."""
    square = float(norm.ppf(0.5 * (1.0 + confidence))) ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        share = count / cases
        middle = (count + 0.5 * square) / (cases + square)
        half = np.sqrt(square * (count * (1.0 - share) + 0.25 * square)) / (cases + square)
    empty = cases == 0
    return (
        share,
        np.where(empty, 0.0, np.clip(middle - half, 0.0, 1.0)),
        np.where(empty, 1.0, np.clip(middle + half, 0.0, 1.0)),
    )


def _combined(
    inside: _Counts, outside: _Counts, weight: np.ndarray, cases: int, confidence: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Probabilities (m,) with bounds from the draws ``inside`` the stratum of the surrogate's event,
    whose ``weight`` (m,) is from the ``cases`` of the population, and ``outside``."""
    within, low, high = wilson(*inside, confidence)
    beyond, least, most = wilson(*outside, confidence)
    within = np.where(inside.draws == 0, 1.0, within)
    beyond = np.where(outside.draws == 0, 0.0, beyond)
    other, normal = 1.0 - weight, float(norm.ppf(0.5 * (1.0 + confidence)))
    value = weight * within + other * beyond
    drawn = (normal * (within - beyond)) ** 2 * weight * other / cases
    down = np.sqrt((weight * (within - low)) ** 2 + (other * (beyond - least)) ** 2 + drawn)
    up = np.sqrt((weight * (high - within)) ** 2 + (other * (most - beyond)) ** 2 + drawn)
    return value, np.clip(value - down, 0.0, 1.0), np.clip(value + up, 0.0, 1.0)


def _crossing(grid: np.ndarray, function: np.ndarray, share: float) -> float | None:
    """The smallest value of the ``grid`` (m,) at which a ``function`` (m,) reaches ``share``; None
    if it does not."""
    reached = np.flatnonzero(function >= share)
    return float(grid[reached[0]]) if reached.size else None
