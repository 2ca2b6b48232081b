"""What noise does to the difference of a settled and a reference rate, both linear in the samples:
d = sum_i w_i x_i.

* White and short-correlated noise: variance sigma^2 tau sum w^2, with the integrated correlation
  time in samples tau = 1 + 2 sum_k rho_k, summed up to the first lag L >= 5 tau (Sokal) and not
  taken below one. What was fitted to the samples takes tau/n off every rho, which the factor 1 + (2
  L + 1)/n puts back (Wolff, Comput. Phys. Commun. 156, 2004).
* Bias instability B: two-sided density B^2 / (2 pi f) (IEEE 952), so the variance is the integral
  of density times |W(f)|^2, W being the transform of the weights; it is finite since a difference
  has W(0) = 0.
"""

import numpy as np

_OVER_TAU = 5.0
_PADDED = 16  # times the span of the weights: how finely low frequencies are resolved


def correlation_time(residuals: list[np.ndarray], fitted: int = 1) -> float:
    """tau, from several stretches (n_i,3) of residuals of one sensor from which ``fitted``
    parameters were taken in all."""
    count, scales = sum(map(len, residuals)), sum((stretch**2).sum(axis=0) for stretch in residuals)
    if not scales.all():
        return 1.0  # rounded to a constant: nothing to be seen
    raw = tau = 1.0
    for lag in range(1, max(map(len, residuals)) // 2):
        pairs = sum(max(len(stretch) - lag, 0) for stretch in residuals)
        rho = (
            sum((stretch[lag:] * stretch[:-lag]).sum(axis=0) for stretch in residuals)
            / pairs
            / (scales / count)
        )
        raw += 2.0 * float(rho.mean())
        tau = raw * (1.0 + fitted * (2.0 * lag + 1.0) / count)
        if lag >= _OVER_TAU * tau:
            break
    return max(tau, 1.0)


def instability_variance(weights: np.ndarray, interval: float, instability: float) -> float:
    """Variance that bias instability (rad/s) gives a sum with ``weights`` (n,) of samples every
    ``interval`` (s)."""
    length = _PADDED * weights.size
    frequency = np.fft.rfftfreq(length, interval)[1:]
    power = np.abs(np.fft.rfft(weights, length)[1:]) ** 2
    return float(2.0 * (instability**2 / (2.0 * np.pi * frequency) * power).sum() * frequency[0])
