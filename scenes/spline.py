"""The cubic spline without a knot at the second and the last but one point, for kernels; scipy's ``CubicSpline`` to rounding.

With the slopes s_i at the points, continuity of the second derivative gives for each inner point

    dx_i s_(i-1) + 2 (dx_(i-1) + dx_i) s_i + dx_(i-1) s_(i+1) = 3 (dx_i d_(i-1) + dx_(i-1) d_i),   d_i = (y_(i+1) - y_i) / dx_i

and at both ends one more equation makes the first two pieces one cubic (de Boor, A practical guide to splines, chapter IV).
"""

from scenes.jit import kernel


@kernel
def slopes(x, y, work, out):
    """Slopes ``out`` (n,) of the spline through ``y`` (n,) at rising ``x`` (n,), n at least 4; ``work`` (n,) is scratch."""
    last = out.size - 1
    before, after = x[1] - x[0], x[2] - x[1]
    both = x[2] - x[0]
    d0, d1 = (y[1] - y[0]) / before, (y[2] - y[1]) / after
    work[0] = both / after
    out[0] = ((before + 2.0 * both) * after * d0 + before * before * d1) / (both * after)
    for i in range(1, last):
        before, after = x[i] - x[i - 1], x[i + 1] - x[i]
        d0, d1 = (y[i] - y[i - 1]) / before, (y[i + 1] - y[i]) / after
        pivot = 2.0 * (before + after) - after * work[i - 1]
        work[i] = before / pivot
        out[i] = (3.0 * (after * d0 + before * d1) - after * out[i - 1]) / pivot
    both = x[last] - x[last - 2]
    pivot = before - both * work[last - 1]
    out[last] = ((after * after * d0 + (2.0 * both + after) * before * d1) / both - both * out[last - 1]) / pivot
    for i in range(last - 1, -1, -1):
        out[i] -= work[i] * out[i + 1]


@kernel
def integral(x, y, slope, start, end):
    """Integral over ``start``..``end``, inside ``x``, of the spline with these slopes."""
    total = 0.0
    for i in range(x.size - 1):
        low, high = max(start, x[i]), min(end, x[i + 1])
        if high > low:
            total += _antiderivative(x, y, slope, i, high) - _antiderivative(x, y, slope, i, low)
    return total


@kernel
def _antiderivative(x, y, slope, i, at):
    h, t = x[i + 1] - x[i], at - x[i]
    d = (y[i + 1] - y[i]) / h
    b, a = (3.0 * d - 2.0 * slope[i] - slope[i + 1]) / h, (slope[i] + slope[i + 1] - 2.0 * d) / (h * h)
    return t * (y[i] + t * (slope[i] / 2.0 + t * (b / 3.0 + t * a / 4.0)))


@kernel
def crossing(x, y, slope, i):
    """Where piece ``i``, not above zero at its begin and above zero at its end, passes zero: bisection to the last bit."""
    h = x[i + 1] - x[i]
    d = (y[i + 1] - y[i]) / h
    b, a = (3.0 * d - 2.0 * slope[i] - slope[i + 1]) / h, (slope[i] + slope[i + 1] - 2.0 * d) / (h * h)
    low, high = x[i], x[i + 1]
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        t = middle - x[i]
        if y[i] + t * (slope[i] + t * (b + t * a)) > 0.0:
            high = middle
        else:
            low = middle
