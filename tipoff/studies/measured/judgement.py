"""Comparison of tests with simulated cases by ranks, without an assumed distribution.

If a test is one more draw of the model, each of the N + 1 ranks among N simulated cases has the same
probability. Then

    p = (r + 1) / (N + 1),   r simulated cases being at least as extreme,

is uniform (Barnard 1963; conformal prediction). This is exact if

* each case has errors of measurement like the test, drawn from the test's uncertainty, and
* the measure treats all N + 1 alike: the Mahalanobis distance uses the mean and the covariance of all,
  test included.

The smallest possible p is 1 / (N + 1).
"""

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.studies.measured.results import Magnitude, Region, Standing

MAGNITUDES = ("roll", "transverse", "total")
SHARE = 0.95  # of the prediction region
_SEED = 20230
_SUBSETS = 9999


def standing(
    simulated: np.ndarray, change: np.ndarray, uncertainty: np.ndarray, number: int = 0
) -> Standing:
    """The place of test ``number``, with a change (3,) of rate and its standard uncertainty (3,),
    among simulated cases (n,3)."""
    drawn = measured(simulated, uncertainty, number)
    share, p = ranked(drawn, change)
    size = magnitudes(change)
    sizes = zip(*map(np.ndarray.tolist, (size, *ranked(magnitudes(drawn), size))))
    return Standing(
        percentile=tuple(share.tolist()),
        p=tuple(p.tolist()),
        p_distance=p_distance(drawn, change),
        magnitudes={
            name: Magnitude(value_deg_s=value, percentile=place, p=chance)
            for name, (value, place, chance) in zip(MAGNITUDES, sizes)
        },
    )


def measured(simulated: np.ndarray, uncertainty: np.ndarray, number: int = 0) -> np.ndarray:
    """Simulated cases (n,3) with errors of measurement of standard uncertainty (3,), drawn afresh
    for a test by its ``number``."""
    return simulated + uncertainty * np.random.default_rng([_SEED, number]).standard_normal(
        simulated.shape
    )


def magnitudes(rate: np.ndarray) -> np.ndarray:
    """Roll, transverse and total magnitude (..., 3) of rates (..., 3)."""
    across = np.hypot(rate[..., 1], rate[..., 2])
    return np.stack([np.abs(rate[..., 0]), across, np.hypot(rate[..., 0], across)], axis=-1)


def ranked(simulated: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Percentile, (cases below + 1/2) / (n + 1), and two-sided p of each component (k,) among cases
    (n,k)."""
    below, above = (simulated <= values).sum(axis=0), (simulated >= values).sum(axis=0)
    count = len(simulated) + 1
    return (below + 0.5) / count, np.minimum(1.0, 2.0 * (np.minimum(below, above) + 1.0) / count)


def p_distance(simulated: np.ndarray, value: np.ndarray) -> float:
    """Share of all n + 1 points, ``value`` (k,) included, that lie at least as far from their mean
    as ``value``."""
    distance = distances(np.vstack([simulated, value]))
    return float((distance >= distance[-1]).mean())


def distances(points: np.ndarray) -> np.ndarray:
    """Squared Mahalanobis distance (n,) of points (n,k) from their mean."""
    away = points - points.mean(axis=0)
    return np.einsum("ni,ij,nj->n", away, _inverse(np.cov(points.T)), away)


def _inverse(covariance: np.ndarray) -> np.ndarray:
    """Inverse of a ``covariance`` (k,k). A component without variance is left out."""
    return np.linalg.pinv(covariance, hermitian=True)


def combined(p: list[float]) -> float:
    """Fisher's combined p of all tests. The tests share n cases, which changes p by about 1/n."""
    return float(scipy.stats.combine_pvalues(p, method="fisher").pvalue)


def p_spread(simulated: np.ndarray, changes: np.ndarray, uncertainties: np.ndarray) -> float:
    """Two-sided p of the sum of squared distances of k tests (k,3) among sums over k cases drawn at
    random, with each test's errors of measurement. It is small if the model is too narrow or too
    wide."""
    rng = np.random.default_rng([_SEED, len(changes)])
    drawn = simulated[rng.integers(len(simulated), size=(_SUBSETS, len(changes)))]
    drawn = drawn + uncertainties * rng.standard_normal(drawn.shape)
    sums = spreads(np.concatenate([drawn, changes[None]]), simulated, uncertainties)
    _, p = ranked(sums[:-1, None], sums[-1:])
    return float(p[0])


def spreads(
    sets: np.ndarray, simulated: np.ndarray, uncertainties: np.ndarray | float = 0.0
) -> np.ndarray:
    """Sums (m,) of squared distances of m sets (m,k,3) of rates from the mean of cases (n,3) with
    errors of k tests (k,3)."""
    covariance = np.cov(simulated.T) + np.diag(
        np.mean(np.square(uncertainties * np.ones(3)).reshape(-1, 3), axis=0)
    )
    away = sets - simulated.mean(axis=0)
    return np.einsum("mki,ij,mkj->m", away, _inverse(covariance), away)


def region(simulated: np.ndarray, pair: tuple[int, int], share: float = SHARE) -> Region:
    """The ellipse that contains a ``pair`` of components of the next draw with at least the
    probability ``share``, from draws (n,3): its squared radius is the ceil(share (n + 1))-th
    distance."""
    points = simulated[:, pair]
    place = int(np.ceil(share * (len(points) + 1)))
    first, second = np.cov(points.T).tolist()
    return Region(
        components=("xyz"[pair[0]], "xyz"[pair[1]]),
        share=share,
        centre_deg_s=tuple(points.mean(axis=0).tolist()),
        covariance=(tuple(first), tuple(second)),
        squared_radius=(
            float(np.sort(distances(points))[place - 1]) if place <= len(points) else None
        ),
    )


def outline(found: Region, points: int = 181) -> np.ndarray:
    """Closed curve (points,2) of an ellipse with a radius."""
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    assert found.squared_radius is not None
    circle = np.sqrt(found.squared_radius) * np.column_stack([np.cos(angle), np.sin(angle)])
    size, axes = np.linalg.eigh(found.covariance)
    return found.centre_deg_s + circle * np.sqrt(np.maximum(size, 0.0)) @ axes.T
