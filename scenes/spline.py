"""The cubic spline without a knot at the second and the last but one point, for kernels; scipy's ``CubicSpline`` to rounding.

With the slopes s_i at the points, continuity of the second derivative gives for each inner point

    dx_i s_(i-1) + 2 (dx_(i-1) + dx_i) s_i + dx_(i-1) s_(i+1) = 3 (dx_i d_(i-1) + dx_(i-1) d_i),   d_i = (y_(i+1) - y_i) / dx_i

and at both ends one more equation makes the first two pieces one cubic (de Boor, A practical guide to splines, chapter IV).
"""

from scenes.jit import kernel


@kernel
def slopes(x, y, work, out):
    """Slopes ``out`` (n,k) of the splines through the columns of ``y`` (n,k) at rising ``x`` (n,), n at least 4;
    ``work`` (n,) is scratch."""
    last, columns = x.size - 1, y.shape[1]
    before, after, both = x[1] - x[0], x[2] - x[1], x[2] - x[0]
    p, q = (before + 2.0 * both) / (both * before), before * before / (both * after * after)
    work[0] = both / after
    for k in range(columns):
        out[0, k] = p * (y[1, k] - y[0, k]) + q * (y[2, k] - y[1, k])
    for i in range(1, last):
        before, after = x[i] - x[i - 1], x[i + 1] - x[i]
        share = 1.0 / (2.0 * (before + after) - after * work[i - 1])
        work[i] = before * share
        p, q, r = 3.0 * share * after / before, 3.0 * share * before / after, share * after
        for k in range(columns):
            out[i, k] = p * (y[i, k] - y[i - 1, k]) + q * (y[i + 1, k] - y[i, k]) - r * out[i - 1, k]
    both = x[last] - x[last - 2]
    share = 1.0 / (before - both * work[last - 1])
    p, q = share * after * after / (both * before), share * (2.0 * both + after) * before / (both * after)
    for k in range(columns):
        out[last, k] = p * (y[last - 1, k] - y[last - 2, k]) + q * (y[last, k] - y[last - 1, k]) - share * both * out[last - 1, k]
    for i in range(last - 1, -1, -1):
        for k in range(columns):
            out[i, k] -= work[i] * out[i + 1, k]


@kernel
def integral(x, y, slope, k, start, end):
    """Integral over ``start``..``end``, inside ``x``, of the spline of column ``k`` with these slopes."""
    total = 0.0
    for i in range(x.size - 1):
        low, high, h = max(start, x[i]), min(end, x[i + 1]), x[i + 1] - x[i]
        if high - low == h:
            total += h * (0.5 * (y[i, k] + y[i + 1, k]) + h / 12.0 * (slope[i, k] - slope[i + 1, k]))
        elif high > low:
            total += _antiderivative(x, y, slope, i, k, high) - _antiderivative(x, y, slope, i, k, low)
    return total


@kernel
def _antiderivative(x, y, slope, i, k, at):
    h, t = x[i + 1] - x[i], at - x[i]
    d = (y[i + 1, k] - y[i, k]) / h
    b, a = (3.0 * d - 2.0 * slope[i, k] - slope[i + 1, k]) / h, (slope[i, k] + slope[i + 1, k] - 2.0 * d) / (h * h)
    return t * (y[i, k] + t * (slope[i, k] / 2.0 + t * (b / 3.0 + t * a / 4.0)))


@kernel
def crossing(x, y, slope, i):
    """Where, in the only column, piece ``i``, not above zero at its begin and above zero at its end, passes zero:
    bisection to the last bit."""
    h = x[i + 1] - x[i]
    d = (y[i + 1, 0] - y[i, 0]) / h
    b, a = (3.0 * d - 2.0 * slope[i, 0] - slope[i + 1, 0]) / h, (slope[i, 0] + slope[i + 1, 0] - 2.0 * d) / (h * h)
    low, high = x[i], x[i + 1]
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        t = middle - x[i]
        if y[i, 0] + t * (slope[i, 0] + t * (b + t * a)) > 0.0:
            high = middle
        else:
            low = middle
