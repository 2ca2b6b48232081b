"""Check of curves before their fit is accepted: v_x against the model, and rates under other units,
signs and axes.

After the thrust v_x is impulse over mass, except for friction, which the model contains. So its
ratio to the model's must be 1 within ``VELOCITY``.

Rates are compared by the relative misfit of a transformation T of the curves y, on points f that the
search visited::

    e(T)^2 = (|T y - f|^2 - noise) / max(|T y|^2 - noise, |f|^2)        |a|^2 = int a . a dt

e is 0 for equal curves, about 1 for a wrong unit, and 2 for a wrong sign. T is the identity, a
factor between units, or one of the 47 other permutations of axes with signs. Before the first
contact the rates are those of free flight, which no constant of contact changes. So this part
(``Misfits.flight``) distinguishes a wrong curve from a model error in contact.

A curve is refused in three cases. More than half of its free flight is unexplained (e^2 > 1/2).
Compliant contact explains nothing of the whole (e > 1). Or another T has a much smaller misfit: the
F distribution of the ratio of both mean squares gives it a probability below 1e-3, with
Bonferroni's correction for the number of T. ``intervals.independent`` gives the number of
independent residuals.
"""

import math

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration import rivals
from tipoff.calibration.faults import CalibrationError
from tipoff.calibration.intervals import independent
from tipoff.calibration.misfit import (
    KINDS,
    NEAR,
    Kind,
    Misfits,
    first_touch,
    misfits,
    shape_faults,
    velocity_faults,
)
from tipoff.calibration.objective import Objective, Target, sampled
from tipoff.calibration.offset import Offset, estimate
from tipoff.calibration.posterior import Posterior
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.results.trajectory import Trajectory

HALF = math.sqrt(0.5)  # misfit above which more is unexplained than explained
SAID = 0.1  # misfit above which the verdict states it
NOTHING = 1.0  # misfit above which nothing is explained
_PROBABILITY = 1e-3


class Library:
    """Misfits of all curves on the points of a search."""

    def __init__(self, targets: dict[str, Target], touch: dict[str, float]):
        self.targets, self.touch = targets, touch
        self.points: list[dict[str, Misfits]] = []

    def add(self, runs: dict[str, Trajectory], offsets: dict[str, float]) -> None:
        """Add the misfits of one point."""
        self.points.append(
            {
                name: misfits(wanted, runs[name], offsets[name], self.touch[name])
                for name, wanted in self.targets.items()
            }
        )

    def reasons(
        self, runs: dict[str, Trajectory], offsets: dict[str, float], flight: bool
    ) -> dict[str, tuple[float, Kind, float]]:
        """For each condition whose rates do not fit the ``runs`` at the end of the search: the
        misfit, the likely transformation, and the misfit with it. ``flight`` is False if errors of
        mounting are fitted, which change free flight too."""
        best, found = self._together(), {}
        for name, wanted in self.targets.items():
            own = misfits(wanted, runs[name], offsets[name], self.touch[name])
            count = self._count(name, runs[name], offsets[name])
            reason = self._reason(own, best[name], count, flight)
            if reason is not None:
                found[name] = reason
        return found

    def _together(self) -> dict[str, tuple[Kind, Misfits]]:
        """The transformation of each condition that explains all conditions best with the same
        parameters, and the misfits there."""
        totals, chosen = [], []
        for point in self.points:
            picked = {name: (KINDS[_simplest(found)], found) for name, found in point.items()}
            chosen.append(picked)
            totals.append(sum(_least(found) ** 2 for found in point.values()))
        return chosen[int(np.argmin(totals))]

    def _count(self, name: str, run: Trajectory, offset: float) -> float:
        wanted = self.targets[name]
        left = wanted.rate - sampled(run, wanted.time - offset)[:, 1:]
        return sum(independent(column) for column in left.T)

    def _reason(
        self, own: Misfits, best: tuple[Kind, Misfits], count: float, flight: bool
    ) -> tuple[float, Kind, float] | None:
        """Misfit, likely transformation and its misfit, of refused curves; None for others."""
        kind, there = best
        index = next(number for number, item in enumerate(KINDS) if item is kind)
        bound = scipy.stats.f.isf(_PROBABILITY / len(KINDS), count, count)
        for mine, other in (
            (own.flight if flight else None, there.flight),
            (own.whole, there.whole),
        ):
            if mine is None or other is None:
                continue
            if kind.changes and mine[0] ** 2 > bound * max(other[index] ** 2, 1e-12) > 0.0:
                return float(mine[0]), kind, float(other[index])
        part = own.flight if flight else own.whole
        other = there.flight if flight else there.whole
        if part is None or other is None or part[0] <= HALF or other[0] <= HALF:
            return None
        if other[index] > HALF * part[0]:
            return float(part[0]), KINDS[0], float(part[0])
        return float(part[0]), kind, float(other[index])


def _least(found: Misfits) -> float:
    """Least misfit of a curve over all transformations, both segments together."""
    return min((_both(found, index) for index in range(len(KINDS))), default=0.0)


def _both(found: Misfits, index: int) -> float:
    parts = [part[index] for part in found if part is not None]
    return math.sqrt(sum(part**2 for part in parts) / len(parts)) if parts else 2.0


def _simplest(found: Misfits) -> int:
    """Number of the transformation with the fewest changes among those of about the least misfit."""
    values = [_both(found, index) for index in range(len(KINDS))]
    least = max(min(values), 1e-9)
    near = [index for index, value in enumerate(values) if value <= NEAR * least]
    return min(near, key=lambda index: (KINDS[index].changes, values[index]))


