"""Values between the stations of a rail compliance."""

import numpy as np


def cubic(travel: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Cubic spline (s-1,...,4) through ``values`` (s,...) at ``travel`` (s,) m: coefficients of the
    rising powers of the distance (m) from the station before."""
    from scipy.interpolate import CubicSpline

    if not values.size:
        return np.zeros((len(travel) - 1, *values.shape[1:], 4))
    return np.ascontiguousarray(np.moveaxis(CubicSpline(travel, values).c[::-1], 0, -1))
