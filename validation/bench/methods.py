"""The methods of the benchmark and their varied cases. A method has ``settings``, from coarse to fine,
the ``error`` (%) at a setting, and a ``piece``: a call that solves all cases, and whose result ``solved``
counts."""

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from tipoff.lowfi.dynamics import cases
from tipoff.mechanics import books, outcome
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.mechanics.run_limits import SETTLE_WINDOW
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene

TOLERANCES: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
STEPS_S: tuple[float, ...] = tuple(4e-4 / 2.0 ** (0.5 * k) for k in range(14))
_TIGHT = 1e-11
_ABSOLUTE = 1e-3  # of the relative tolerance of solve_ivp, in SI: places of 1e-6 m count
# s, longest step of solve_ivp: longer steps in free flight miss contacts.
_LONGEST = 1e-3
_IN_WINDOW = 201  # samples of solve_ivp
MODELS = {COMPLIANT: "compliant contact", SPRINGS: "springs"}
_AROUND = 3  # samples beyond each end of the window in the spline of the baseline
_SPREAD = {
    "thrust_offset.misalignment": np.deg2rad(0.4),
    "thrust_offset.eccentricity": 0.6e-3,
    "mass_offset.eccentricity": 0.4e-3,
}


def varied(count: int, seed: int = 2024) -> list[dict[str, float]]:
    """Overrides of ``count`` cases: sizes half normal with three sigma as in the paper's Table 3,
    clock angles uniform. SI."""
    random, rows = np.random.default_rng(seed), []
    for _ in range(count):
        row = {}
        for name, three_sigma in _SPREAD.items():
            row[f"{name}.axial"] = abs(float(random.normal(0.0, three_sigma / 3.0)))
            row[f"{name}.radial"] = float(random.uniform(0.0, 2.0 * np.pi))
        rows.append(row)
    return rows


class Population:
    """The varied scenes, their settled rates on a ``model`` at a tight tolerance and the starts of
    their windows (s). All runs have the number of ``modes`` that the pilot of the cases chooses, so
    methods and tolerances are the only difference."""

    def __init__(
        self,
        base: Scene,
        rows: list[dict[str, float]],
        model: str,
        compliance: RailCompliance | None = None,
    ):
        from tipoff.lowfi import Numerics

        self.base, self.rows, self.model, self.compliance = base, rows, model, compliance
        chosen = self.many(rows, Numerics())
        self.modes, self.modes_why = chosen.attrs["modes"], chosen.attrs.get("modes_why", "")
        tight = self.many(rows, Numerics(relative_tolerance=_TIGHT, modes=self.modes))
        self.rates = tight.rate.values
        self.scenes = [base.replace(row) for row in rows]
        marks = outcome.milestones(launch.of_scene(base), base.time_limit)
        self.starts = [outcome.window_start(float(at), marks) for at in tight.exit_time.values]

    def many(self, rows, numerics):
        """The ensemble of ``rows``."""
        from tipoff.lowfi import run_many

        return run_many(self.base, rows, self.model, compliance=self.compliance, numerics=numerics)

    def error(self, rates: np.ndarray) -> float:
        """95th percentile of the errors (%) of ``rates`` (n,3) rad/s; infinite if a rate is not
        finite."""
        if not np.isfinite(rates).all():
            return np.inf
        worst = np.abs(rates - self.rates).max(axis=1) / np.abs(self.rates).max(axis=1)
        return float(np.quantile(worst, 0.95) * 100.0)


class Method(Protocol):
    """A way to solve the cases of a population."""

    name: str
    settings: tuple[float, ...]  # from coarse to fine
    unit: str  # of a setting

    def error(self, setting: float, /) -> float:
        """Error (%) at a setting."""
        ...

    def piece(self, setting: float, /) -> Callable:
        """A call that solves every case."""
        ...

    def solved(self, found, /) -> int:
        """Number of cases that the result of a ``piece`` has to their end."""
        ...


class Surrogate:
    """The surrogate on one model; a setting is a relative tolerance."""

    settings: tuple[float, ...] = TOLERANCES
    unit = "1"

    def __init__(self, population: Population):
        self.population, self.name = population, MODELS[population.model]

    def error(self, tolerance: float) -> float:
        """Error (%) at a tolerance."""
        found = self.population.many(self.population.rows, self._numerics(tolerance))
        return self.population.error(found.rate.values)

    def piece(self, tolerance: float) -> Callable:
        """A call that integrates and evaluates every case; set-up is done before."""
        from tipoff.lowfi.ensemble.batch import Family

        population = self.population
        family = Family(population.base, None, self._numerics(tolerance), population.compliance)
        (job,) = family.kernels(population.rows)

        def call() -> np.ndarray:
            found = job()
            kept = found.copy()
            found[:] = 0.0  # a call that does nothing must not show the results of the one before
            return kept

        return call

    def solved(self, found: np.ndarray) -> int:
        """Cases that the kernel itself followed to the end of their settled windows."""
        ended = np.isfinite(found[:, cases.BOOK + books.DONE]) & (found[:, cases.STEPS] > 0)
        return int((ended & (found[:, cases.LEFT_OPEN] == 0)).sum())

    def whole(self, tolerance: float, **numerics) -> Callable:
        """A call that makes every case a run with curves, with other ``numerics`` if given."""
        from tipoff import lowfi

        population, used = self.population, replace(self._numerics(tolerance), **numerics)
        return lambda: [
            lowfi.run(scene, population.model, compliance=population.compliance, numerics=used)
            for scene in population.scenes
        ]

    def _numerics(self, tolerance: float):
        from tipoff.lowfi import Numerics

        return Numerics.of_many(tolerance, self.population.modes, self.population.model)


