"""Walls that are not straight as drawn: draft, bow, steps and joints of a rail from a file.

    W(X, eta) = w_0(X) + w_1(X) eta + w_2(X) eta^2

is the offset of the wall away from the payload, relative to the straight wall of the scene, under
the track of a pad face, eta from -1 to 1 across the face. It is given at places about ``SPACING``
apart from one end of the rail to the other. The interpolation is the monotone cubic of Fritsch and
Carlson (SIAM J. Numer. Anal. 17 (1980) 238-246), which is exact for a straight draft and does not
overshoot at a step.
"""

import numpy as np

SPACING = 0.5e-3  # m, largest spacing: a small part of the length of a pad
ACROSS = 3  # powers of eta


def grid(start: float, end: float) -> np.ndarray:
    """Places X (n,) m from ``start`` to ``end`` (m) at which the offset is given."""
    return np.linspace(start, end, int(np.ceil((end - start) / SPACING - 1e-9)) + 1)


def cubic(places: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Monotone cubic (n-1,...,4) through ``values`` (n,...) at ``places`` (n,) m: coefficients of the
    rising powers of the distance (m) from the place before."""
    from scipy.interpolate import PchipInterpolator

    return np.ascontiguousarray(np.moveaxis(PchipInterpolator(places, values).c[::-1], 0, -1))


def mean(places: np.ndarray, values: np.ndarray, middle: np.ndarray, half: float) -> np.ndarray:
    """Mean (s,) m of W over a face of half length ``half`` (m) with its middle at X = ``middle``
    (s,) m; ``values`` (n,ACROSS) m at ``places`` (n,) m. Where the face is not completely over the
    rail, it is the mean at the last place where it is."""
    from scipy.interpolate import PchipInterpolator

    over = PchipInterpolator(places, values[:, 0] + values[:, 2] / 3.0).antiderivative()
    inside = np.clip(middle, places[0] + half, max(places[-1] - half, places[0] + half))
    return (over(inside + half) - over(inside - half)) / (2.0 * half)
