"""The likely cause of curves that no errors of mounting explain. The fit is repeated with the
curves transformed, and the transformation with the least residual is named. Curves may also be
those of another condition.

If mounting is fitted, the points of a search do not explain the transformed curves, since few of
them are near the optimum. So each candidate gets its own least squares.
"""

import copy
import math

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.information import jacobian
from tipoff.calibration.misfit import KINDS, NEAR, Kind, misfits
from tipoff.calibration.objective import Objective
from tipoff.results.trajectory import Trajectory

_ITERATIONS = 8


def likely(objective: Objective, name: str, best: Kind) -> tuple[Kind, float]:
    """The transformation of the curves of the condition ``name`` that is the likely cause, and the
    remaining misfit; ``best`` is that of the search. Among those with about the least misfit, it is
    the one whose fit is nearest to the scene's values."""
    own = np.array([item.share(item.read(objective.scene)) for item in objective.parameters])
    own, tried = np.clip(own, 0.0, 1.0), []
    for kind in _candidates(best):
        turned = _turned(objective, name, kind)
        end = scipy.optimize.least_squares(
            turned,
            own,
            lambda shares, turned=turned: jacobian(turned, shares),
            bounds=(0.0, 1.0),
            max_nfev=_ITERATIONS,
        ).x
        run = turned.runs(end)[name]
        whole = misfits(turned.targets[name], run, turned.offsets[name], 0.0).whole
        if whole is not None:
            tried.append((float(whole[0]), float(np.abs(end - own).max()), kind))
    if not tried:
        return KINDS[0], 2.0
    least = min(misfit for misfit, _, _ in tried)
    near = [item for item in tried if item[0] <= NEAR * least]
    misfit, _, kind = min(near, key=lambda item: item[1])
    return kind, misfit


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


def _turned(objective: Objective, name: str, kind: Kind) -> Objective:
    """An objective of the curves of ``name`` alone, transformed."""
    wanted = objective.targets[name]
    rate, settled = wanted.rate @ kind.turn.T, kind.turn @ wanted.settled
    turning = float(np.sqrt(wanted.weights @ (rate**2).sum(axis=1)))
    leaving = max(float(np.linalg.norm(settled)), 1e-300)
    found = copy.copy(objective)
    found.library, found.offsets = None, {name: objective.offsets[name]}
    amplitudes = (wanted.amplitudes[0], turning, leaving)
    found.targets = {name: wanted._replace(rate=rate, settled=settled, amplitudes=amplitudes)}
    return found


def _candidates(best: Kind) -> list[Kind]:
    """Other units and signs, exchanges of two axes, and the ``best`` of a search."""
    simple = [kind for kind in KINDS if 0 < kind.changes <= 2]
    return simple + ([best] if best.changes > 2 else [])
