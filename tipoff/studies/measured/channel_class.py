"""Channel frequency classes (CFC) of SAE J211-1 and ISO 6487: a two-pole Butterworth low-pass, run
forward and backward.

    w_a = tan(w_d T / 2),  w_d = 2 pi 2.0775 CFC,  c = 1 + sqrt(2) w_a + w_a^2        (SAE J211-1, Appendix C)
    a0 = a2 = w_a^2 / c,  a1 = 2 a0,  b1 = 2 (1 - w_a^2) / c,  b2 = (sqrt(2) w_a - 1 - w_a^2) / c
    y_n = a0 x_n + a1 x_(n-1) + a2 x_(n-2) + b1 y_(n-1) + b2 y_(n-2)

These are the numbers of ``scipy.signal.butter(2, 2.0775 * CFC, fs=1 / T)``, whose second list is (1, -b1,
-b2): the bilinear transform, prewarped at 2.0775 CFC. Both passes together have the gain 1 / (1 + (w /
w_d)^4) and no phase shift: -6 dB at 2.0775 CFC, and -3 dB at (sqrt(2) - 1)^(1/4) of that frequency, which
is 5/3 CFC (100 Hz for CFC 60).
"""

import math

import numpy as np
import scipy  # scipy loads a part at its first use

DESIGN = 2.0775  # frequency of one pass over the class
SAMPLES_PER_CLASS = 10.0  # least sampling rate over the class
_UNKNOWN = 60.0  # class in place of an unknown filter
_DECAYS = 10.0  # time constants after which 5e-5 of a jump is left


def coefficients(channel_class: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Numerator (a0, a1, a2) and denominator (1, -b1, -b2) of one pass at the sampling ``rate``
    (Hz)."""
    warped = math.tan(math.pi * DESIGN * channel_class / rate)
    common = 1.0 + math.sqrt(2.0) * warped + warped**2
    gain = warped**2 / common
    return (
        np.array([gain, 2.0 * gain, gain]),
        np.array(
            [
                1.0,
                -2.0 * (1.0 - warped**2) / common,
                -(math.sqrt(2.0) * warped - 1.0 - warped**2) / common,
            ]
        ),
    )


def filtered(values: np.ndarray, channel_class: float | None, interval: float) -> np.ndarray:
    """``values`` (n, ...) sampled every ``interval`` (s), filtered without phase shift; unchanged
    without a class. The signal is continued by point reflection at both ends, so a straight line
    does not change."""
    if channel_class is None:
        return values
    top, bottom = coefficients(channel_class, 1.0 / interval)
    pad = min(math.ceil(reach(channel_class) / interval), len(values) - 1)
    return scipy.signal.filtfilt(top, bottom, values, axis=0, padtype="odd", padlen=pad)


def reach(channel_class: float | None) -> float:
    """How far (s) the filter carries a jump to either side: its poles decay with w_d / sqrt(2).
    Without a class it is that of CFC 60, for the filter of a sensor that is not known."""
    channel_class = channel_class or _UNKNOWN
    return _DECAYS / (2.0 * math.pi * DESIGN * channel_class / math.sqrt(2.0))
