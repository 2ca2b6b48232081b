"""Sets of inputs that give the printed rates: independent searches, their admissible points, and
the Pareto front.

Rates are smooth in the inputs as long as the impacts are the same; one impact more or less changes them
by degrees per second. Such a smooth region is a basin. In a basin with a point of zero residuals,
Gauss-Newton steps reach this point, because there are fewer residuals than inputs. Basin hopping tries
many basins (Wales and Doye, J. Phys. Chem. A 101 (1997) 5111). A search

1. draws points of the unit cube, minimises the rates of five runs by least squares from the best of
   them, and keeps a pool of ends;
2. moves one of the pool at random by a small or large step, in some inputs or in all, minimises
   from there, and replaces it if the end is better;
3. minimises all 69 residuals of 23 runs from each of the pool, and ends with the best.

Better means a smaller misfit of all 69 residuals: an end near the edge of its basin can give the nine
rates, but not the rates with a contact constant changed by some percent. Searches with a bad end are
shown too.

Nine rates and 54 small deviations cannot determine twenty inputs. So the result is a set: all ends at
which every error of a printed rate or deviation is at most ``ADMISSIBLE``. An input is determined as far
as the set is narrower than its bounds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from validation.paper import misfit
from validation.paper.inputs import UNKNOWNS

ADMISSIBLE = misfit.NEGLIGIBLE

_MOVES = (0.01, 0.03, 0.06, 0.12)  # standard deviations of a hop, of the bounds
_SOME = 0.25  # probability that an input moves, in every other hop
_INSIDE = 1e-3  # of the bounds: least squares cannot start on a bound
# of the bounds: above the scatter of runs at the middle tolerance, below the size of a basin
_DIFFERENCE = 5e-4
_WORK = {"point": 0.02, "descent": 2.0, "hop": 1.0, "end": 10.0}  # shares of the time, in hops


@dataclass(frozen=True)
class Plan:
    """Size of a search: ``points`` drawn, ``descents`` from the best of them, ends in the ``pool``,
    ``hops``, admissible points ``kept``; ``steps`` of a descent from a drawn point, from a hop, and
    of the last descent; ``tolerances`` (relative error of a step) of drawn points, of descents and
    of the reported end."""

    points: int = 2000
    descents: int = 24
    pool: int = 6
    hops: int = 250
    kept: int = 40
    steps: tuple[int, int, int] = (25, 12, 25)
    tolerances: tuple[float, float, float] = (1e-3, 1e-4, 1e-5)


class Search(NamedTuple):
    """End of a search with one ``stress`` (weight of the rates that should be negligible) and
    ``seed``: shares (p,), rates (5,3) and ``changed`` (3,6,3) deg/s; its ``admissible`` points
    (n,p); its Pareto ``front`` (m,2) in deg/s: largest error of a printed rate, largest rate of
    conditions 1 and 5."""

    stress: float
    seed: int
    shares: np.ndarray
    rates: np.ndarray
    changed: np.ndarray
    admissible: np.ndarray
    front: np.ndarray


class _End(NamedTuple):
    """A point and its misfit."""

    misfit: float
    shares: np.ndarray


def run(
    launcher_of: Callable[[float], misfit.Launcher],
    stress: float,
    seed: int,
    plan: Plan = Plan(),
    progress: Callable[[float], None] | None = None,
) -> Search:
    """One search; the same seed gives the same bits. ``launcher_of`` makes the surrogate for a
    tolerance; ``progress`` takes 0 to 1."""
    generator = np.random.default_rng([seed, 7])
    rough, middle, fine = map(launcher_of, plan.tolerances)
    walk = _Walk(rough, middle, fine, stress, plan, progress)
    points = generator.random((plan.points, len(UNKNOWNS)))
    order = np.argsort([walk.first(point) for point in points], kind="stable")
    pool = sorted(
        (walk.end(points[number], plan.steps[0], "descent") for number in order[: plan.descents]),
        key=lambda end: end.misfit,
    )
    pool = pool[: plan.pool]
    for _ in range(plan.hops):
        place = min(int(generator.exponential(1.5)), len(pool) - 1)  # better ends more often
        moves = generator.choice(_MOVES) * generator.standard_normal(len(UNKNOWNS))
        some = generator.random(len(UNKNOWNS)) < generator.choice([_SOME, 1.0])
        end = walk.end(np.clip(pool[place].shares + moves * some, 0.0, 1.0), plan.steps[1], "hop")
        if end.misfit < pool[place].misfit:
            pool[place] = end
            pool.sort(key=lambda item: item.misfit)
    best = min((walk.last(end, plan.steps[2]) for end in pool), key=lambda end: end.misfit).shares
    return Search(
        stress,
        seed,
        shares=best,
        rates=fine.rates(best),
        changed=fine.changed(best),
        admissible=walk.admissible(plan.kept),
        front=front(walk.errors, walk.sizes),
    )


class _Walk:
    """Descents of one search, with the results at their ends."""

    def __init__(
        self,
        rough: misfit.Launcher,
        middle: misfit.Launcher,
        fine: misfit.Launcher,
        stress: float,
        plan: Plan,
        progress,
    ):
        self.rough, self.middle, self.fine, self.stress, self._progress = (
            rough,
            middle,
            fine,
            stress,
            progress,
        )
        self.errors: list[float] = []
        self.sizes: list[float] = []
        self._met: list[np.ndarray] = []
        self._done = 0.0
        self._whole = sum(
            _WORK[kind] * count
            for kind, count in zip(_WORK, (plan.points, plan.descents, plan.hops, plan.pool))
        )

    def first(self, shares: np.ndarray) -> float:
        """Misfit of a drawn point."""
        self._book("point")
        return misfit.rough(self.rough.rates(shares), self.stress)

    def end(self, shares: np.ndarray, steps: int, kind: str) -> _End:
        """Descent with the residuals of the rates alone."""

        def few(point: np.ndarray) -> np.ndarray:
            rates = self.middle.rates(point)
            return (
                np.append(misfit.nine(rates), self.stress * misfit.excess(rates))
                / misfit.NEGLIGIBLE
            )

        found = self._judged(_down(few, shares, steps))
        self._book(kind)
        return found

    def last(self, end: _End, steps: int) -> _End:
        """Descent with all residuals, or ``end`` itself if that is better."""

        def every(point: np.ndarray) -> np.ndarray:
            return misfit.residuals(
                self.middle.rates(point), self.middle.changed(point), self.stress
            )

        found = self._judged(_down(every, end.shares, steps))
        self._book("end")
        return min(end, found, key=lambda item: item.misfit)

    def admissible(self, kept: int) -> np.ndarray:
        """At most ``kept`` of the admissible points (n,p), spread evenly from first to last."""
        found = np.array(self._met).reshape(-1, len(UNKNOWNS))
        return found[np.linspace(0, len(found) - 1, min(kept, len(found))).round().astype(int)]

    def _judged(self, shares: np.ndarray) -> _End:
        rates, changed = self.middle.rates(shares), self.middle.changed(shares)
        self.errors.append(float(np.abs(misfit.nine(rates)).max()))
        self.sizes.append(largest_negligible(rates))
        if max(self.errors[-1], largest_of_deviations(rates, changed)) <= ADMISSIBLE:
            self._met.append(shares)
        return _End(misfit.whole(rates, changed, self.stress), shares)

    def _book(self, kind: str) -> None:
        self._done += _WORK[kind]
        if self._progress:
            self._progress(min(1.0, self._done / self._whole))


def _down(
    residuals: Callable[[np.ndarray], np.ndarray], start: np.ndarray, steps: int
) -> np.ndarray:
    """End of least squares after at most ``steps``."""

    def slopes(point: np.ndarray) -> np.ndarray:
        here, columns = residuals(point), []
        for i in range(point.size):
            beside = point.copy()
            beside[i] += _DIFFERENCE if point[i] + _DIFFERENCE <= 1.0 else -_DIFFERENCE
            columns.append((residuals(beside) - here) / (beside[i] - point[i]))
        return np.column_stack(columns)

    return least_squares(
        residuals,
        np.clip(start, _INSIDE, 1.0 - _INSIDE),
        slopes,
        bounds=(0.0, 1.0),
        loss="soft_l1",
        max_nfev=steps,
    ).x


def front(errors, sizes) -> np.ndarray:
    """Pairs (m,2), ascending in the first value, for which no other pair is smaller in both values."""
    pairs = np.column_stack([errors, sizes])
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    best = np.minimum.accumulate(pairs[:, 1])
    first = np.append(True, best[1:] < best[:-1])
    return pairs[first]


def largest_negligible(rates: np.ndarray) -> float:
    """Largest rate (deg/s) of conditions 1 and 5."""
    return float(np.abs(rates[[0, 4]]).max())


def largest_of_deviations(rates: np.ndarray, changed: np.ndarray) -> float:
    """Largest error (deg/s) of the 54 deviations."""
    return float(np.abs(misfit.deviations(rates, changed)).max())


def plain(found: Search) -> dict:
    """A search as JSON."""
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in found._asdict().items()
    }


def restored(document: dict) -> Search:
    """Inverse of ``plain``; other keys are ignored."""
    return Search(
        stress=document["stress"],
        seed=document["seed"],
        shares=np.array(document["shares"]),
        rates=np.array(document["rates"]),
        changed=np.array(document["changed"]),
        admissible=np.array(document["admissible"]).reshape(-1, len(UNKNOWNS)),
        front=np.array(document["front"]),
    )
