"""The step of a sensor that its samples show. A log may be rounded more coarsely than its sheet states.

The step is the smallest difference of two samples that follow each other; a few samples that do not lie
on steps, such as interpolated ones, are left out. Rounded samples have no other difference below one and
a half steps. Differences of samples that are not rounded have any size: they show no step, and the
stated one counts.
"""

import numpy as np

_ODD = 0.005  # share of the differences that may be smaller than the step
_ALIKE = 0.05  # relative: steps in a log of few digits differ by its last digit
_EQUAL = 1e-9  # relative, of the largest value


def steps(values: np.ndarray, stated: float = 0.0) -> np.ndarray:
    """Steps (k,) of samples (n,k) of the axes of one sensor, at least the ``stated`` one, in the same
    unit. A constant axis has the step of the finest other one. Without a stated step, samples that show
    none have their smallest difference, and 0 if all are constant."""
    found = np.array([_step(column, stated) for column in values.T])
    least = found.min(initial=np.inf)
    return np.where(np.isfinite(found), found, least if np.isfinite(least) else stated)


def _step(column: np.ndarray, stated: float) -> float:
    known = column[np.isfinite(column)]
    sizes = np.abs(np.diff(known))
    sizes = np.sort(sizes[sizes > _EQUAL * np.abs(known).max(initial=0.0)])
    if not sizes.size:
        return np.inf
    step = float(sizes[int(_ODD * sizes.size)])
    small = sizes[sizes < 1.5 * step]
    alike = np.abs(small - step) <= _ALIKE * step
    is_shown = alike.sum() > 1 and alike.mean() > 0.5
    return max(stated, step) if is_shown or not stated else stated
