"""The posterior of a calibration: what its constants may be, given that the surrogate is wrong (``calibrate.discrepancy``).

    p(theta | y)  is proportional to  p(y | theta) on the bounds of the parameters, zero outside

The prior is uniform in the shares of the bounds, logarithmic for the parameters searched so. What a fit holds because the curves
hardly know it varies here, over its bounds, so that nothing rests on the value it is held at. A constant whose posterior is as wide
as its prior has been told nothing, and gets no interval. The fit weighs quantities by the accuracy that is wanted of them, the
posterior by how wrong the surrogate is about each; so a calibrated value may lie outside its interval, which is then said.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import Callable, NamedTuple

import numpy as np

import lowfi
from calibrate import chain, discrepancy, faults, motion, parameters
from calibrate.curves import Curves
from calibrate.information import information, jacobian
from calibrate.intervals import deviations
from calibrate.objective import Objective, Parts, targets
from calibrate.parameters import Parameter
from calibrate.posterior_record import Posterior
from calibrate.profile import profile
from scenes.calibration import Calibration
from scenes.scene import Scene
from scenes.trajectory import Trajectory
from scenes.walls import Walls

INTERVAL = 5e-4  # s; a touch lasts milliseconds
TOLERANCE = 1e-4  # moves settled rates by 1e-3 of what the surrogate misses
QUANTILES = (0.025, 0.5, 0.975)
UNTOLD = 0.9  # of the prior's standard deviation, from which on a posterior is the prior
_PRIOR_DEVIATION = 1.0 / np.sqrt(12.0)
_ON_BOUND = 0.01  # share of the bounds within which an end of an interval lies on one
_CHAIN_SHARE = 0.85  # of the time, for progress


class Effort(NamedTuple):
    """Size of the chain, and of the profiles: ``points`` a parameter, evaluations ``per_point``; and how many draws are ``kept``
    for what comes after: of 500 the ends of an interval are known to some per cent of its width."""

    sampling: chain.Plan = chain.Plan()
    points: int = 9
    per_point: int = 40
    kept: int = 500

    def evaluations(self, count: int) -> int:
        """How many times all conditions are run for so many parameters, at most."""
        return self.sampling.walkers * self.sampling.steps + count * self.points * self.per_point + self.kept


def posterior(scene: Scene, references: dict[str, Trajectory | Curves], calibration: Calibration,
              progress: Callable[[float], None] | None = None, seed: int = 0, effort: Effort | None = None,
              walls: Walls | None = None, workers: int = 1) -> Posterior:
    """Draws around ``calibration``, found for ``references`` (condition name to reference run or curves) of ``scene``.

    Takes about two minutes for five conditions; ``progress`` is called with the fraction done, at least, and the same seed gives
    the same bits, however many ``workers`` run conditions side by side. A warm scene asks for its rigid ``walls`` (``lowfi.run``).
    Raises CalibrationError for references nothing can be fitted to, SceneError for a warm scene without walls.
    """
    faults.check(scene, references)
    items = parameters.free(scene) + parameters.held(scene)
    curves = {name: thinned(item if isinstance(item, Curves) else Curves.from_trajectory(item))
              for name, item in references.items()}
    sampled, numerics = scene.replace({"output.interval": INTERVAL}), lowfi.Numerics(relative_tolerance=TOLERANCE)
    with ThreadPoolExecutor(workers) as pool:
        objective = Objective(sampled, targets(sampled, curves), items, numerics, pool.map, motion.run, walls)
        found = _entries(objective, _best(scene, calibration, items), [item.touches for item in curves.values()],
                         progress or (lambda fraction: None), seed, effort or Effort())
    return Posterior(**found, draws=_columns(scene, found["samples"]), conditions=list(curves))


def _entries(objective: Objective, best: np.ndarray, touches: list[int | None], report: Callable[[float], None], seed: int,
             effort: Effort) -> dict:
    """Entries of the record but those that name scene and conditions, around the ``best`` shares (p,)."""
    items, left = objective.parameters, list(objective.parts(best).values())
    error = discrepancy.error(left, touches)

    def density(shares: np.ndarray) -> float:
        squares = discrepancy.squares(list(objective.parts(shares).values()))
        return float(discrepancy.log_likelihood(squares, error.counts))

    known = _known(objective, best, left, error)
    drawn = chain.sample(density, _start(best, known, effort.sampling.walkers, seed), effort.sampling, seed,
                         lambda fraction: report(_CHAIN_SHARE * fraction))
    shares = drawn.shares.reshape(-1, best.size)
    profiles = _profiles(density, items, shares, drawn.density.ravel(), effort, report)
    kept = shares[np.linspace(0, len(shares) - 1, min(effort.kept, len(shares))).round().astype(int)]
    settled = [settled_sizes([part.settled for part in objective.parts(each).values()]) for each in kept]
    report(1.0)
    return told(items, shares, best) | {
        "without": _without(items, best, known, error), "errors": _errors(left, error),
        "chain": _chain(drawn, seed, objective.evaluations), "profile": profiles,
        "samples": {item.name: _values(item, column) for item, column in zip(items, kept.T)},
        "settled_size": np.array(settled).tolist(), "settled_freedom": len(left) + discrepancy.FREEDOM}


def _profiles(density: Callable[[np.ndarray], float], items: list[Parameter], shares: np.ndarray, values: np.ndarray,
              effort: Effort, report: Callable[[float], None]) -> dict[str, dict]:
    """By parameter, values and how far the log likelihood drops there, from draws (k,p) and their log densities (k,)."""
    found = {}
    for index, item in enumerate(items):
        grid, largest = profile(density, shares, values, index, effort.points, effort.per_point)
        found[item.name] = {"value": _values(item, grid), "drop": (largest - np.max(largest)).tolist()}
        report(_CHAIN_SHARE + (0.97 - _CHAIN_SHARE) * (index + 1) / len(items))
    return found


def thinned(curves: Curves) -> Curves:
    """The same curves at multiples of 0.5 ms, where the surrogate has samples too: neither is read between two of those."""
    first, last = np.ceil(curves.time[0] / INTERVAL - 1e-9), np.floor(curves.time[-1] / INTERVAL + 1e-9)
    time = INTERVAL * np.arange(first, last + 1.0)
    return curves._replace(time=time, velocity=np.interp(time, curves.time, curves.velocity),
                           rate=np.column_stack([np.interp(time, curves.time, column) for column in curves.rate.T]))


def settled_sizes(errors: list[np.ndarray]) -> np.ndarray:
    """Size (3,) of the discrepancy of settled rates, from their errors (3,) in each condition relative to |w_s|; with the prior of
    ``calibrate.discrepancy`` a scaled t of ``settled_freedom`` degrees of freedom then describes a rate not seen."""
    sums = np.square(errors).sum(axis=0) + discrepancy.FREEDOM * discrepancy.SMALLEST[1:] ** 2
    return np.sqrt(sums / (len(errors) + discrepancy.FREEDOM))


def _best(scene: Scene, calibration: Calibration, items: list[Parameter]) -> np.ndarray:
    """The calibrated constants, and what was held, as shares of the bounds."""
    values = dict(zip(calibration.parameters, calibration.values))
    return np.clip([item.share(values[item.name] if item.name in values else item.read(scene)) for item in items], 0.0, 1.0)


def _known(objective: Objective, best: np.ndarray, left: list[Parts], error: discrepancy.Error) -> np.ndarray:
    """Information J'J (4,p,p) of the curves of each quantity, every sample weighing 1/(n s_q^2), counted as N_cq samples."""
    size = discrepancy.sizes(discrepancy.squares(left), error.counts)

    def weighted(shares: np.ndarray) -> np.ndarray:
        parts = objective.parts(shares).values()
        roots = np.sqrt(error.counts) / size
        curves = [(part.velocity, *part.rate.T) for part in parts]
        return np.concatenate([root * curve for row, roots_ in zip(curves, roots) for root, curve in zip(roots_, row)])

    slopes = jacobian(weighted, best)
    quantity = np.concatenate([np.repeat(np.arange(4), int(count)) for count in error.samples])
    return np.array([information(slopes[quantity == index]) for index in range(4)])


