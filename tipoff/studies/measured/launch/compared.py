"""Measured launches beside predicted ones, as the records of the result."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tipoff.files import write_text
from tipoff.studies.measured.launch import quantities
from tipoff.studies.measured.launch.analysis import Launched
from tipoff.studies.measured.launch.prediction import Predicted
from tipoff.studies.measured.launch.record import thrust
from tipoff.studies.measured.results import Band, Comparison, Launch
from tipoff.workspace.study import Study

_CURVE = 400  # points of a curve
_AROUND = 0.05  # s before the start and after the exit in a figure


def results(
    study: Study, launches: Sequence[Launched], found: Predicted
) -> tuple[tuple[Launch, ...], tuple[Comparison, ...], list[Path]]:
    """The launches, every comparison, and the files of thrusts that were written."""
    rows, compared, files = [], [], []
    for number, own in enumerate(launches):
        path = study.path(f"measured-thrust-{number + 1}.csv")
        write_text(path, _thrust(own, found))
        files.append(path)
        rows.append(_launch(own, found, number, study.relative(path)))
        cases = {found.model.name: found.quantities[number]}
        compared += [_comparison(own.name, row) for row in quantities.table(own.stated, cases)]
    return tuple(rows), tuple(compared), files


def _thrust(own: Launched, found: Predicted) -> str:
    mass = found.model.scene.payload.mass
    curve = thrust(own.record, mass, own.record.exit[1] + 0.5 * own.record.after)
    rows = [f"{at:.6f},{value:.3f}\n" for at, value in curve]
    return "time_s,force_N\n" + "".join(rows)


def _comparison(test: str, row: quantities.ComparedValue) -> Comparison:
    (ends,) = row.ranges.values()
    return Comparison(
        test=test,
        quantity=row.quantity,
        unit=row.unit,
        measured=row.measured,
        expanded=row.expanded,
        low=ends[0],
        median=ends[1],
        high=ends[2],
        share_below=row.rank,
        inside=next(iter(row.inside.values())),
    )


def _launch(own: Launched, found: Predicted, number: int, path: str) -> Launch:
    asked = own.sheet.launch.exit
    return Launch(
        test=own.name,
        simulated=own.sheet.simulated,
        description=own.sheet.description,
        notes=tuple(own.notes),
        interval_s=own.record.interval,
        start_s=own.start,
        exit_by=asked if isinstance(asked, str) else "the sheet",
        exit_s=own.record.left,
        exit_uncertainty_s=own.record.half,
        at_rest_m_s2=own.gravity[0],
        gravity_m_s2=own.gravity[1],
        exit_budget={
            name: (float(a), float(b), float(c)) for name, (a, b, c) in own.motion.items()
        },
        rate_budget_deg_s={
            name: (float(x), float(y), float(z))
            for name, (x, y, z) in ((name, np.degrees(part)) for name, part in own.rates.items())
        },
        cases=len(found.quantities[number]),
        lost=found.lost,
        thrust=path,
        band=_band(own, found.rates[number]),
    )


def _band(own: Launched, rates: np.ndarray) -> Band:
    record = own.record
    shown = (record.time >= -_AROUND) & (record.time <= record.exit[1] + _AROUND)
    places = np.flatnonzero(shown)
    places = places[:: max(1, places.size // _CURVE)]
    low, high = np.degrees(np.quantile(rates[:, places], quantities.SHARES[::2], axis=0)).round(4)
    return Band(
        tuple(record.time[places].round(6).tolist()),
        *(
            tuple(tuple(row) for row in values.tolist())
            for values in (np.degrees(record.rate[places]).round(4), low, high)
        ),
    )
