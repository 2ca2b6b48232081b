"""Many runs at once in threads: kernels release the interpreter lock, and runs share nothing, so the worker count changes no bit."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np
import xarray

from lowfi.numerics import Numerics
from lowfi.run import run
from scenes.calibration import Calibration
from scenes.faults import SceneError
from scenes.scene import Scene
from scenes.trajectory import Trajectory

_AXES = ("x", "y", "z")


class _Case(NamedTuple):
    status: str
    message: str
    trajectory: Trajectory | None


def curves(scenes: Sequence[Scene], numerics: Numerics | None = None, workers: int | None = None) -> list[Trajectory]:
    """One Trajectory per scene, in their order. ``workers`` threads (absent: one per core)."""
    with ThreadPoolExecutor(_workers(workers)) as pool:
        return list(pool.map(lambda scene: run(scene, numerics=numerics), scenes))


def run_many(scene: Scene, table: Sequence[Mapping[str, Any]], calibration: Calibration | None = None,
             workers: int | None = None, numerics: Numerics | None = None) -> xarray.Dataset:
    """Run ``scene`` once per row of ``table``, a row being dotted overrides as in ``Scene.replace``.

    A row the scene refuses has the status ``refused`` and the reason as its message; the others run. Settled values are NaN where a
    run has none. The attributes count ``asked = ok + refused + failed``, failed being the diverged.
    """
    def one(row: Mapping[str, Any]) -> _Case:
        try:
            changed = scene.replace(row)
            found = run(changed, calibration=calibration, numerics=numerics)
        except SceneError as error:
            return _Case("refused", str(error), None)
        return _Case(found.status, found.message, found)

    with ThreadPoolExecutor(_workers(workers)) as pool:
        cases = list(pool.map(one, table))
    return _dataset(cases)


def _workers(workers: int | None) -> int:
    return workers or os.cpu_count() or 1


def _dataset(cases: list[_Case]) -> xarray.Dataset:
    def settled(name: str, size: tuple[int, ...]) -> np.ndarray:
        values = np.full((len(cases), *size), np.nan)
        for index, case in enumerate(cases):
            value = getattr(case.trajectory.outcome, name) if case.trajectory else None
            if value is not None:
                values[index] = value
        return values

    def cost(name: str) -> np.ndarray:
        return np.array([case.trajectory.cost[name] if case.trajectory else 0 for case in cases])

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
        "steps": ("case", cost("steps").astype(int)), "wall_s": ("case", cost("wall_s").astype(float), {"units": "s"}),
    }
    return xarray.Dataset(variables, {"case": np.arange(len(cases)), "axis": list(_AXES)}, attrs=counts)
