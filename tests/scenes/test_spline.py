"""The spline of the kernels against scipy's, which is the same one."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from scenes import spline


@pytest.mark.parametrize("count", [4, 5, 9, 60])
def test_same_as_scipy(count):
    random = np.random.default_rng(count)
    x, y = np.cumsum(random.uniform(0.5, 1.5, count)), random.normal(size=(count, 2))
    slope, known = np.empty((count, 2)), CubicSpline(x, y)
    spline.slopes(x, y, np.empty(count), slope)
    assert slope == pytest.approx(known(x, 1), rel=1e-11, abs=1e-11)
    low, high = x[0] + 0.3, x[-1] - 0.2
    for k in range(2):
        assert spline.integral(x, y, slope, k, low, high) == pytest.approx(known.integrate(low, high)[k], rel=1e-11, abs=1e-11)
    # Control: straight lines between the same points are another integral.
    assert abs(float(np.trapezoid(y[:, 0], x)) - spline.integral(x, y, slope, 0, x[0], x[-1])) > 1e-3


def test_crossing_is_a_root():
    x = np.arange(6.0)
    y = ((x - 2.3) ** 3 + (x - 2.3)).reshape(-1, 1)
    slope = np.empty((6, 1))
    spline.slopes(x, y, np.empty(6), slope)
    assert spline.crossing(x, y, slope, 2) == pytest.approx(2.3, abs=1e-14)
