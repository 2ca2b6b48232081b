"""Many runs at once in threads: kernels release the interpreter lock, and runs share nothing, so the worker count changes no bit."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Mapping, Sequence

import numpy as np
import xarray

from lowfi import batch
from lowfi.batch import Case
from lowfi.numerics import Numerics
from lowfi.run import run
from scenes.calibration import Calibration
from scenes.scene import Scene
from scenes.trajectory import Trajectory

_AXES = ("x", "y", "z")
_CHUNK = 256  # cases set up together: enough for the calls to cost nothing, few enough for memory to stay flat


def curves(scenes: Sequence[Scene], numerics: Numerics | None = None, workers: int | None = None) -> list[Trajectory]:
    """One Trajectory per scene, in their order. ``workers`` threads (absent: one per core)."""
    with ThreadPoolExecutor(_workers(workers)) as pool:
        return list(pool.map(lambda scene: run(scene, numerics=numerics), scenes))


def run_many(scene: Scene, table: Sequence[Mapping[str, Any]], calibration: Calibration | None = None,
             workers: int | None = None, numerics: Numerics | None = None) -> xarray.Dataset:
    """Run ``scene`` once per row of ``table``, a row being dotted overrides as in ``Scene.replace``.

    The values are those of ``lowfi.run`` to the last bit; no curves are kept. A row the scene refuses has the status ``refused`` and the
    reason as its message; the others run. Settled values are NaN where a run has none. ``wall_s`` of a case is its share of the chunk it
    ran in. The attributes count ``asked = ok + refused + failed``, failed being the diverged.
    """
    table, chosen, cases = list(table), numerics or Numerics(), []
    family = batch.Family(scene, calibration, chosen)
    count = _workers(workers)
    with ThreadPoolExecutor(count) as pool:
        waiting = []
        for begin in range(0, len(table), _CHUNK):
            # Setting up holds the interpreter lock, stepping does not: one thread prepares what the others run.
            waiting.append([pool.submit(job) for job in family.jobs(table[begin:begin + _CHUNK])])
            while len(waiting) > count:
                cases += _collected(waiting.pop(0))
        for futures in waiting:
            cases += _collected(futures)
    return _dataset(cases)


def _collected(futures) -> list[Case]:
    return [case for _, case in sorted((pair for future in futures for pair in future.result()), key=lambda pair: pair[0])]


def _workers(workers: int | None) -> int:
    return workers or os.cpu_count() or 1


def _dataset(cases: list[Case]) -> xarray.Dataset:
    def settled(name: str, size: tuple[int, ...]) -> np.ndarray:
        values = np.full((len(cases), *size), np.nan)
        for index, case in enumerate(cases):
            value = getattr(case.outcome, name)
            if value is not None:
                values[index] = value
        return values

    statuses = [case.status for case in cases]
    refused, failed = statuses.count("refused"), statuses.count("diverged")
    counts = {"asked": len(cases), "ok": len(cases) - refused - failed, "refused": refused, "failed": failed}
    variables = {
        "status": ("case", np.array(statuses, dtype=object)), "message": ("case", np.array([c.message for c in cases], dtype=object)),
        "exit_time": ("case", settled("exit_time", ()), {"units": "s"}),
        "velocity": (("case", "axis"), settled("velocity", (3,)), {"units": "m/s"}),
        "rate": (("case", "axis"), settled("rate", (3,)), {"units": "rad/s"}),
        "lateral_velocity": ("case", settled("lateral_velocity", ()), {"units": "m/s"}),
        "direction_error": ("case", settled("direction_error", ()), {"units": "rad"}),
        "steps": ("case", np.array([case.steps for case in cases], dtype=int)), "wall_s": ("case", np.array([case.wall_s for case in cases], dtype=float), {"units": "s"}),
    }
    return xarray.Dataset(variables, {"case": np.arange(len(cases)), "axis": list(_AXES)}, attrs=counts)
