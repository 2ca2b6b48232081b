"""The last stage of a fit on compliant contact: least squares, weighted by the scatter of each
curve.

The objective of the search wants v_x to 0.1 % and rates to 5 %. Noise seldom has this ratio. With
every curve weighted by its scatter, least squares uses all information in curves with white noise.
"""

import numpy as np
from scipy.optimize import least_squares

from tipoff.calibration.discrepancy import RATE, VELOCITY, Curve
from tipoff.calibration.information import jacobian
from tipoff.calibration.objective import Objective

ROUNDS = 2  # the weights follow from what the round before leaves
ITERATIONS = 6


def refined(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """Shares (p,) of the weighted fit next to ``shares``."""
    for _ in range(ROUNDS):
        flat = np.zeros((0, shares.size))
        root = np.concatenate(
            [
                np.full(curve.time.size, np.sqrt(curve.weight))
                for curve in curves(objective, left(objective, shares), flat)
            ]
        )

        def weighted(at: np.ndarray, root: np.ndarray = root) -> np.ndarray:
            return root * left(objective, at)

        shares = least_squares(
            weighted,
            shares,
            lambda at: jacobian(weighted, at),
            bounds=(0.0, 1.0),
            max_nfev=ITERATIONS,
        ).x
    return shares


def evaluations(parameters: int) -> int:
    """Largest number of evaluations of ``refined``."""
    return ROUNDS * (1 + ITERATIONS * (2 * parameters + 1))


def both(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """The residuals of the objective, and behind them the differences from all curves."""
    parts = objective.parts(shares)
    return np.concatenate([objective.joined(parts), *objective.curves(parts)])


def left(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """Differences (n,) of the model from all curves, one after the other."""
    return np.concatenate(objective.curves(objective.parts(shares)))


def curves(objective: Objective, difference: np.ndarray, slope: np.ndarray) -> list[Curve]:
    """The curves of all conditions from their joined differences (n,) and slopes (n,p)."""
    found, start = [], 0
    for wanted in objective.targets.values():
        time = wanted.time
        moving, turning = np.array(wanted.amplitudes[:2]) / np.sqrt(wanted.weights.sum())
        for size, kind in ((moving, VELOCITY), *3 * [(turning, RATE)]):
            place = slice(start, start := start + time.size)
            found.append(Curve(time, -difference[place], slope[place], float(size), kind))
    return found
