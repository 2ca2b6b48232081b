"""Speed of the surrogate at a stated error, by itself and in ensembles, against plain Runge-Kutta
of order four with fixed steps.

Both solve the same varied cases of the reference scene, drawn as in a Monte Carlo study. The error
of a case is the largest error of its settled rate over the axes, against a run with a tight
tolerance and relative to the largest rate. Each method uses its coarsest setting for which, and for
all finer ones, the 95th percentile is within the requested error. Times are processor times of one
core: for the surrogate from the records to the settled values, with the detection of the exit; for
the baseline only the integration, to a given end of the window.
"""

import resource
import statistics
import time
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from tipoff.files import write_json
from tipoff.mechanics import model, outcome
from tipoff.scenes.scene import Scene, load
from tipoff.studies.core import machine
from tipoff.studies.core.progress import say

REQUESTED = (1.0, 0.1)  # per cent of the settled rate
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
STEPS_S = tuple(4e-4 / 2.0 ** (0.5 * k) for k in range(14))
_TIGHT = 1e-11
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


def run(out: Path, cases: int = 2000, few: int = 20, repeats: int = 5) -> dict:
    """``single``, one row for each requested error, and ``ensemble``; writes
    ``out``/bench/lowfi.json."""
    base, rows = load("reference"), varied(few)
    population = _Population(base, rows)
    single = [_single(population, requested, repeats) for requested in REQUESTED]
    found = {
        "single": single,
        "ensemble": _ensemble(base, cases, single[0]["tolerance"]),
        "varied_cases": few,
        "repeats": repeats,
        "hardware": machine.describe(),
    }
    write_json(Path(out) / "bench" / "lowfi.json", found)
    for line in lines(found):
        say(line)
    return found


def lines(found: dict) -> list[str]:
    """The result as lines of text."""
    said = [
        f"  surrogate at {row['error_percent']:g} % of the settled rate: {row['cpu_ms']:.3f} ms "
        f"per case, plain Runge-Kutta "
        f"{row['baseline_cpu_ms']:.3f} ms, {row['ratio']:.1f} times as much; with curves "
        f"{row['run_cpu_ms']:.2f} ms"
        for row in found["single"]
    ]
    ensemble = found["ensemble"]
    return [
        *said,
        f"  ensemble of {ensemble['cases']:,}: {ensemble['cpu_ms_per_case']:.3f} ms of processor "
        f"time per case, "
        f"{ensemble['wall_s']:.2f} s in all",
    ]


class _Population:
    """The varied scenes, their settled rates at a tight tolerance and their windows."""

    def __init__(self, base, rows):
        from tipoff.lowfi import Numerics, run_many

        tight = run_many(base, rows, "springs", numerics=Numerics(relative_tolerance=_TIGHT))
        self.base, self.rows, self.rates = base, rows, tight.rate.values
        self.scenes = [base.replace(row) for row in rows]
        marks = outcome.milestones(base, model.build(base))
        self.starts = np.array(
            [outcome.window_start(float(at), marks) for at in tight.exit_time.values]
        )

    def error(self, rates: np.ndarray) -> float:
        """95th percentile of the errors (%) of ``rates`` (n,3) rad/s; infinite where one is not
        finite."""
        if not np.isfinite(rates).all():
            return np.inf
        return float(
            np.quantile(
                np.abs(rates - self.rates).max(axis=1) / np.abs(self.rates).max(axis=1), 0.95
            )
            * 100.0
        )


