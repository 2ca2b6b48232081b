"""The last stage of a fit on compliant contact: least squares, weighted by the scatter of each
curve.

The objective of the search requires v_x to 0.1 % and rates to 5 %. Noise seldom has this ratio. If
every curve is weighted by its scatter, least squares uses all information in curves with white
noise.

The time of ignition is seldom known to a sample, so the offset of each condition is a nuisance of
this fit. v_x during the thrust determines it, for any contact.
"""

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.discrepancy import RATE, VELOCITY, Curve
from tipoff.calibration.information import jacobian
from tipoff.calibration.objective import Objective

ROUNDS = 2  # the weights come from the residuals of the round before
ITERATIONS = 6
UNIT = 1e-3  # s, of an offset among the coordinates of the fit
STEP = 1e-3  # of UNIT, for slopes


def refined(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """Shares (p,) of the weighted fit next to ``shares``. The offsets of the curves are fitted
    together with them and stored in ``objective.offsets``."""
    count = shares.size
    point = np.append(shares, [value / UNIT for value in objective.offsets.values()])
    free = np.full(len(objective.offsets), np.inf)
    for _ in range(ROUNDS):
        flat = np.zeros((0, count))
        root = np.concatenate(
            [
                np.full(curve.time.size, np.sqrt(curve.weight))
                for curve in curves(objective, shifted(objective, point), flat)
            ]
        )

        def weighted(at: np.ndarray, root: np.ndarray = root) -> np.ndarray:
            return root * shifted(objective, at)

        def slopes(at: np.ndarray, root: np.ndarray = root) -> np.ndarray:
            set_offsets(objective, at[count:])
            late = root[:, None] * offset_slopes(objective, at[:count])
            own = jacobian(lambda share: root * left(objective, share), at[:count])
            return np.hstack([own, late])

        point = scipy.optimize.least_squares(
            weighted,
            point,
            slopes,
            bounds=(np.append(np.zeros(count), -free), np.append(np.ones(count), free)),
            max_nfev=ITERATIONS,
        ).x
    set_offsets(objective, point[count:])
    return point[:count]


def set_offsets(objective: Objective, values: np.ndarray) -> None:
    """Set the offsets of all conditions to ``values`` (c,), in units of ``UNIT``."""
    objective.offsets = dict(zip(objective.offsets, (UNIT * values).tolist()))


def shifted(objective: Objective, point: np.ndarray) -> np.ndarray:
    """As ``left``, at shares (p,) and offsets (c,) together."""
    count = point.size - len(objective.offsets)
    set_offsets(objective, point[count:])
    return left(objective, point[:count])


def offset_slopes(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """Slopes (n,c) of ``left`` to the offset of each condition, in units of ``UNIT``."""
    own, columns = np.array(list(objective.offsets.values())) / UNIT, []
    for index in range(own.size):
        ahead, behind = own.copy(), own.copy()
        ahead[index] += STEP
        behind[index] -= STEP
        both = [shifted(objective, np.append(shares, at)) for at in (ahead, behind)]
        columns.append((both[0] - both[1]) / (2.0 * STEP))
    set_offsets(objective, own)
    return np.column_stack(columns)


def evaluations(parameters: int) -> int:
    """Largest number of evaluations of ``refined``."""
    return ROUNDS * (1 + ITERATIONS * (2 * parameters + 1))


def both(objective: Objective, shares: np.ndarray) -> np.ndarray:
    """The residuals of the objective, then the differences from all curves."""
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
