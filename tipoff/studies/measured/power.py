"""Power of the statement "all tests lie inside the range of the simulations": how often correct and wrong
models pass.

k tests and n simulated cases of one distribution are exchangeable. So both ends of the range of all n + k
values are simulated ones with the probability

    P = n (n - 1) / ((n + k)(n + k - 1))

for any distribution. A model c times as wide as the truth passes with P = E[(F(c U) - F(c L))^k]. L and U
are the smallest and largest of n standard draws. Here F is normal, and the expectation is a Monte Carlo
mean over L and U, whose joint distribution is known.

A second test compares the spread: the sum of squared distances of k tests with m components is
chi^2 distributed with k m degrees of freedom under the right model, and c^-2 times that under a
model c times as wide.

Simulated clouds are not normal. So both probabilities are also computed for the cloud itself, with a
truth that is the cloud shrunk by c.
"""

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.studies.measured.judgement import spreads
from tipoff.studies.measured.results import Power

LEVEL = 0.05
FACTORS = (1.0 / 3.0, 0.5, 1.0, 2.0, 3.0)  # spread of the model over that of the truth
_DRAWS, _SETS, _SEED = 200_000, 20_000, 7


def inside_range(cases: int, tests: int) -> float:
    """Probability that all ``tests`` lie inside the range of ``cases`` (two at least) of the same
    distribution."""
    total = cases + tests
    return cases * (cases - 1) / (total * (total - 1))


def inside_range_of(cases: int, tests: int, factor: float) -> float:
    """The same if the model is normal and ``factor`` times as wide as the truth."""
    rng = np.random.default_rng(_SEED)
    # Order statistics of uniform draws: the largest is V^(1/n); the n - 1 others are uniform below
    # it.
    tail = -np.expm1(np.log(rng.random(_DRAWS)) / cases)  # 1 - largest, without cancellation
    low = (1.0 - tail) * -np.expm1(np.log(rng.random(_DRAWS)) / (cases - 1))
    normal = scipy.stats.norm
    return float(
        np.mean(
            (1.0 - normal.sf(factor * normal.isf(tail)) - normal.cdf(factor * normal.ppf(low)))
            ** tests
        )
    )


def flagged(tests: int, factor: float, components: int = 3) -> float:
    """Probability that the two-sided 5 % test of the spread rejects a normal model ``factor`` times
    as wide as the truth."""
    law = scipy.stats.chi2(tests * components)
    low, high = law.ppf(0.5 * LEVEL), law.ppf(1.0 - 0.5 * LEVEL)
    return float(law.cdf(factor**2 * low) + law.sf(factor**2 * high))


def in_cloud(simulated: np.ndarray, tests: int, factor: float) -> tuple[float, float]:
    """Probabilities for cases (n,3) that are ``factor`` times as wide as the truth: to pass the
    range on all axes, and to be rejected by the spread."""
    mean = simulated.mean(axis=0)
    truth = mean + (simulated - mean) / factor
    held = ((truth >= simulated.min(axis=0)) & (truth <= simulated.max(axis=0))).all(axis=1).mean()
    drawn = np.random.default_rng(_SEED).integers(len(simulated), size=(_SETS, tests))
    low, high = np.quantile(spreads(simulated[drawn], simulated), [0.5 * LEVEL, 1.0 - 0.5 * LEVEL])
    found = spreads(truth[drawn], simulated)
    return float(held**tests), float(((found < low) | (found > high)).mean())


def table(simulated: np.ndarray, tests: int) -> tuple[Power, ...]:
    """One row for each of FACTORS. Probabilities to pass on one axis and on three independent ones,
    and to be rejected by the spread of all components; then to pass on all axes and to be rejected
    in the cloud (n,3) itself. ``passes_in_cloud`` is None for factor 1, where the value is exact.
    """
    rows = []
    for factor in FACTORS:
        one = (
            inside_range(len(simulated), tests)
            if factor == 1.0
            else inside_range_of(len(simulated), tests, factor)
        )
        held, seen = in_cloud(simulated, tests, factor)
        rows.append(
            Power(
                factor=factor,
                passes_one_axis=one,
                passes_three_axes=one**3,
                passes_in_cloud=None if factor == 1.0 else held,
                flagged_by_spread=flagged(tests, factor),
                flagged_in_cloud=seen,
            )
        )
    return tuple(rows)
