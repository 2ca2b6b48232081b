"""Whether two models give one distribution of settled rates: equivalence of quantiles.

Both models run the same n draws; the surrogate runs m further ones, which cost nothing. For each rate
and each share p of ``SHARES``

    D = b S + (1 - b) S' - R         b = (cov(R, S) + var S') / (var S + var S')

R and S are the Harrell-Davis estimates of the quantile from the n draws. S' is the estimate of the
surrogate from the further draws. b = 1 compares draw by draw, which is best if the rates of the models
correlate. b = 0 compares two samples, which is best if chaos removes the correlation. This b has the
smallest variance (control variate).

The margin is the limit of agreement of the settled rates or, if larger, ``MARGIN_SHARE`` of the distance
between the 10 and 90 % quantiles of the reference: such a difference is small beside the effect of 1 um.
A normal distribution that is shifted by this margin differs from the reference by at most 0.25 in any
probability. Bounds of D / margin are percentiles of the bootstrap over draws, expanded for small n, so
they include the uncertainty of the margin.

* **agrees**: all bounds lie within -1 and 1: two one-sided tests, and the intersection of all of them.
* **misses**, for one of two reasons. A bound shows a difference above the margin, at a level divided by
  the number of quantiles, and the draws are enough for bounds of the quantile. Or agreement is not shown
  although the interval of every quantile of the reference is narrower than ``KNOWN`` margins: equal
  distributions then agree in nine of ten trials (some 140 independent draws).
* **cannot be judged**: neither is shown, and some quantile of the reference is less well known.

Sources: Harrell and Davis, Biometrika 69 (1982) 635; Wilcox et al., Behav. Res. Methods 46 (2014)
1002 (bootstrap of quantiles of dependent groups); Hesterberg and Nelson, Management Science 44 (1998)
1295 (control variates for quantiles); Hesterberg, Am. Stat. 69 (2015) 371 (expanded percentiles);
Schuirmann, J. Pharmacokin. Biopharm. 15 (1987) 657, and Berger, Technometrics 24 (1982) 295 (two
one-sided tests, and their intersection).
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.comparison import order_statistics
from tipoff.studies.render.column import Column

SHARES = (0.1, 0.5, 0.9)
MARGIN_SHARE = 0.25
KNOWN = 0.7
CONFIDENCE = 0.95  # of each one-sided bound
AXES = ("x", "y", "z")
AGREES, MISSES, UNKNOWN = "agrees", "misses", "cannot be judged"
_REPLICATES = 2000
_SEED = 20261124


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One quantile ``share`` of the settled rate about ``axis``: values of both models, their
    difference D and the margin (deg/s); the one-sided bounds ``low`` and ``high`` of D and the
    ``width`` between the one-sided bounds of the reference's quantile, in margins; the weight b;
    whether a difference above the margin is ``shown``."""

    axis: Annotated[str, Column("rate")]
    share: Annotated[float, Column("quantile", "%", "g", 100.0)]
    reference_deg_s: Annotated[float, Column("reference", "deg/s")]
    surrogate_deg_s: Annotated[float, Column("surrogate", "deg/s")]
    difference_deg_s: float
    margin_deg_s: float
    low: Annotated[float, Column("difference, lower bound", "margins", "+.2g")]
    high: Annotated[float, Column("upper bound", "margins", "+.2g")]
    width: Annotated[float, Column("reference known within", "margins", ".2g")]
    weight: Annotated[float, Column("weight of pairs", form=".2f")]
    shown: bool

    @property
    def bound(self) -> float:
        """The largest size of the difference that the bounds allow, in margins."""
        return max(abs(self.low), abs(self.high))


