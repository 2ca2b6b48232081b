"""The likely cause of curves that a fit does not explain: another unit, sign or axis, or another
condition.

If mounting is fitted, the fit has turned free flight towards the wrong curves. But the rates of free
flight are linear in errors of mounting. So bounded linear least squares on the slopes at the scene's
values tell what each transformation of the curves leaves, without another fit.
"""

import math

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.information import WEAK_EIGENVALUE, jacobian
from tipoff.calibration.misfit import KINDS, NEAR, Kind, misfits, of_rates, segments
from tipoff.calibration.objective import Objective, sampled
from tipoff.results.trajectory import Trajectory


def likely(objective: Objective, name: str, touch: float) -> tuple[Kind, float]:
    """The transformation of the curves of the condition ``name`` that is the likely cause, and the
    remaining misfit of free flight, until ``touch`` (s), or of the whole curve if free flight has no
    signal. Among those with about the least misfit, it is the one whose fit is nearest to the
    scene's values."""
    wanted, offset = objective.targets[name], objective.offsets[name]
    own = np.clip([item.share(item.read(objective.scene)) for item in objective.parameters], 0, 1)

    def rates(shares: np.ndarray) -> np.ndarray:
        return sampled(objective.runs(shares)[name], wanted.time - offset)[:, 1:].ravel()

    nominal, slopes = rates(own), jacobian(rates, own)
    whole, flight = segments(wanted, offset, touch)
    keep = whole if of_rates(wanted, nominal.reshape(-1, 3), flight) is None else flight
    root, tried = np.repeat(np.sqrt(wanted.weights) * keep, 3), []
    for index, kind in enumerate(KINDS):
        change = _change(root, (wanted.rate @ kind.turn.T).ravel(), nominal, slopes, own)
        left = of_rates(wanted, (nominal + slopes @ change).reshape(-1, 3), keep)
        if left is not None:
            tried.append((float(left[index]), float(np.abs(change).max()), kind))
    least = min((misfit for misfit, _, _ in tried), default=math.inf)
    near = [item for item in tried if item[0] <= NEAR * least]
    misfit, _, kind = min(near, key=lambda item: item[1], default=(2.0, 0.0, KINDS[0]))
    return kind, misfit


def _change(
    root: np.ndarray, rate: np.ndarray, nominal: np.ndarray, slopes: np.ndarray, own: np.ndarray
) -> np.ndarray:
    """Change (p,) of the shares from ``own`` with which the linear model meets ``rate`` (n,) best,
    under weights ``root`` (n,). What the curves hardly determine stays near the scene's values: a
    tenth of the bounds counts as much as 0.5 % of the curves (``WEAK_EIGENVALUE``)."""
    root = root / np.linalg.norm(root * rate)
    matrix = np.vstack([root[:, None] * slopes, math.sqrt(WEAK_EIGENVALUE) * np.eye(own.size)])
    gap = np.append(root * (rate - nominal), np.zeros(own.size))
    return scipy.optimize.lsq_linear(matrix, gap, (-own, 1.0 - own)).x


def condition(
    objective: Objective, runs: dict[str, Trajectory], name: str, touch: float
) -> tuple[str, float]:
    """The other condition whose run is nearest to the curves of the condition ``name``, and the
    remaining misfit; infinite without another. Free flight, until ``touch`` (s), distinguishes
    conditions even if wrong curves have changed the fit; the whole curve is used if free flight has
    no signal."""
    found = [("", math.inf)]
    for other, run in runs.items():
        there = misfits(objective.targets[name], run, objective.offsets[name], touch)
        part = there.whole if there.flight is None else there.flight
        if other != name and part is not None:
            found.append((other, float(part[0])))
    return min(found, key=lambda item: item[1])
