"""Closed forms of Gaussian thrust: ``J = F0 s sqrt(2 pi)``; a cut at n widths keeps ``erf(n / sqrt
2)`` of it.

Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 7.1.1 (erf) and 26.2 (normal
distribution).
"""

import math


def gaussian_peak(impulse: float, width: float) -> float:
    """Peak (N) of the Gaussian with this impulse (N s) and width sigma (s)."""
    return impulse / (width * math.sqrt(2.0 * math.pi))


def kept_by_cut(widths: float) -> float:
    """Share of the impulse left by a cut ``widths`` each side of the centre."""
    return math.erf(widths / math.sqrt(2.0))
