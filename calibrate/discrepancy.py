"""What reference curves tell of the constants once the surrogate is known to be wrong: surrogate plus discrepancy.

    y_cq(t) = f_cq(t; theta) + A_cq s_q d_cq(t),      E d = 0,   E d^2 = 1,   corr(d(t), d(t')) = rho_q(|t - t'|)

for condition c and quantity q (v_x and three rates), A_cq the amplitudes of ``calibrate.objective``: what the surrogate lacks is
an error of unknown size s_q relative to the curve, and correlated in time (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 2001, 425).
Its course is no question here, so it is reduced to its size and to how often a curve tells anew what it is. Curves of n samples
count as

    N_cq = min( n / tau_q, touches ),      tau_q = 1 + 2 sum_k rho_q(k dt)

    log p(y | theta, s) = - sum_q [ N_q log s_q + N_q S_q(theta) / (2 s_q^2) ]

with N_q = sum_c N_cq and S_q = sum_c N_cq e_cq^2 / N_q from the relative mean squares e_cq^2 of what is left: the likelihood of
independent samples, raised to the power at which its curvature is right (Ribatet, Cooley and Davison, Stat. Sinica 22, 2012, 813).
tau_q is read off what the best constants leave, all conditions together, and held (``calibrate.correlation``). It takes errors for
alike at all times; but a pad touches for some milliseconds, and what is wrong with a free flight was decided before. So a curve
never counts more often than pads touched in it, where that is known.

The sizes are integrated out over scaled inverse chi^2 priors of nu = 1, s_q^2 ~ s_0^2, s_0 the smallest error worth a thought::

    log p(y | theta) = - 1/2 sum_q (N_q + nu) log( (N_q S_q(theta) + nu s_0^2) / (N_q + nu) )

Errors of different conditions and quantities are taken as independent of each other; where they are alike the intervals are still
too narrow. Settled values are the ends of the same curves and do not count again.
"""

from typing import NamedTuple, Sequence

import numpy as np

from calibrate.correlation import correlation_time
from calibrate.objective import VELOCITY_WEIGHT, Parts

QUANTITIES = ("velocity_x", "rate_x", "rate_y", "rate_z")
FREEDOM = 1.0  # nu: one sample's worth of belief in s_0
# A thousandth of the rates is what mesh and step leave in a good reference; v_x is judged VELOCITY_WEIGHT times as sharply.
SMALLEST = np.array([1e-3 / VELOCITY_WEIGHT, 1e-3, 1e-3, 1e-3])


class Error(NamedTuple):
    """Discrepancy of every quantity: ``counts`` (c,4) independent samples N_cq of each curve, ``samples`` (c,) of each as they are,
    and ``times`` (4,), the correlation time of each quantity in samples: so many tell as much as one."""

    counts: np.ndarray
    samples: np.ndarray
    times: np.ndarray


def squares(parts: Sequence[Parts]) -> np.ndarray:
    """Relative mean squares e^2 (c,4) of what is left of c conditions."""
    return np.array([[curve @ curve for curve in _curves(part)] for part in parts])


def error(parts: Sequence[Parts], touches: Sequence[int | None]) -> Error:
    """The discrepancy as read off what the best constants leave of c conditions, sampled at equal intervals, each with so many
    ``touches`` or an unknown number of them."""
    samples = np.array([part.velocity.size for part in parts])
    times = np.array([correlation_time(curves) for curves in zip(*map(_curves, parts))])
    most = np.array([np.inf if count is None else count for count in touches])
    return Error(np.minimum(samples[:, None] / times, most[:, None]), samples, times)


def log_likelihood(found: np.ndarray, counts: np.ndarray, smallest: np.ndarray | float = SMALLEST) -> float | np.ndarray:
    """log p(y | theta) with the sizes integrated out, from mean squares (...,c,q) and independent samples (c,q)."""
    total = counts.sum(axis=0) + FREEDOM
    return -0.5 * (total * np.log(_mean_square(found, counts, smallest))).sum(axis=-1)


def sizes(found: np.ndarray, counts: np.ndarray, smallest: np.ndarray | float = SMALLEST) -> np.ndarray:
    """Discrepancy s_q (...,q), root of the mean square that ``log_likelihood`` sees, relative to the amplitudes."""
    return np.sqrt(_mean_square(found, counts, smallest))


def _mean_square(found, counts, smallest):
    return ((counts * found).sum(axis=-2) + FREEDOM * np.square(smallest)) / (counts.sum(axis=0) + FREEDOM)


def _curves(part: Parts) -> tuple[np.ndarray, ...]:
    return part.velocity, *part.rate.T
