"""Speed of the surrogate at a stated error, by itself and in ensembles, on compliant contact and on
springs, beside plain Runge-Kutta of order four with fixed steps and SciPy's ``solve_ivp``.

All solve the same varied cases of the reference scene, drawn as in a Monte Carlo study; the two baselines
have springs and compiled equations (``validation.oracle``). The error of a case is the largest difference
of a settled rate from a run of the same model with a tight tolerance, relative to the largest rate. Each
method uses its coarsest setting with a 95th percentile within the requested error; all finer settings
must be within it too. Times are processor times of one core: for the surrogate from the records to the
settled values, with the detection of the exit; for the baselines only the integration, to a given end of
the window. Each timed call counts the cases that it solved; other than all of them is an error. Runs with
curves are timed twice on compliant contact: with the rail modes of the ensemble,
and with modes that each run chooses, as by default.
"""

import resource
import statistics
import time
from collections.abc import Callable
from pathlib import Path

from tipoff.files import write_json
from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes.scene import load
from tipoff.workspace import machine
from tipoff.workspace.progress import say
from validation.bench import done
from validation.bench.methods import (
    MODELS,
    Method,
    PlainRungeKutta,
    Population,
    SolveIvp,
    Surrogate,
    coarsest,
    varied,
)

REQUESTED = (1.0, 0.1)  # per cent of the settled rate


def run(out: Path, cases: int = 2000, few: int = 20, repeats: int = 5) -> dict:
    """``single``, one row for each requested error and method, and ``ensembles`` of both models;
    writes ``out``/bench/lowfi.json."""
    import tipoff

    base, rows = load("reference"), varied(few)
    populations = [
        Population(base, rows, COMPLIANT, tipoff.compliance(base)),
        Population(base, rows, SPRINGS),
    ]
    single = [row for requested in REQUESTED for row in _single(populations, requested, repeats)]
    tolerance = {row["method"]: row["setting"] for row in reversed(single)}
    found = {
        "single": single,
        "ensembles": [
            _ensemble(population, cases, tolerance[MODELS[population.model]])
            for population in populations
        ],
        "modes_why": populations[0].modes_why,
        "varied_cases": few,
        "repeats": repeats,
        "hardware": machine.describe(),
        "state": machine.state(),
    }
    write_json(Path(out) / "bench" / "lowfi.json", found)
    for line in lines(found):
        say(line)
    return found


def _single(populations: list[Population], requested: float, repeats: int) -> list[dict]:
    """Processor time per case (ms) of each method at the ``requested`` error (%): medians of
    ``repeats``, taken in turn; of a surrogate also as runs with curves, ``run_cpu_ms`` with the same
    modes and ``run_auto_cpu_ms`` with modes that each run chooses (None without rail modes)."""
    surrogates = [Surrogate(population) for population in populations]
    methods: list[Method] = [
        *surrogates,
        PlainRungeKutta(populations[-1]),
        SolveIvp(populations[-1]),
    ]
    chosen = [(method, *coarsest(method.settings, method.error, requested)) for method in methods]
    pieces: dict[str, tuple[Callable, Callable]] = {
        method.name: (method.piece(setting), method.solved) for method, setting, _ in chosen
    }
    for method, (_, setting, _) in zip(surrogates, chosen):
        pieces[_with_curves(method.name)] = method.whole(setting), done.runs
        if method.population.modes_why:
            pieces[_chosen_modes(method.name)] = method.whole(setting, modes=AUTO), done.runs
    times = _times(pieces, repeats, len(populations[0].rows))
    return [
        {
            "method": method.name,
            "error_percent": requested,
            "cpu_ms": times[method.name],
            "run_cpu_ms": times.get(_with_curves(method.name)),
            "run_auto_cpu_ms": times.get(_chosen_modes(method.name)),
            "setting": setting,
            "setting_unit": method.unit,
            "measured_percent": error,
        }
        for method, setting, error in chosen
    ]


def _with_curves(name: str) -> str:
    return f"{name}, with curves"


def _chosen_modes(name: str) -> str:
    return f"{name}, with curves and modes chosen"


def _times(
    pieces: dict[str, tuple[Callable, Callable]], repeats: int, cases: int
) -> dict[str, float]:
    """Median processor time (ms) per case of each piece, a call and the number of cases solved in its
    result. Raises NotDone if a call does not solve all ``cases``."""
    times: dict[str, list[float]] = {name: [] for name in pieces}
    for _ in range(repeats):
        for name, (piece, solved) in pieces.items():
            piece()  # once without timing, which loads this method into the caches of the machine
            began = time.thread_time()
            found = piece()
            times[name].append(1e3 * (time.thread_time() - began) / cases)
            done.require(f"cases of {name}", solved(found), cases)
    return {name: statistics.median(values) for name, values in times.items()}


def lines(found: dict) -> list[str]:
    """The result as lines of text."""
    said = [
        f"  {row['method']} at {row['error_percent']:g} % of the settled rate: "
        f"{row['cpu_ms']:.3f} ms per case"
        + (f", with curves {row['run_cpu_ms']:.2f} ms" if row["run_cpu_ms"] else "")
        + (f", and modes chosen {row['run_auto_cpu_ms']:.2f} ms" if row["run_auto_cpu_ms"] else "")
        for row in found["single"]
    ]
    return said + [
        f"  ensemble of {row['cases']:,} on {row['method']}: {row['cpu_ms_per_case']:.3f} ms of "
        f"processor time per case, {row['wall_s']:.2f} s in all"
        for row in found["ensembles"]
    ]


def _ensemble(population: Population, cases: int, tolerance: float) -> dict:
    from tipoff.lowfi import Numerics

    rows, numerics = varied(cases, seed=7), Numerics.of_many(tolerance, model=population.model)
    population.many(rows[:50], numerics)
    wall, processor = time.perf_counter(), time.process_time()
    table = population.many(rows, numerics)
    spent, wall = time.process_time() - processor, time.perf_counter() - wall
    done.require(f"cases of an ensemble on {MODELS[population.model]}", done.rates(table), cases)
    return {
        "method": MODELS[population.model],
        "cases": cases,
        "cpu_ms_per_case": 1e3 * spent / cases,
        "wall_s": wall,
        "ok": table.attrs["ok"],
        "tolerance": tolerance,
        "modes": table.attrs["modes"],
        "peak_memory_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
    }