def _start(best: np.ndarray, known: np.ndarray, walkers: int, seed: int) -> np.ndarray:
    """Walkers (w,p) from the linear posterior, in which the prior counts by its variance; folded back into the unit cube."""
    values, vectors = np.linalg.eigh(known.sum(axis=0) + np.eye(best.size) / _PRIOR_DEVIATION**2)
    fresh = np.random.default_rng([seed, 1]).standard_normal((walkers, best.size))
    away = np.abs(best + fresh / np.sqrt(values) @ vectors.T) % 2.0
    return np.minimum(away, 2.0 - away)


def _without(items: list[Parameter], best: np.ndarray, known: np.ndarray, error: discrepancy.Error) -> list[list[float] | None]:
    """Linear 95 % intervals if every sample were noise of its own, about a model that is right; None where that tells nothing."""
    every = error.samples.sum() / error.counts.sum(axis=0)
    half = 1.96 * deviations((known * every[:, None, None]).sum(axis=0), 1.0)
    return [_values(item, [max(0.0, share - width), min(1.0, share + width)]) if width < 0.5 else None
            for item, share, width in zip(items, best, half)]


def told(items: list[Parameter], shares: np.ndarray, best: np.ndarray) -> dict:
    """Intervals, and in words what the draws (k,p) do not tell."""
    low, middle, high = np.quantile(shares, QUANTILES, axis=0)
    spread = shares.std(axis=0) / _PRIOR_DEVIATION
    intervals, notes = [], []
    for item, ends, wide, found in zip(items, zip(low, high), spread, best):
        if wide >= UNTOLD:
            intervals.append(None)
            notes.append(f"{item.name}: its posterior is its prior ({wide:.2f} of the prior's standard deviation): the curves do "
                         "not tell it, and it has no interval")
            continue
        intervals.append(_values(item, ends))
        if bound := "lower" if ends[0] < _ON_BOUND else "upper" if ends[1] > 1.0 - _ON_BOUND else "":
            at = f"{getattr(item, bound):.4g}{'' if item.unit == '1' else f' {item.unit}'}"
            notes.append(f"{item.name}: the interval ends at its {bound} bound {at}, which physics sets, not the curves")
        elif not ends[0] <= found <= ends[1]:
            notes.append(f"{item.name}: calibrated to {item.value(float(found)):.4g}, outside its interval: the fit weighs "
                         "quantities by the accuracy wanted of them, the posterior by how wrong the surrogate is about each")
    unit = (shares - shares.mean(axis=0)) / np.maximum(shares.std(axis=0), np.finfo(float).tiny)
    return {"parameters": [item.name for item in items], "units": [item.unit for item in items],
            "lower": [item.lower for item in items], "upper": [item.upper for item in items],
            "logarithmic": [item.logarithmic for item in items],
            "best": [_values(item, [share])[0] for item, share in zip(items, best)],
            "median": [_values(item, [share])[0] for item, share in zip(items, middle)], "intervals": intervals,
            "spread": spread.tolist(), "notes": notes, "correlation": (unit.T @ unit / len(unit)).tolist()}


