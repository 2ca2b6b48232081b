"""How many samples of a curve tell as much as one, since neighbours repeat each other.

    tau = 1 + 2 max_m sum_{k = 1}^{m} rho_k        rho_k = sum_i x_i x_{i+k} / sum_i x_i^2

the integrated autocorrelation time in samples, rho_k the autocorrelation at a lag of k; n samples
count as n / tau. The sum goes up to the lag that makes most of it. One up to the first rho_k below
zero would take a slow error under a quick one, a rail that rings, for noise of the quick one's
kind: the curve would seem to tell anew with every swing. The price is that a largest sum errs
upwards: a single curve of white noise has a tau of about 1.6, so that intervals come out wider,
never narrower, than they had to be.
"""

from collections.abc import Sequence

import numpy as np


def correlation_time(curves: Sequence[np.ndarray]) -> float:
    """tau in samples, at least 1, of zero-mean curves (n_c,) together, sampled at the same
    intervals; 1 where all are zero."""
    length = max(curve.size for curve in curves)
    power = sum(np.abs(np.fft.rfft(curve, 2 * length)) ** 2 for curve in curves)
    covariance = np.fft.irfft(power)[:length]
    if covariance[0] <= 0.0:
        return 1.0
    return 1.0 + 2.0 * max(0.0, float(np.cumsum(covariance[1:] / covariance[0]).max(initial=0.0)))
