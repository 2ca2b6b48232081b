"""Finds stretches in which a channel repeats one value more often than its noise allows: a frozen
sensor, or a logger that holds its last sample.

The noise of a sample has the standard deviation sigma given the samples before, and values are rounded
to a step q. Whatever the motion, the next sample falls into the step of this one with a probability of
at most p = erf(q / (2 sqrt(2) sigma)), because no interval of length q has more of a normal distribution
than the one about its middle. So among n samples the expected number of runs of L equal samples is at
most n p^(L-1). A run is frozen if this bound is below 1e-9.

Samples of a slow sensor are correlated or repeated. Then only one sample in m is new, and the exponent is
L/m - 1. The lag m is the shortest one beyond which the mean square difference D(m) of samples no longer
grows. The mean difference, which is the slope, is left out; a block whose D grows at all lags moves too
much to show its noise.

A quiet sensor, with a noise below its step, repeats its values too. So sigma must be too small rather
than too large: D is at most 2 sigma^2 + q^2/2, and the smallest sigma of all blocks outside the run
counts, because the payload also shakes. A channel that is frozen from the first sample to the last has no
such block. The axes of one unit are alike: sigma is at least a fifth of that of the others. Noise below
about one step does not show, and a log of a few hundred samples has too few blocks: then no run is
called frozen.
"""

from math import ceil, erf, log, sqrt
from typing import NamedTuple

import numpy as np

from tipoff.studies.measured.quantisation import steps

_CHANCE = 1e-9  # expected number of runs of a working channel that are called frozen
_BLOCK, _EVERY = 64, 16  # samples in which sigma is judged, and from block to block
_BLOCKS = 12  # a single step in a few blocks looks like noise
_LAGS = (1, 2, 4, 8)
_GROWS = 1.5  # ratio of D at twice the lag; a random walk has 2, a ramp 4
_ALIKE = 5.0  # ratio of the noise of two axes, at most
_LEAST = 0.02  # probability of an equal sample, at least: loggers repeat single samples


class Run(NamedTuple):
    """Equal samples ``begin`` to ``end``, one past the last, of channel ``axis``; ``allowed``: equal
    samples in a row that its noise allows."""

    axis: int
    begin: int
    end: int
    allowed: int


def frozen(values: np.ndarray, resolution: float = 0.0) -> list[Run]:
    """Stretches of samples (n,k) of the axes of one sensor in which an axis is frozen;
    ``resolution`` is its stated step, in the same unit. Raises nothing."""
    step = steps(values, resolution)
    noise = [_noise(column, one) for column, one in zip(values.T, step)]
    lag, count = max(map(_lag, noise), default=1), len(values)
    found = []
    for axis, column in enumerate(values.T):
        alike = min((_least(each[0]) for k, each in enumerate(noise) if k != axis), default=0.0)
        sigma, runs = noise[axis][0], _runs(column)
        long = runs[runs[:, 1] - runs[:, 0] > _most(_LEAST, lag, count)]
        if not len(long):
            continue
        before, after = _least_up_to(sigma), _least_up_to(sigma[::-1])
        shown = np.concatenate([[0], np.cumsum(np.isfinite(sigma))])
        for begin, end in long.tolist():
            first, last = _inside(begin, end, len(sigma))
            own = min(before[first], after[len(sigma) - last])
            if shown[first] + shown[-1] - shown[last] < _BLOCKS:
                own = 0.0
            allowed = _allowed(max(own, alike / _ALIKE), lag, float(step[axis]), count)
            if allowed is not None and end - begin > allowed:
                found.append(Run(axis, begin, end, allowed))
    return found


def _allowed(sigma: float, lag: int, step: float, count: int) -> int | None:
    """Equal samples in a row that are no fault; None for any number."""
    same = erf(step / (2.0 * sqrt(2.0) * sigma)) if sigma > 0.0 else 1.0
    return _most(max(same, _LEAST), lag, count) if same < 1.0 else None


def _most(same: float, lag: int, count: int) -> int:
    """Equal samples in a row that chance allows among ``count``, if the next new sample is equal
    with the probability ``same`` < 1."""
    return lag * ceil(1.0 + log(_CHANCE / count) / log(same))


def _noise(column: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """sigma (m,) and lag (m,) of the blocks in order; sigma is 0 in a quiet block, infinite in one
    that moves too much."""
    if len(column) < _BLOCK:
        return np.zeros(0), np.zeros(0, dtype=int)
    blocks = np.lib.stride_tricks.sliding_window_view(column, _BLOCK)[::_EVERY]
    square = [np.var(blocks[:, m:] - blocks[:, :-m], axis=1) for m in (*_LAGS, 2 * _LAGS[-1])]
    sigma = np.where(square[0] > 0.5 * step**2, np.inf, 0.0)
    lags = np.ones(len(blocks), dtype=int)
    for m, here, further in reversed(list(zip(_LAGS, square, square[1:]))):
        ends = further <= _GROWS * here
        excess = np.maximum(0.5 * here - 0.25 * step**2, 0.0)
        sigma, lags = np.where(ends, np.sqrt(excess), sigma), np.where(ends, m, lags)
    return sigma, lags


def _least(sigma: np.ndarray) -> float:
    """The least sigma of blocks; 0 where too few of them show their noise."""
    shown = sigma[np.isfinite(sigma)]
    return float(shown.min()) if len(shown) >= _BLOCKS else 0.0


def _least_up_to(sigma: np.ndarray) -> np.ndarray:
    """The least sigma (m+1,) of the first 0 to m blocks; infinite where none shows its noise."""
    return np.minimum.accumulate(np.concatenate([[np.inf], sigma]))


def _lag(noise: tuple[np.ndarray, np.ndarray]) -> int:
    """The usual lag of blocks that show their noise."""
    sigma, lags = noise
    shown = np.sort(lags[(sigma > 0.0) & np.isfinite(sigma)])
    return int(shown[len(shown) // 2]) if len(shown) else 1


def _inside(begin: int, end: int, count: int) -> tuple[int, int]:
    """First and one past the last of ``count`` blocks of which more than half is in a run."""
    first = max(0, (begin - _BLOCK // 2) // _EVERY + 1)
    last = min(count, -(-(end - _BLOCK // 2) // _EVERY))
    return (first, last) if last > first else (count, count)


def _runs(column: np.ndarray) -> np.ndarray:
    """First and one past the last (k,2) of every stretch of equal samples."""
    edges = np.flatnonzero(np.diff(column) != 0.0) + 1
    bounds = np.concatenate([[0], edges, [len(column)]])
    return np.column_stack([bounds[:-1], bounds[1:]])