def _values(item: Parameter, shares) -> list[float]:
    return [item.value(float(share)) for share in shares]


def _errors(left: list[Parts], error: discrepancy.Error) -> dict:
    size = discrepancy.sizes(discrepancy.squares(left), error.counts)
    return {name: {"relative_size": float(size[index]), "correlation_time_s": float(INTERVAL * error.times[index]),
                   "independent": float(error.counts[:, index].sum()), "samples": int(error.samples.sum())}
            for index, name in enumerate(discrepancy.QUANTITIES)}


def _chain(drawn: chain.Chain, seed: int, evaluations: int) -> dict:
    return {"seed": seed, "walkers": int(drawn.shares.shape[1]), "steps": drawn.steps, "kept": len(drawn.shares),
            "accepted": drawn.accepted, "autocorrelation_steps": drawn.autocorrelation.tolist(), "effective": drawn.effective,
            "evaluations": evaluations, "doubts": drawn.doubts}


def _columns(scene: Scene, samples: dict[str, list[float]]) -> dict[str, list[float]]:
    """Dotted overrides of every draw, by key, from its parameters by name."""
    rows = [parameters.overrides(scene, dict(zip(samples, values))) for values in zip(*samples.values())]
    return {key: [row[key] for row in rows] for key in rows[0]}
