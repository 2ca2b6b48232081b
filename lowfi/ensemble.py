"""Many runs at once in threads: kernels release the interpreter lock, and runs share nothing,
so the worker count changes no bit."""

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lowfi import columns
from lowfi.batch import Case, Family
from lowfi.models import require
from lowfi.numerics import Numerics
from lowfi.rows import Drawn, Listed
from scenes.calibration import Calibration
from scenes.fidelity import COMPLIANT
from scenes.scene import Scene
from scenes.uncertainty import Uncertainty
from scenes.walls import Walls

if TYPE_CHECKING:
    import xarray

_AXES = ("x", "y", "z")
# cases set up together: enough for the calls to cost nothing, few enough for memory to stay flat
PIECE = 256


def run_many(
    scene: Scene,
    table: Sequence[Mapping[str, Any]] | Uncertainty,
    model: str = COMPLIANT,
    *,
    walls: Walls | None = None,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    workers: int | None = None,
    store: str | Path | None = None,
) -> "xarray.Dataset":
    """Run ``scene`` once per row of ``table``, a row being dotted overrides as in
    ``Scene.replace``, or per draw of an Uncertainty.

    The values are those of ``lowfi.run`` to the last bit, with its ``model``, ``walls`` and
    ``calibration``; no curves are kept. A row the scene refuses has the status ``refused`` and the
    reason as its message; the others run. Settled values are NaN where a run has none. ``wall_s``
    of a case is its share of the piece it ran in. The attributes count ``asked = ok + refused +
    failed``, failed being the diverged. With a ``store``, a folder, cases go there chunk by chunk
    and what it holds already is not run again (``lowfi.fill``, which needs no room for all
    results); it has no ``wall_s``.
    """
    require(scene, model, walls, calibration, numerics)
    source, numerics = (
        Drawn(table) if isinstance(table, Uncertainty) else Listed(table),
        numerics or Numerics(),
    )
    if store is not None:
        from lowfi.request import Ensemble

        return _stored(Ensemble(scene, source, calibration, numerics, walls), workers, store)
    pieces = (
        source.rows(begin, min(begin + PIECE, source.asked))
        for begin in range(0, source.asked, PIECE)
    )
    cases = list(
        chain.from_iterable(completed(Family(scene, calibration, numerics, walls), pieces, workers))
    )
    shares = np.array([case.wall_s for case in cases], dtype=float)
    return _dataset(columns.of(cases), [case.message for case in cases]).assign(
        wall_s=("case", shares, {"units": "s"})
    )


def _stored(ensemble, workers, path) -> "xarray.Dataset":
    from lowfi.fill import fill

    store = ensemble.store(path)
    fill(ensemble, store, workers)
    return _dataset(*store.results())


def completed(
    family: Family, pieces: Iterable[Sequence[Mapping[str, Any]]], workers: int | None = None
) -> Iterator[list[Case]]:
    """Cases of each of ``pieces`` of rows, in their order; a piece is taken when a thread is free
    for it soon."""
    count = _workers(workers)
    waiting: deque[list[Future[list[tuple[int, Case]]]]] = deque()
    with ThreadPoolExecutor(count) as pool:
        for rows in pieces:
            # Setting up holds the interpreter lock, stepping does not: one thread prepares what the
            # others run.
            waiting.append([pool.submit(job) for job in family.jobs(rows)])
            while len(waiting) > count:
                yield in_order(future.result() for future in waiting.popleft())
        while waiting:
            yield in_order(future.result() for future in waiting.popleft())


def in_order(found: Iterable[list[tuple[int, Case]]]) -> list[Case]:
    """Cases of a piece from what its jobs found, pairs of a row's number and its case."""
    return [case for _, case in sorted(chain.from_iterable(found), key=lambda pair: pair[0])]


def _workers(workers: int | None) -> int:
    return workers or os.cpu_count() or 1


def _dataset(found: columns.Columns, messages: list[str]) -> "xarray.Dataset":
    import xarray  # slow to load, and a single run does without

    dimensions = {
        name: ("case", "axis") if name in columns.VECTORS else "case" for name in columns.UNITS
    }
    variables = {
        "status": ("case", np.array(columns.STATUSES, dtype=object)[found.status]),
        "message": ("case", np.array(messages, dtype=object)),
        **{
            name: (dimensions[name], getattr(found, name), {"units": unit})
            for name, unit in columns.UNITS.items()
        },
        "steps": ("case", found.steps),
    }
    return xarray.Dataset(
        variables,
        {"case": np.arange(len(messages)), "axis": list(_AXES)},
        attrs=columns.counts(found.status),
    )
