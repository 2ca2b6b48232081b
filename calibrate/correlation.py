"""Correlation time of a curve: the number of samples that are equivalent to one independent sample.

    tau = 1 + 2 max_m sum_{k = 1}^{m} rho_k        rho_k = sum_i x_i x_{i+k} / sum_i x_i^2

This is the integrated autocorrelation time in samples, with the autocorrelation rho_k at a lag of
k; n samples count as n / tau. The sum ends at the lag m with the largest value. A sum up to the
first negative rho_k would miss a slow error below a fast one, such as a vibrating rail, and give
too many independent samples. The largest sum is biased upwards: white noise has a tau of about 1.6.
So intervals are too wide rather than too narrow.
"""

from collections.abc import Sequence

import numpy as np


def correlation_time(curves: Sequence[np.ndarray]) -> float:
    """tau in samples, at least 1, of zero-mean curves (n_c,) together, sampled at the same
    intervals; 1 if all are zero."""
    length = max(curve.size for curve in curves)
    power = sum(np.abs(np.fft.rfft(curve, 2 * length)) ** 2 for curve in curves)
    covariance = np.fft.irfft(power)[:length]
    if covariance[0] <= 0.0:
        return 1.0
    return 1.0 + 2.0 * max(0.0, float(np.cumsum(covariance[1:] / covariance[0]).max(initial=0.0)))