class PlainRungeKutta:
    """Fixed steps on springs; a setting is a step (s)."""

    name, unit = "springs, plain Runge-Kutta", "s"
    settings: tuple[float, ...] = STEPS_S

    def __init__(self, population: Population):
        self.population = population

    def error(self, dt: float) -> float:
        """Error (%) at a step."""
        from validation import oracle

        rates = []
        for (arguments, rows, interval), start in zip(self._jobs(dt), self.population.starts):
            oracle.integrate(*arguments)
            rates.append(settled_mean(np.arange(len(rows)) * interval, rows[:, 10:13], start))
        return self.population.error(np.array(rates))

    def piece(self, dt: float) -> Callable:
        """A call that integrates every case past the end of its window."""
        from validation import oracle

        jobs = self._jobs(dt)

        def call() -> list[np.ndarray]:
            for arguments, rows, _ in jobs:
                rows[1:] = np.nan
                oracle.integrate(*arguments)
            return [rows for _, rows, _ in jobs]

        return call

    def solved(self, found: list[np.ndarray]) -> int:
        """Cases with all rows."""
        return sum(bool(np.isfinite(rows).all()) for rows in found)

    def _jobs(self, dt: float) -> list[tuple[tuple, np.ndarray, float]]:
        """For each case the arguments of the integration, the argument ``rows`` that it fills, and
        their interval (s)."""
        from validation import oracle

        jobs = []
        for scene, start in zip(self.population.scenes, self.population.starts):
            count = max(1, round(scene.output.interval / dt))
            interval = dt * count
            samples = int(np.ceil((start + SETTLE_WINDOW) / interval)) + _AROUND
            arguments, rows = oracle.prepared(scene, count, samples, interval)
            jobs.append(((*arguments, rows), rows, interval))
        return jobs


class SolveIvp:
    """SciPy's ``solve_ivp`` (RK45) on springs; a setting is a relative tolerance."""

    name, unit = "springs, solve_ivp of SciPy", "1"
    settings: tuple[float, ...] = TOLERANCES

    def __init__(self, population: Population):
        self.population = population

    def error(self, tolerance: float) -> float:
        """Error (%) at a tolerance."""
        rates = [settled_mean(*solved, start) for solved, start in self._solve(tolerance)]
        return self.population.error(np.array(rates))

    def piece(self, tolerance: float) -> Callable:
        """A call that integrates every case to the end of its window."""
        return lambda: self._solve(tolerance)

    def solved(self, found) -> int:
        """Cases with all samples of their windows."""
        return sum(time.size == _IN_WINDOW for (time, _), _ in found)

    def _solve(self, tolerance: float) -> list[tuple[tuple[np.ndarray, np.ndarray], float]]:
        """Times (s) and rates (n,3) rad/s about the window of each case, and its start (s)."""
        from validation import oracle

        found = []
        for scene, start in zip(self.population.scenes, self.population.starts):
            (system, *inertias, _, _), rows = oracle.prepared(scene, 1, 1, scene.output.interval)

            def slope(time, state, system=system, inertias=inertias):
                return oracle.slope_of(system, *inertias, time, state)

            window = np.linspace(start, start + SETTLE_WINDOW, _IN_WINDOW)
            solution = solve_ivp(
                slope,
                (0.0, window[-1]),
                rows[0],
                t_eval=window,
                rtol=tolerance,
                atol=tolerance * _ABSOLUTE,
                max_step=_LONGEST,
            )
            found.append(((solution.t, solution.y[10:13].T), start))
        return found


def coarsest(settings: tuple[float, ...], error, requested: float) -> tuple[float, float]:
    """The coarsest of ``settings`` (falling) whose error is at most ``requested``, and its error.
    The errors of all finer settings must be so too, because a coarse setting can pass by chance."""
    kept = None
    for setting in reversed(settings):
        found = error(setting)
        if not found <= requested:
            break
        kept = setting, found
    if kept is None:
        raise RuntimeError(
            f"the finest setting, {settings[-1]:g}, has an error above {requested:g} %"
        )
    return kept


def settled_mean(time: np.ndarray, rates: np.ndarray, start: float) -> np.ndarray:
    """Means (3,) of samples ``rates`` (n,3) over the settled window from ``start`` (s), by a cubic
    spline."""
    if not np.isfinite(rates).all():
        return np.full(3, np.nan)
    end = start + SETTLE_WINDOW
    first, last = np.searchsorted(time, [start, end])
    near = slice(max(first - _AROUND, 0), last + _AROUND)
    return CubicSpline(time[near], rates[near]).integrate(start, end) / SETTLE_WINDOW
