"""Many runs of the surrogate at once, as one labelled data set."""

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn, Listed
from tipoff.lowfi.ensemble.threads import PIECE, completed
from tipoff.lowfi.models import require
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.models import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty

if TYPE_CHECKING:
    import xarray

_AXES = ("x", "y", "z")


def run_many(
    scene: Scene,
    table: Sequence[Mapping[str, Any]] | Uncertainty,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    workers: int | None = None,
    store: str | Path | None = None,
) -> "xarray.Dataset":
    """Run ``scene`` once per row of ``table``, a row being dotted overrides as in
    ``Scene.replace``, or per draw of an Uncertainty.

    The values are those of ``lowfi.run`` to the last bit, with its ``model``, ``compliance`` and
    ``calibration``; there are no curves. A row that the scene refuses has the status ``refused`` and
    the reason as its message; the others run. Settled values are NaN where a run has none.
    ``wall_s`` of a case is its share of the time of its group. The attributes count ``asked = ok +
    refused + failed``, failed being the diverged. With a ``store``, a folder, cases go there chunk
    by chunk, stored cases are not run again (``lowfi.ensemble.fill``), and there is no
    ``wall_s``.
    """
    require(scene, model, compliance, calibration, numerics)
    if model == COMPLIANT and calibration is not None:  # before a row, which may vary a constant
        scene, calibration = calibration.split(scene)
    source, numerics = (
        Drawn(table) if isinstance(table, Uncertainty) else Listed(table),
        numerics or Numerics(),
    )
    if store is not None:
        return _stored(Ensemble(scene, source, calibration, numerics, compliance), workers, store)
    pieces = (
        source.rows(begin, min(begin + PIECE, source.asked))
        for begin in range(0, source.asked, PIECE)
    )
    cases = list(
        chain.from_iterable(
            completed(Family(scene, calibration, numerics, compliance), pieces, workers)
        )
    )
    shares = np.array([case.wall_s for case in cases], dtype=float)
    return _dataset(columns.of(cases), [case.message for case in cases]).assign(
        wall_s=("case", shares, {"units": "s"})
    )


def _stored(ensemble, workers, path) -> "xarray.Dataset":
    store = ensemble.store(path)
    fill(ensemble, store, workers)
    return _dataset(*store.results())


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
