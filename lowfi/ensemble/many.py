"""Many runs of the surrogate at once, as one labelled data set."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tipoff.lowfi.ensemble import columns, twins
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.pilot import settled
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn, Listed, numbers
from tipoff.lowfi.ensemble.threads import PIECE, completed
from tipoff.lowfi.models import require
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import halving
from tipoff.scenes import overrides as keys
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty

if TYPE_CHECKING:
    import xarray

_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Execution:
    """Options of an ensemble."""

    workers: int | None = None  # threads; None: all cores
    store: str | Path | None = None  # folder
    sensitivity: bool = False  # whether the sensitivity of each case is computed too


def run_many(
    scene: Scene,
    table: Sequence[Mapping[str, Any]] | Uncertainty,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    **execution: Any,
) -> "xarray.Dataset":
    """Run ``scene`` once per row of ``table``, a row of dotted overrides as in ``Scene.replace``,
    or once per draw of an Uncertainty.

    The values are those of ``lowfi.run`` to the last bit, with its ``model``, ``compliance`` and
    ``calibration``; there are no curves. The inputs of a case stand under their dotted keys. A row
    that the scene refuses has the status ``refused`` and the reason as its message; the others run.
    Settled values are NaN if a run has none.
    ``wall_s`` of a case is its share of the time of its group. The attributes count ``asked = ok +
    refused + failed``; failed means diverged.

    ``execution`` are fields of ``Execution``. With a ``store``, a folder, cases are stored there
    chunk by chunk, stored cases are not run again (``lowfi.ensemble.fill``), and there is no
    ``wall_s``. With ``sensitivity=True`` there are also ``rate_change_by_clearance`` and
    ``rate_change_by_tolerance`` (rad/s): the change of the settled rates of the case for 1 um more
    of every clearance, and for a tolerance of 1e-10 (``lowfi.ensemble.twins``). Their time is
    ``sensitivity_wall_s``, which is not part of ``wall_s``. With ``modes="auto"`` all cases have
    one number of modes (``lowfi.ensemble.pilot``); the attributes ``modes`` and ``modes_why`` state
    it. Of an Uncertainty, the attribute ``errors`` has the sizes of its tolerances.
    """
    chosen = Execution(**execution)
    require(scene, model, compliance, calibration, numerics)
    if model == COMPLIANT and calibration is not None:  # before a row, which may vary a constant
        scene, calibration = calibration.split(scene)
    source, numerics = (
        Drawn(table) if isinstance(table, Uncertainty) else Listed(table),
        numerics or Numerics(),
    )
    asked = Ensemble(scene, source, calibration, numerics, compliance)
    ensemble = settled(asked, chosen.store)
    why = {"modes_why": ensemble.modes_why} if ensemble.modes_why else {}
    if isinstance(source, Drawn):
        why["errors"] = halving.listed(halving.sizes(source.uncertainty))
    found = _found(ensemble, chosen).assign(_inputs(scene, source))
    return found.assign_attrs(modes=ensemble.numerics.modes, **why)


def _inputs(scene: Scene, source: Any) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
    """The input of each case by its dotted key: numbers in SI with their unit, or text. A case that
    does not give a key has the value of the ``scene``."""
    pieces = (
        source.rows(begin, min(begin + PIECE, source.asked))
        for begin in range(0, source.asked, PIECE)
    )
    names = list(source.keys)
    units = {name: keys.unit(Scene, name) for name in names}
    own = {name: keys.held(scene, name) for name in names}
    values: dict[str, list] = {name: [] for name in names}
    for rows in pieces:
        found = numbers(names, rows)
        for name, column in zip(names, found.T):
            given = np.array([name in row for row in rows])
            if units[name] is None:
                text = [str(row.get(name, scene.given(name))) for row in rows]
                values[name].append(np.array(text, dtype=object))
            else:
                unchanged = own[name] if isinstance(own[name], (int, float)) else np.nan
                values[name].append(np.where(given, column, unchanged))
    return {
        name: (
            "case",
            np.concatenate(values[name]),
            {} if units[name] is None else {"units": units[name] or "dimensionless"},
        )
        for name in names
    }


def _found(ensemble: Ensemble, chosen: Execution) -> "xarray.Dataset":
    if chosen.store is not None:
        return _stored(ensemble, chosen, chosen.store)
    cases = _cases(ensemble, chosen)
    found = _dataset(columns.of_cases(cases), [case.message for case in cases])
    found["wall_s"] = "case", _shares(cases), {"units": "s"}
    if chosen.sensitivity:
        spent = np.zeros(len(cases))
        for cause, twin in twins.of_ensemble(ensemble).items():
            disturbed = _cases(twin, chosen)
            _add_change(found, cause, twin, columns.of_cases(disturbed).rate)
            spent += _shares(disturbed)
        found["sensitivity_wall_s"] = "case", spent, {"units": "s"}
    return found


def _cases(ensemble: Ensemble, chosen: Execution) -> list[Case]:
    source = ensemble.source
    pieces = (
        source.rows(begin, min(begin + PIECE, source.asked))
        for begin in range(0, source.asked, PIECE)
    )
    return list(chain.from_iterable(completed(ensemble.family(), pieces, chosen.workers)))


def _shares(cases: list[Case]) -> np.ndarray:
    return np.array([case.wall_s for case in cases], dtype=float)


def _stored(ensemble: Ensemble, chosen: Execution, path: str | Path) -> "xarray.Dataset":
    store = ensemble.store(path)
    fill(ensemble, store, chosen.workers)
    found = _dataset(*store.results())
    if chosen.sensitivity:
        for cause, twin in twins.of_ensemble(ensemble).items():
            disturbed = twins.opened(twin, cause, store)
            fill(twin, disturbed, chosen.workers)
            twins.add(store, cause, twin, disturbed)
            _add_change(found, cause, twin, disturbed.column("rate"))
    return found


def _add_change(found: "xarray.Dataset", cause: str, twin: Ensemble, disturbed: np.ndarray) -> None:
    change = twins.change(found["rate"].values, disturbed)
    found[twins.column(cause)] = "case", change, twins.attributes(cause, twin)


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
