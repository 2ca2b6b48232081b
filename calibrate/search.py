"""Global minimum of a sum of squares with small jumps on the unit cube.

1. Sobol' points (scrambled by the seed) and the scene's constants find the basins.
2. CMA-ES (Hansen) starts at the best points that are apart from each other. It crosses jumps that
   would stop a gradient method.
3. Trust-region least squares starts at the end of each, and at the scene's constants. It converges
   faster than CMA-ES near the minimum.

Starts that end in one point show that there is one basin.

For one parameter, CMA-ES cannot be used. The points then scan the interval, and a bounded scalar
search (Brent) descends between the neighbours of the lowest local minima of the scan.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration.information import jacobian


class Plan(NamedTuple):
    """Size of a search. With one parameter, ``starts`` are the local minima from which the scalar
    search descends."""

    points: int = 128  # Sobol' points, a power of two
    starts: int = 3  # of CMA-ES
    evaluations: int = 100  # of each start
    apart: float = 0.2  # least distance between starts
    step: float = 0.1  # first step of CMA-ES
    polish: int = 8  # iterations of least squares from each start
    seed: int = 0  # of the points and of CMA-ES


class Found(NamedTuple):
    """Result of a search."""

    shares: np.ndarray  # (p,) best point
    value: float  # at the best point
    basins: list[tuple[float, np.ndarray]]  # end of each start, (value, point), best first


def search(
    residuals: Callable[[np.ndarray], np.ndarray],
    first: np.ndarray,
    plan: Plan,
    progress: Callable[[float], None] | None = None,
) -> Found:
    """Minimise r'r over the unit cube; ``first`` (p,) is tried too. The same seed gives the same
    bits.

    ``progress`` is called with the fraction of the evaluations done.
    """
    from scipy.stats import qmc  # slow to load, and only calibration needs it

    counted = _Counted(residuals, evaluations(first.size, plan), progress)
    points = np.vstack(
        [np.clip(first, 0.0, 1.0), qmc.Sobol(first.size, rng=plan.seed).random(plan.points)]
    )
    values = np.array([counted.square(point) for point in points])
    generator = np.random.default_rng([plan.seed, 1])
    starts: list[tuple[float, np.ndarray]] = [(float(values[0]), points[0])]
    if first.size == 1:
        starts += _scalar(counted.square, points[:, 0], values, plan)
    else:
        starts += [
            _evolve(counted.square, float(values[index]), points[index], plan, generator)
            for index in _apart(points, values, plan)
        ]
    ends = [_polish(counted, *start, plan) for start in starts]
    basins = sorted(ends, key=lambda item: item[0])
    if progress:
        progress(1.0)
    return Found(basins[0][1], basins[0][0], basins)


def evaluations(parameters: int, plan: Plan | None = None) -> int:
    """Approximate number of evaluations of a search."""
    plan = plan or Plan()
    polish = plan.polish * (2 * parameters + 1)
    return plan.points + 1 + polish + plan.starts * (plan.evaluations + polish)


class _Counted:
    """Residuals that report how many of ``total`` evaluations are done."""

    def __init__(self, residuals, total: int, progress):
        self.residuals, self.total, self.progress, self.done = residuals, total, progress, 0

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        vector = self.residuals(shares)
        self.done += 1
        if self.progress:
            self.progress(min(1.0, self.done / self.total))
        return vector

    def square(self, shares: np.ndarray) -> float:
        vector = self(shares)
        return float(vector @ vector)


def _apart(points: np.ndarray, values: np.ndarray, plan: Plan) -> list[int]:
    """Numbers of the best points of which no two are closer than ``plan.apart`` in every
    coordinate."""
    chosen: list[int] = []
    for index in np.argsort(values, kind="stable").tolist():
        if all(np.abs(points[index] - points[other]).max() >= plan.apart for other in chosen):
            chosen.append(index)
        if len(chosen) == plan.starts:
            break
    return chosen


def _scalar(
    objective, points: np.ndarray, values: np.ndarray, plan: Plan
) -> list[tuple[float, np.ndarray]]:
    """Values and points that a bounded scalar search reaches from the lowest local minima of a scan
    at ``points`` (n,) with ``values`` (n,). It searches between the neighbours of each minimum."""
    places, index = np.unique(points, return_index=True)
    heights = np.concatenate([[np.inf], values[index], [np.inf]])
    around = np.concatenate([[0.0], places, [1.0]])
    # a plateau, if a parameter has no effect, counts once, by its first point
    lowest = np.flatnonzero((heights[1:-1] < heights[:-2]) & (heights[1:-1] <= heights[2:])) + 1
    found = []
    for place in lowest[np.argsort(heights[lowest], kind="stable")][: plan.starts].tolist():
        end = scipy.optimize.minimize_scalar(
            lambda share: objective(np.array([share])),
            bounds=(around[place - 1], around[place + 1]),
            method="bounded",
            options={"maxiter": plan.evaluations, "xatol": 1e-6},
        )
        start = (float(heights[place]), np.array([around[place]]))
        found.append((float(end.fun), np.array([float(end.x)])) if end.fun < start[0] else start)
    return found


def _evolve(
    objective, value: float, start: np.ndarray, plan: Plan, generator: np.random.Generator
) -> tuple[float, np.ndarray]:
    """Value and point that CMA-ES reaches from ``start``, whose ``value`` is known. Random numbers
    come only from ``generator``, never from NumPy's global state."""
    import cma  # loads matplotlib

    strategy = cma.CMAEvolutionStrategy(
        start,
        plan.step,
        {
            "bounds": [0.0, 1.0],
            "maxfevals": plan.evaluations,
            "tolfun": 1e-9,
            "tolx": 1e-6,
            "verbose": -9,
            "seed": np.nan,
            "randn": lambda *shape: generator.standard_normal(shape),
        },
    )
    while not strategy.stop():
        candidates = strategy.ask()
        strategy.tell(candidates, [objective(np.asarray(candidate)) for candidate in candidates])
    if strategy.result.fbest >= value:  # it never tries its start
        return value, start
    return float(strategy.result.fbest), np.asarray(strategy.result.xbest)


def _polish(residuals, value: float, shares: np.ndarray, plan: Plan) -> tuple[float, np.ndarray]:
    """Value and point that least squares reaches, or the given ones without an improvement."""
    found = scipy.optimize.least_squares(
        residuals, shares, lambda x: jacobian(residuals, x), bounds=(0.0, 1.0), max_nfev=plan.polish
    )
    return (2.0 * float(found.cost), found.x) if 2.0 * found.cost < value else (value, shares)
