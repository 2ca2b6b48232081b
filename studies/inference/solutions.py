"""Sets of inputs that give the printed rates: many independent searches, everything admissible on their way, and what they trade.

Rates are discontinuous in the inputs, since an impact more or less changes them by degrees per second, and smooth between. So a
search

1. draws points of the unit cube and follows the best of them with CMA-ES (Hansen) on the rough misfit of five runs, far and wide;
2. goes down the basin it ended in by least squares, which there are few residuals for and many inputs;
3. follows CMA-ES again from close by, since that basin has edges, and at last on the sum of squares of all 69 residuals of 23 runs.

A search that ends badly is shown like one that ends well.

Nine rates and fifty-four small deviations cannot tell twenty inputs. What is kept is therefore a set: every point of a search at
which no printed rate is missed by more than ``ADMISSIBLE``, thinned; an input is told as far as the set is narrower than its
bounds.
"""

from typing import Callable, NamedTuple

import cma
import numpy as np
from scipy.optimize import least_squares

from calibrate.information import jacobian
from studies.inference import misfit
from studies.inference.inputs import UNKNOWNS

ADMISSIBLE = 0.1  # deg/s: a third of what the paper calls negligible

_POPULATION = 60  # of CMA-ES: with 20, its default here, searches end in basins a third worse
_FAR, _NEAR, _CLOSE = 0.25, 0.05, 0.005  # its first steps, of the bounds
_INSIDE = 1e-3  # of the bounds, for least squares cannot begin on one
_FINE_COST = 5  # runs of a fine evaluation over those of a rough one


class Plan(NamedTuple):
    """Size of a search: ``points`` drawn; evaluations of CMA-ES far and wide, ``descents`` of least squares, evaluations of CMA-ES
    ``near`` their end, all of 5 runs, and ``fine`` ones of 23; points ``kept``; tolerances of rough and fine runs (relative error
    of a step)."""

    points: int = 400
    rough: int = 20000
    descents: int = 60
    near: int = 12000
    fine: int = 1200
    kept: int = 40
    tolerances: tuple[float, float] = (1e-3, 1e-5)


class Search(NamedTuple):
    """Where a search of one ``stress`` (the weight of the rates that should be negligible) and ``seed`` ended: shares (p,), rates
    (5,3) and ``changed`` (3,6,3) deg/s there; the ``admissible`` points (n,p) it met; and the ``front`` (m,2) of what it traded,
    deg/s: largest error of a printed rate, largest rate of conditions 1 and 5."""

    stress: float
    seed: int
    shares: np.ndarray
    rates: np.ndarray
    changed: np.ndarray
    admissible: np.ndarray
    front: np.ndarray


class _Seen:
    """Points a search met, as (largest error of the nine, largest rate at 1 and 5, shares)."""

    def __init__(self):
        self.errors, self.sizes, self.shares = [], [], []

    def add(self, shares: np.ndarray, rates: np.ndarray) -> None:
        self.errors.append(float(np.abs(misfit.nine(rates)).max()))
        self.sizes.append(largest_negligible(rates))
        self.shares.append(shares)

    def admissible(self, kept: int) -> np.ndarray:
        found = np.array([point for error, point in zip(self.errors, self.shares)
                          if error <= ADMISSIBLE]).reshape(-1, len(UNKNOWNS))
        return found[np.linspace(0, len(found) - 1, min(kept, len(found))).round().astype(int)]


def run(launcher_of: Callable[[float], misfit.Launcher], stress: float, seed: int, plan: Plan = Plan(),
        progress: Callable[[float], None] | None = None) -> Search:
    """One search; the same seed gives the same bits. ``launcher_of`` makes the surrogate for a tolerance; ``progress`` takes 0 to
    1."""
    generator, seen, done = np.random.default_rng([seed, 7]), _Seen(), 0
    coarse, fine = map(launcher_of, plan.tolerances)
    whole = plan.points + plan.rough + plan.descents * (2 * len(UNKNOWNS) + 1) + plan.near + _FINE_COST * plan.fine

    def seen_rates(launcher: misfit.Launcher, shares: np.ndarray, cost: int) -> np.ndarray:
        nonlocal done
        rates, done = launcher.rates(shares), done + cost
        seen.add(shares, rates)
        if progress:
            progress(min(1.0, done / whole))
        return rates

    def rough(shares: np.ndarray) -> float:
        return misfit.rough(seen_rates(coarse, shares, 1), stress)

    def few(shares: np.ndarray) -> np.ndarray:
        rates = seen_rates(coarse, shares, 1)
        return np.append(misfit.nine(rates), stress * misfit.excess(rates)) / misfit.NEGLIGIBLE

    def exact(shares: np.ndarray) -> float:
        rates = seen_rates(fine, shares, _FINE_COST)
        return float((misfit.residuals(rates, fine.changed(shares), stress) ** 2).sum())

    points = generator.random((plan.points, len(UNKNOWNS)))
    start = points[int(np.argmin([rough(point) for point in points]))]
    far = _evolved(rough, start, _FAR, plan.rough, generator)
    down = least_squares(few, np.clip(far, _INSIDE, 1.0 - _INSIDE), lambda x: jacobian(few, x), bounds=(0.0, 1.0), loss="soft_l1",
                         max_nfev=plan.descents).x
    near = _evolved(rough, down, _NEAR, plan.near, generator)
    end = _evolved(exact, near, _CLOSE, plan.fine, generator)
    return Search(stress, seed, end, fine.rates(end), fine.changed(end), seen.admissible(plan.kept), front(seen.errors, seen.sizes))


def _evolved(objective, start: np.ndarray, spread: float, evaluations: int, generator: np.random.Generator) -> np.ndarray:
    """Best point CMA-ES meets from ``start``; it draws from ``generator`` only."""
    strategy = cma.CMAEvolutionStrategy(start, spread, {
        "bounds": [0.0, 1.0], "popsize": _POPULATION, "maxfevals": evaluations, "tolfun": 1e-4, "verbose": -9, "seed": np.nan,
        "randn": lambda *shape: generator.standard_normal(shape)})
    while not strategy.stop():
        candidates = [np.asarray(point) for point in strategy.ask()]
        strategy.tell(candidates, [objective(point) for point in candidates])
    return np.asarray(strategy.result.xbest)


def front(errors, sizes) -> np.ndarray:
    """Pairs (m,2), ascending in the first, of which no other pair is smaller in both."""
    pairs = np.column_stack([errors, sizes])
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    best = np.minimum.accumulate(pairs[:, 1])
    first = np.append(True, best[1:] < best[:-1])
    return pairs[first]


def largest_negligible(rates: np.ndarray) -> float:
    """Largest rate (deg/s) of conditions 1 and 5."""
    return float(np.abs(rates[[0, 4]]).max())


def plain(found: Search) -> dict:
    """A search as JSON."""
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in found._asdict().items()}


def restored(document: dict) -> Search:
    """Inverse of ``plain``; keys that are none of a search's are passed over."""
    values = {name: np.array(document[name]) if isinstance(document[name], list) else document[name] for name in Search._fields}
    return Search(**values)._replace(admissible=values["admissible"].reshape(-1, len(UNKNOWNS)))
