"""Uncertainty of fitted parameters with model error: measured curve = model + model error + noise.

    y = f(x) + d(t) + e        Cov d(t) d(t') = (s a)^2 min(t, t') / T        e ~ N(0, v)

This is the model of Kennedy and O'Hagan (J. R. Statist. Soc. B 63, 2001, 425) in its simplest form,
with a flat prior for x. A surrogate has errors of forces, and curves are their integrals. So d is a
Wiener process from ignition; s is its deviation at the end T of a curve over the root mean square a
of the curve. v_x has one s, and all rates share another.

s maximises the likelihood with x integrated out (restricted likelihood, Patterson and Thompson,
Biometrika 58, 1971, 545). v comes from differences of neighbours, in which a slow error cancels
(von Neumann, Ann. Math. Stat. 12, 1941, 367). A part of d with the effect of a parameter is
invisible in the residuals (Brynjarsdottir and O'Hagan, Inverse Problems 30, 2014, 114007). So s is
at least ``LEAST``, the best measured agreement with the finite elements.

The fit has weights w = 1 / mean(r^2) for each curve c. Near the fit the residuals r are linear, and
x is Gaussian with::

    dx = sum_c A_c (d_c + e_c)        A_c = (sum w J'J)^-1 w_c J_c'
    sd(dx_i)^2 = sum_c var(A_c e_c)_i + (sum_c sd(A_c d_c)_i)^2

Deviations of model error are added, since two curves may have the same error. This is sufficient
for any correlation between them.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

VELOCITY, RATE = 0, 1  # kinds of curves
LEAST = (1e-4, 5e-3)  # least s by kind: 0.5 % of a rate, a fiftieth of this for v_x
_MOST = 1.0
_ROUNDING = 1e-6  # of the curve: the tolerance of a run


class Curve(NamedTuple):
    """One curve and its fit."""

    time: np.ndarray  # (n,) s since ignition
    left: np.ndarray  # (n,) residual of the fit
    slope: np.ndarray  # (n,p) to the parameters' shares
    size: float  # root mean square
    kind: int  # VELOCITY or RATE

    @property
    def noise(self) -> float:
        """Variance of the noise, at least the rounding of a run."""
        white = 0.5 * float(np.mean(np.diff(self.left) ** 2))
        return max(white, (_ROUNDING * self.size) ** 2)

    @property
    def weight(self) -> float:
        """Weight of the squared residuals in a fit."""
        return 1.0 / max(float(np.mean(self.left**2)), (_ROUNDING * self.size) ** 2)

    def steps(self, deviation: float) -> np.ndarray:
        """Variance (n,) of the increase of the model error since the sample before, for its
        relative ``deviation``."""
        since = np.diff(np.append(0.0, self.time)) / self.time[-1]
        # the error at ignition is rounding; zero would make the covariance singular
        return (deviation * self.size) ** 2 * np.maximum(since, 1e-9)


def likeliest(curves: Sequence[Curve]) -> tuple[float, float]:
    """The relative deviations s of v_x and of the rates with the largest likelihood for any
    parameters; at least ``LEAST``."""
    limits = np.log([(least, _MOST) for least in LEAST])

    def surprise(logarithms: np.ndarray) -> float:
        """Minus twice the logarithm of the restricted likelihood."""
        total, log = normal(curves, np.exp(logarithms))
        matrix, pull = total[:-1, :-1], total[:-1, -1]
        least = total[-1, -1] - pull @ np.linalg.solve(matrix, pull)
        return float(log + np.linalg.slogdet(matrix)[1] + least)

    ends = [
        scipy.optimize.minimize(surprise, start, method="L-BFGS-B", bounds=limits)
        for start in (limits[:, 0], 0.5 * limits.sum(axis=1))
    ]
    velocity, rate = np.exp(min(ends, key=lambda end: end.fun).x)
    return float(velocity), float(rate)


def normal(curves: Sequence[Curve], deviations: Sequence[float]) -> tuple[np.ndarray, float]:
    """The products (p+1,p+1) of slopes and residuals, weighted by the inverse covariance of all
    curves, and the logarithm of its determinant."""
    size, log = curves[0].slope.shape[1] + 1, 0.0
    total = np.zeros((size, size))
    for curve in curves:
        columns = np.column_stack([curve.slope, curve.left])
        solved, one = whitened(curve, deviations[curve.kind], columns)
        total += columns.T @ solved
        log += one
    return 0.5 * (total + total.T), log


def whitened(curve: Curve, deviation: float, columns: np.ndarray) -> tuple[np.ndarray, float]:
    """S^-1 ``columns`` (n,k) for the covariance S = K + v I of one curve, and log det S.

    The inverse of K, of a Wiener process, is tridiagonal, and so is T = I + v K^-1, with S = K T.
    """
    fresh = 1.0 / curve.steps(deviation)
    diagonal = fresh + np.append(fresh[1:], 0.0)
    beside = -fresh[1:, None]
    product = diagonal[:, None] * columns
    product[:-1] += beside * columns[1:]
    product[1:] += beside * columns[:-1]
    band = curve.noise * np.array([diagonal, np.append(-fresh[1:], 0.0)])
    band[0] += 1.0
    factor = scipy.linalg.cholesky_banded(band, lower=True)
    log = 2.0 * np.log(factor[0]).sum() - np.log(fresh).sum()
    return scipy.linalg.cho_solve_banded((factor, True), product), float(log)


def deviations(
    curves: Sequence[Curve], errors: Sequence[float], directions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviations (p,) of the fitted shares: with residuals as white noise only, and with
    model errors of the relative deviations ``errors``.

    The slopes of the ``curves`` are along the ``directions`` (p,k) of the shares, unit vectors with
    an effect.
    """
    inverse = np.linalg.inv(sum(curve.weight * curve.slope.T @ curve.slope for curve in curves))
    noise, model = np.zeros(len(directions)), np.zeros(len(directions))
    for curve in curves:
        share = curve.weight * directions @ inverse @ curve.slope.T  # (p,n)
        noise += curve.noise * (share**2).sum(axis=1)
        # a step of the error changes everything after it
        after = np.cumsum(share[:, ::-1], axis=1)[:, ::-1]
        model += np.sqrt((after**2 * curve.steps(errors[curve.kind])).sum(axis=1))
    scatter = np.diag(directions @ inverse @ directions.T)
    return np.sqrt(scatter), np.sqrt(noise + model**2)