def _single(population: _Population, requested: float, repeats: int) -> dict:
    from tipoff import lowfi

    tolerance, error = _coarsest(
        TOLERANCES, lambda setting: population.error(_settled(population, setting)), requested
    )
    dt, baseline_error = _coarsest(
        STEPS_S, lambda setting: population.error(_plain(population, setting)), requested
    )
    adaptive, plain, whole = (
        _kernel(population, tolerance),
        _loops(population, dt),
        lowfi.Numerics(relative_tolerance=tolerance),
    )
    pieces = {
        "adaptive": adaptive,
        "plain": plain,
        "whole": lambda: [
            lowfi.run(scene, "springs", numerics=whole) for scene in population.scenes
        ],
    }
    times: dict[str, list[float]] = {name: [] for name in pieces}
    for _ in range(repeats):
        for name, piece in pieces.items():
            piece()  # once unseen: the caches of the machine are then this method's
            began = time.thread_time()
            piece()
            times[name].append(1e3 * (time.thread_time() - began) / len(population.rows))
    median = {name: statistics.median(values) for name, values in times.items()}
    return {
        "error_percent": requested,
        "cpu_ms": median["adaptive"],
        "baseline_cpu_ms": median["plain"],
        "ratio": median["plain"] / median["adaptive"],
        "tolerance": tolerance,
        "baseline_dt_s": dt,
        "measured_percent": error,
        "baseline_measured_percent": baseline_error,
        "run_cpu_ms": median["whole"],
    }


def _coarsest(settings: tuple[float, ...], error, requested: float) -> tuple[float, float]:
    """The coarsest of ``settings`` (falling) whose error, and that of all finer ones, is at most
    ``requested``, and its error. The finer ones count since a coarse setting can pass by chance."""
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


def _settled(population: _Population, tolerance: float) -> np.ndarray:
    from tipoff.lowfi import Numerics, run_many

    return run_many(
        population.base, population.rows, "springs", numerics=Numerics(relative_tolerance=tolerance)
    ).rate.values


def _kernel(population: _Population, tolerance: float):
    """A call that integrates and evaluates every case; set-up is done before."""
    from tipoff.lowfi import Numerics
    from tipoff.lowfi.ensemble import batch

    (job,) = batch.Family(population.base, None, Numerics(relative_tolerance=tolerance)).kernels(
        population.rows
    )
    return job


def _loops(population: _Population, dt: float):
    """A call that integrates every case with steps of ``dt`` (s) past the end of its window."""
    from tipoff.lowfi import oracle

    jobs = [
        _plain_job(scene, dt, start) for scene, start in zip(population.scenes, population.starts)
    ]
    return lambda: [oracle.integrate(*arguments) for arguments, _, _ in jobs]


def _plain_job(scene: Scene, dt: float, start: float) -> tuple[tuple, np.ndarray, float]:
    """Arguments of the integration, the rows among them that it fills, and their interval (s)."""
    from tipoff.lowfi import oracle

    count = max(1, round(scene.output.interval / dt))
    interval = dt * count
    samples = int(np.ceil((start + outcome.SETTLE_WINDOW) / interval)) + _AROUND
    arguments, rows = oracle.prepared(scene, count, samples, interval)
    return (*arguments, rows), rows, interval


def _plain(population: _Population, dt: float) -> np.ndarray:
    from tipoff.lowfi import oracle

    found = []
    for scene, start in zip(population.scenes, population.starts):
        arguments, rows, interval = _plain_job(scene, dt, start)
        oracle.integrate(*arguments)
        found.append(
            _mean(np.arange(len(rows)) * interval, rows[:, 10:13], start)
            if np.isfinite(rows).all()
            else np.full(3, np.nan)
        )
    return np.array(found)


def _mean(time: np.ndarray, rates: np.ndarray, start: float) -> np.ndarray:
    """Means (3,) of samples ``rates`` (n,3) over the settled window from ``start`` (s), by a cubic
    spline."""
    end = start + outcome.SETTLE_WINDOW
    first, last = np.searchsorted(time, [start, end])
    near = slice(max(first - _AROUND, 0), last + _AROUND)
    return CubicSpline(time[near], rates[near]).integrate(start, end) / outcome.SETTLE_WINDOW


def _ensemble(base, cases: int, tolerance: float) -> dict:
    from tipoff.lowfi import Numerics, run_many

    rows, numerics = varied(cases, seed=7), Numerics(relative_tolerance=tolerance)
    run_many(base, rows[:50], "springs", numerics=numerics)
    wall, processor = time.perf_counter(), time.process_time()
    found = run_many(base, rows, "springs", numerics=numerics)
    spent = time.process_time() - processor
    return {
        "cases": cases,
        "cpu_ms_per_case": 1e3 * spent / cases,
        "wall_s": time.perf_counter() - wall,
        "ok": found.attrs["ok"],
        "tolerance": tolerance,
        "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
    }