class Bench:
    """Check of the curves of one fit: offsets in time by condition, points of the search, and
    whether the fit keeps free flight."""

    def __init__(self, offsets: dict[str, Offset], library: Library, flight: bool):
        self.offsets, self.library, self.flight = offsets, library, flight

    def ready(self, objective: Objective) -> Objective:
        """``objective`` with the detected offsets and the library of the search."""
        objective.offsets = {
            name: item.value if item.is_seen else 0.0 for name, item in self.offsets.items()
        }
        objective.library = self.library
        return objective

    def require_sound(self, objective: Objective, shares: np.ndarray) -> None:
        """Raise CalibrationError for curves that the fit at ``shares`` (p,) does not explain."""
        runs, found = objective.runs(shares), []
        for name, wanted in objective.targets.items():
            found += shape_faults(name, wanted, runs[name], objective.offsets[name])
        reasons = self.library.reasons(runs, objective.offsets, self.flight)
        for name, (misfit, kind, left) in reasons.items():
            if not self.flight and objective.parameters:
                kind, left = rivals.likely(objective, name, self.library.touch[name])
            other, there = rivals.condition(objective, runs, name, self.library.touch[name])
            if there <= min(NEAR * left, HALF * misfit):
                kind, left = Kind(KINDS[0].turn, 1, f"these are the curves of {other}"), there
            found.append(_sentence(name, misfit, kind if left <= HALF * misfit else KINDS[0], left))
        found += [] if reasons else _unexplained(objective, runs)
        _refuse(objective, found)

    def words(self, objective: Objective, shares: np.ndarray) -> list[str]:
        """Sentences on corrected offsets and on the remaining errors at ``shares`` (p,)."""
        runs = objective.runs(shares)
        found = [
            f"{item.words(name)}, which the fit corrects"
            for name, item in self.offsets.items()
            if item.is_seen
        ]
        return found + _left(objective, runs)

    def verdict(
        self,
        objective: Objective,
        shares: np.ndarray,
        judged: Posterior,
        offsets: dict[str, Offset],
    ) -> str:
        """The verdict of a fit whose values are at ``shares`` (p,), with the fitted ``offsets``."""
        left = _left(objective, objective.runs(shares))
        words = judged.words
        if left and not judged.excludes:
            words = words.replace("nothing needs fitting: ", "", 1)
        late = [
            f"{item.words(name)}, which the fit corrects"
            for name, item in offsets.items()
            if item.is_seen
        ]
        return "; ".join([words, *late, *left])


def before(objective: Objective, moves_free_flight: bool) -> Bench:
    """Check of the curves of an ``objective`` without parameters, before any search.

    Raises CalibrationError for a v_x that differs from the model's and, if the fit keeps free
    flight, for rates that differ from those of free flight.
    """
    none = np.zeros(0)
    runs, wanted = objective.runs(none), objective.targets
    _refuse(
        objective,
        [text for name in wanted for text in velocity_faults(name, wanted[name], runs[name])],
    )
    offsets = {name: estimate(wanted[name], runs[name]) for name in wanted}
    library = Library(wanted, {name: objective_touch(objective, name) for name in wanted})
    bench = Bench(offsets, library, not moves_free_flight)
    bench.ready(objective)
    library.add(runs, objective.offsets)
    if bench.flight:
        bench.require_sound(objective, none)
    return bench


def objective_touch(objective: Objective, name: str) -> float:
    """Time (s) until which pads with half of the clearance do not touch: the fit may find a smaller
    clearance than the scene's."""
    scene = objective.targets[name].scene
    if scene.contact is None:
        return scene.time_limit
    keys = ("clearance", "clearance_y", "clearance_z")
    gaps = {key: getattr(scene.contact, key) for key in keys}
    near = scene.replace({f"contact.{k}": 0.5 * gap for k, gap in gaps.items() if gap is not None})
    return first_touch(objective.alone(near))


def _left(objective: Objective, runs: dict[str, Trajectory]) -> list[str]:
    found = []
    for name, wanted in objective.targets.items():
        misfit = misfits(wanted, runs[name], objective.offsets[name], 0.0).whole
        if misfit is not None and misfit[0] > SAID:
            found.append(
                f"the model differs from the rates of {name} by {100.0 * misfit[0]:.3g} % of their root "
                "mean square, which is model error or an input that is not fitted"
            )
    return found


def _unexplained(objective: Objective, runs: dict[str, Trajectory]) -> list[str]:
    """Sentences on rates of which compliant contact explains nothing: the residual is larger than
    the rates. Springs may have such a residual if contact decides."""
    found = []
    for name, wanted in objective.targets.items() if objective.model == COMPLIANT else ():
        whole = misfits(wanted, runs[name], objective.offsets[name], 0.0).whole
        if whole is not None and whole[0] > NOTHING:
            found.append(_sentence(name, float(whole[0]), KINDS[0], float(whole[0])))
    return found


def _sentence(name: str, misfit: float, kind: Kind, left: float) -> str:
    words = (
        f"Likely cause: {kind.words}, which leaves {100.0 * left:.3g} %"
        if kind.changes
        else "No other unit, sign or axis explains them: thrust, mounting or mass properties are not "
        "those of the scene, a fitted value is beyond its bounds, or another code or test was recorded"
    )
    return (
        f"rates of {name} differ from the model by {100.0 * misfit:.3g} % of their root mean square. "
        f"{words}"
    )


def _refuse(objective: Objective, found: list[str]) -> None:
    if found:
        raise CalibrationError("\n  ".join([f"cannot calibrate {objective.scene.name}", *found]))