def compare(
    reference: np.ndarray, surrogate: np.ndarray, further: np.ndarray, limit: float
) -> list[Comparison]:
    """Every quantile of every rate, from settled rates (n,3) deg/s of both models on the same
    draws, and (m,3) of the surrogate on others; ``limit`` (deg/s) is the smallest margin. Raises
    ValueError for fewer than two draws or draws without settled rates."""
    if len(reference) < 2 or not all(
        np.isfinite(part).all() for part in (reference, surrogate, further)
    ):
        raise ValueError("quantiles need two draws at least, all of them settled")
    generator = np.random.default_rng(_SEED)
    drawn = generator.integers(len(reference), size=(_REPLICATES, len(reference)))
    own, other = (harrell_davis(part[drawn]) for part in (reference, surrogate))  # (B, 3, q)
    apart = _resampled(further, generator)
    weight = _weights(own, other, apart)
    found, same, rest = (harrell_davis(part[None])[0] for part in (reference, surrogate, further))
    combined = weight * same + (1.0 - weight) * rest
    margins = _margin(own, limit)[..., None]
    ratios = (weight * other + (1.0 - weight) * apart - own) / margins
    level, count = 1.0 - CONFIDENCE, len(reference)
    low, high = np.quantile(ratios, _tails(level, count), axis=0)
    least, most = np.quantile(ratios, _tails(level / ratios[0].size, count), axis=0)
    below, above = np.quantile((own - found) / margins, _tails(level, count), axis=0)
    margin = _margin(found[None], limit)[0]
    return [
        Comparison(
            axis=axis,
            share=share,
            reference_deg_s=float(found[i, k]),
            surrogate_deg_s=float(combined[i, k]),
            difference_deg_s=float(combined[i, k] - found[i, k]),
            margin_deg_s=float(margin[i]),
            low=float(low[i, k]),
            high=float(high[i, k]),
            width=float(above[i, k] - below[i, k]),
            weight=float(weight[i, k]),
            shown=_enclosed(share, count) and bool(least[i, k] > 1.0 or most[i, k] < -1.0),
        )
        for i, axis in enumerate(AXES)
        for k, share in enumerate(SHARES)
    ]


def verdict(found: list[Comparison]) -> str:
    """``AGREES``, ``MISSES`` or ``UNKNOWN`` for all quantiles together."""
    if all(item.bound < 1.0 for item in found):
        return AGREES
    if any(item.shown for item in found) or all(item.width <= KNOWN for item in found):
        return MISSES
    return UNKNOWN


def needed(found: list[Comparison], draws: int) -> int:
    """How many draws make every interval of the reference as narrow as ``KNOWN``; the width is
    proportional to one over the root of the number. From few draws the result can be twice too
    large, because the margin is uncertain too."""
    return math.ceil(draws * max(1.0, *(item.width / KNOWN for item in found)) ** 2)


def harrell_davis(samples: np.ndarray) -> np.ndarray:
    """Estimates (b,c,q) of the quantiles ``SHARES`` from samples (b,n,c): means of the ordered values,
    weighted by the beta distribution of the place of the quantile among them."""
    count = samples.shape[1]
    places = np.arange(count + 1) / count
    steps = np.array(
        [
            np.diff(scipy.special.betainc((count + 1) * p, (count + 1) * (1.0 - p), places))
            for p in SHARES
        ]
    )
    return np.einsum("bnc,qn->bcq", np.sort(samples, axis=1), steps)


def _resampled(values: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """Replicates (B,c,q) of the quantiles of many values (m,c): the place of a quantile among them
    has a beta distribution, so values need no resampling."""
    count, ordered = len(values), np.sort(values, axis=0)
    places = np.stack(
        [
            generator.beta((count + 1) * p, (count + 1) * (1.0 - p), (_REPLICATES, values.shape[1]))
            for p in SHARES
        ],
        axis=-1,
    )
    grid = (np.arange(count) + 0.5) / count
    return np.stack(
        [np.interp(places[:, axis], grid, ordered[:, axis]) for axis in range(values.shape[1])],
        axis=1,
    )


def _tails(level: float, count: int) -> tuple[float, float]:
    """Shares of bootstrap replicates beyond one-sided bounds at a ``level``: smaller for few draws,
    because Student's t is wider than the normal distribution."""
    tail = float(
        scipy.special.ndtr(
            math.sqrt(count / (count - 1.0)) * scipy.special.stdtrit(count - 1, level)
        )
    )
    return tail, 1.0 - tail


def _enclosed(share: float, count: int) -> bool:
    """Whether ``count`` draws lie on both sides of a quantile with ``CONFIDENCE``. A bootstrap of
    fewer draws has no values beyond the quantile."""
    return count >= order_statistics.runs_needed(max(share, 1.0 - share), CONFIDENCE)


def _weights(own: np.ndarray, other: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """b (c,q) between 0 and 1; 0 if the surrogate does not vary."""
    covariance = ((own - own.mean(0)) * (other - other.mean(0))).mean(0)
    total = other.var(0) + apart.var(0)
    with np.errstate(invalid="ignore", divide="ignore"):
        weight = np.where(total > 0.0, (covariance + apart.var(0)) / total, 0.0)
    return np.clip(weight, 0.0, 1.0)


def _margin(quantiles: np.ndarray, limit: float) -> np.ndarray:
    """Margins (b,c) deg/s for quantiles (b,c,q) of the reference."""
    spread = quantiles[..., -1] - quantiles[..., 0]
    return np.maximum(limit, MARGIN_SHARE * spread)
