"""Profile of a log density: its largest value while one parameter is held, the others found again.

    P_i(x) = max_{theta: theta_i = x} log p(theta)

Where a chain has been its best draw nearby is a start that a short simplex search (Nelder and Mead) improves; it needs no gradient,
for the density has jumps. Half the 95 % quantile of chi^2 with one degree of freedom, ``DROP``, is what P may fall by inside the
interval.
"""

from typing import Callable

import numpy as np
from scipy.optimize import minimize

DROP = 0.5 * 3.841459
_MARGIN = 0.25  # of the range of the draws, on either side of it


def profile(density: Callable[[np.ndarray], float], shares: np.ndarray, values: np.ndarray, index: int, points: int = 9,
            evaluations: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Grid (points,) of parameter ``index`` and P on it, from draws (k,p) with log densities (k,) and ``evaluations`` a point."""
    low, high = np.quantile(shares[:, index], [0.005, 0.995])
    margin = _MARGIN * (high - low)
    grid = np.linspace(max(0.0, low - margin), min(1.0, high + margin), points)
    return grid, np.array([_largest(density, shares, values, index, at, 0.5 * (grid[1] - grid[0]), evaluations) for at in grid])


def _largest(density, shares, values, index: int, at: float, reach: float, evaluations: int) -> float:
    """P at ``at``, from the best draw within ``reach`` of it, or the nearest one."""
    away = np.abs(shares[:, index] - at)
    near = away <= max(reach, float(away.min()))
    start = np.delete(shares[near][np.argmax(values[near])], index)
    if not start.size:
        return float(density(np.array([at])))
    steps = 0.5 * np.delete(shares.std(axis=0), index)
    corners = start + np.where(start + steps <= 1.0, 1.0, -1.0) * np.vstack([np.zeros(start.size), np.diag(steps)])
    found = minimize(lambda others: -density(np.insert(others, index, at)), start, method="Nelder-Mead",
                     bounds=[(0.0, 1.0)] * start.size,
                     options={"maxfev": evaluations, "initial_simplex": corners, "xatol": 1e-4, "fatol": 1e-2})
    return -float(found.fun)
