"""Sobol' indices of a model on independent inputs, by the points of Saltelli and the estimators of
SALib.

With V the variance of y over all inputs, x_i one of them and x_~i all others::

    first order  S_i = V[E(y | x_i)] / V           share of the variance that x_i causes alone
    total        T_i = E[V(y | x_~i)] / V           its share with all interactions

n base points take n (d + 2) cases: A, A with column i from B for each of the d inputs, and B. S_i is
estimated by mean(B (A_B,i - A))/V and T_i by mean((A - A_B,i)^2)/(2 V) (Saltelli et al., Comput. Phys.
Commun. 181, 2010); their intervals come from a bootstrap over base points. The points are a scrambled
Sobol' sequence; its first half is a Sobol' sequence too.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

CONFIDENCE = 0.95
RESAMPLES = 200
_EDGE = 2.0**-53  # a normal distribution has no finite quantile at 0 and 1


@dataclass(frozen=True, kw_only=True)
class Indices:
    """First-order and total indices (d,) with half widths of their 95 % intervals (d,), and the
    number of base points used."""

    first: tuple[float, ...]
    first_half_width: tuple[float, ...]
    total: tuple[float, ...]
    total_half_width: tuple[float, ...]
    points: int


def points(count: int, inputs: int, seed: int) -> np.ndarray:
    """Points (count (inputs + 2), inputs) of the open unit cube; ``count`` a power of two, ``seed``
    above zero."""
    from SALib.sample import sobol

    return np.clip(
        sobol.sample(_problem(inputs), count, calc_second_order=False, seed=seed),
        _EDGE,
        1.0 - _EDGE,
    )


def whole_blocks(settled: np.ndarray, inputs: int) -> np.ndarray:
    """Whether all d + 2 cases of each base point (n,) settled; ``settled`` (n (d + 2),)."""
    return np.all(settled.reshape(-1, inputs + 2), axis=1)


def indices(
    values: np.ndarray, inputs: int, seed: int, resamples: int = RESAMPLES
) -> Indices | None:
    """Indices of a result ``values`` (n (inputs + 2),) at the points of ``points``; None if it does
    not vary.

    A base point with NaN in one of its cases is left out: the estimators need all its cases.
    """
    from SALib.analyze import sobol

    blocks = values.reshape(-1, inputs + 2)
    blocks = blocks[whole_blocks(np.isfinite(values), inputs)]
    if len(blocks) < 2 or np.ptp(blocks) <= 1e-12 * np.abs(blocks).max():
        return None
    found = sobol.analyze(
        _problem(inputs),
        blocks.ravel(),
        calc_second_order=False,
        num_resamples=resamples,
        conf_level=CONFIDENCE,
        seed=seed,
    )
    return Indices(
        first=tuple(map(float, found["S1"])),
        first_half_width=tuple(map(float, found["S1_conf"])),
        total=tuple(map(float, found["ST"])),
        total_half_width=tuple(map(float, found["ST_conf"])),
        points=len(blocks),
    )


def sum_half_width(
    values: np.ndarray, inputs: int, seed: int, resamples: int = RESAMPLES
) -> float | None:
    """Half width of the 95 % interval of the sum of the first-order indices, by a bootstrap over base
    points; None as for ``indices``. The indices share their base points, so that the half widths of each
    do not give that of their sum."""
    blocks = values.reshape(-1, inputs + 2)
    blocks = blocks[whole_blocks(np.isfinite(values), inputs)]
    if len(blocks) < 2 or np.ptp(blocks) <= 1e-12 * np.abs(blocks).max():
        return None
    blocks = blocks - blocks[:, [0, -1]].mean()
    first, last = blocks[:, 0], blocks[:, -1]
    shares = last * (blocks[:, 1:-1].sum(axis=1) - inputs * first)
    chosen = np.random.default_rng(seed).integers(len(blocks), size=(resamples, len(blocks)))
    variance = np.var(np.concatenate([first[chosen], last[chosen]], axis=1), axis=1)
    sums = shares[chosen].mean(axis=1) / np.maximum(variance, np.finfo(float).tiny)
    return float(norm.ppf(0.5 + 0.5 * CONFIDENCE) * sums.std(ddof=1))


def _problem(inputs: int) -> dict[str, Any]:
    return {
        "num_vars": inputs,
        "names": [f"x{number}" for number in range(inputs)],
        "bounds": [[0.0, 1.0]] * inputs,
    }
