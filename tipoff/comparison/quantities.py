"""Quantities of a file with curves in SI and in body axes, whatever code wrote it.

Rates in scene axes are turned into body axes, which are parallel to them at the first sample:

    dQ/dt = [w x] Q,   w_body = Q' w          w in scene axes, Q body to scene
"""

from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.comparison.layout import LENGTH, OF_THE_FORMAT, QUANTITIES, RATES, Layout
from tipoff.faults import Fault, SceneError
from tipoff.formats.csv_file import factor_to_si
from tipoff.formats.curves.nodout import DEFAULTS, NODOUT, WITHOUT_RATES
from tipoff.formats.curves.reader import read_curves
from tipoff.formats.curves.record import BODY, SCENE, Asked, CurveTable
from tipoff.kernels.jit import njit
from tipoff.kernels.rotation import matrix, step, unrotate

_ROUNDING = 1e-9  # s, of times in a file


class Found(NamedTuple):
    """What a file has: quantities (n,) in SI by name, those with a fault left out; faults; digest
    (SHA-256) of the content."""

    values: dict[str, np.ndarray]
    faults: list[Fault]
    digest: str


def read_quantities(
    path: str | Path, layout: Layout = OF_THE_FORMAT, optional: Collection[str] = ()
) -> Found:
    """The quantities ``layout.QUANTITIES`` of a file; those that are ``optional`` may be absent."""
    source = str(path)
    try:
        columns = tuple(column for _, column in layout.columns)
        table, digest = read_curves(path, Asked(layout.body, columns, tuple(QUANTITIES)))
    except OSError as error:
        given = error.strerror or str(error)
        return Found({}, [Fault(source, "file", given, "a readable file with curves")], "")
    except SceneError as error:
        return Found({}, error.faults, "")
    values, faults = {}, _misplaced(source, layout, table)
    if table.is_consistent and not layout.units:
        words = 'those of the model, such as --units "time=ms, length=mm"'
        return Found({}, [*faults, Fault(source, "--units", "no units", words)], digest)
    for name, si in QUANTITIES.items():
        column = dict(layout.columns).get(name)
        if (
            column is None
            and name in optional
            and table.place(table.columns.get(name, name)) is None
        ):
            continue
        found, wrong = _quantity(source, name, si, table, layout)
        faults += wrong
        if not wrong:
            values[name] = found
    faults += _axes_faults(source, layout, table) + _of_rates(source, table, layout, values)
    if layout.ignition and "time" in values:
        late = values["time"] - layout.ignition
        keep = late >= -_ROUNDING
        values = {name: one[keep] for name, one in (values | {"time": late}).items()}
    if (layout.axes or table.axes) == SCENE and {"time", *RATES} <= values.keys():
        turned = in_body_axes(values["time"], np.column_stack([values[name] for name in RATES]))
        values |= dict(zip(RATES, turned.T))
    return Found(values, faults, digest)


def _quantity(
    source: str, name: str, si: str, table: CurveTable, layout: Layout
) -> tuple[np.ndarray, list[Fault]]:
    """One quantity (n,) in SI, and its faults."""
    column = dict(layout.columns).get(name, table.columns.get(name, name))
    place, sign = table.place(column), 1.0
    if place is None and column.startswith("-"):
        place, sign = table.place(column[1:].strip()), -1.0
    if place is None:
        fault = table.no_column(source, name, column)
        if column == DEFAULTS[NODOUT].get(name) and name in RATES:
            fault = fault._replace(expected=WITHOUT_RATES)
        return np.empty(0), [fault]
    values, faults = table.numbers(source, name, place)
    unit = table.units[place] if place < len(table.units) else None
    if table.is_consistent and unit is not None:
        unit = layout.filled(unit)
    factor, wrong = _factor(source, name, si, unit, layout.unit(name))
    return sign * factor * values, faults + wrong


def _of_rates(
    source: str, table: CurveTable, layout: Layout, values: dict[str, np.ndarray]
) -> list[Fault]:
    """Faults of quantities that share a column, and of rates of a node that does not turn. Two columns
    that are exchanged do not show: axes may have any names."""
    faults, taken = [], dict[int, str]()
    for name in values:
        column = dict(layout.columns).get(name, table.columns.get(name, name))
        place = table.place(column)
        if place is None:
            place = table.place(column.removeprefix("-").strip())
        assert place is not None  # its values were read
        if place in taken:
            words = f"a column of its own; {taken[place]} has this one"
            faults.append(Fault(source, name, f"column {column.removeprefix('-')!r}", words))
        taken.setdefault(place, name)
    is_node = table.columns == DEFAULTS[NODOUT]
    rates = [values[name] for name in RATES if name in values]
    if is_node and rates and len(rates[0]) > 1 and not np.any(rates):
        faults.append(Fault(source, "rates", "0 at every time", WITHOUT_RATES))
    return faults


def _factor(
    source: str, name: str, si: str, written: str | None, stated: str | None
) -> tuple[float, list[Fault]]:
    """Factor to SI from the unit ``written`` in the file or ``stated`` by --units, and faults."""
    if stated is None:
        factor, faults = factor_to_si(source, name, written, si)
        if written is None and faults:
            words = f'{faults[0].expected}, in the header or in --units "{name}={si}"'
            return factor, [faults[0]._replace(expected=words)]
        return factor, faults
    factor, faults = factor_to_si(source, name, stated, si)
    in_file, unclear = factor_to_si(source, name, written, si)
    if not faults and not unclear and abs(in_file / factor - 1.0) > 1e-9:
        faults = [Fault(source, name, f"{stated} in --units", f"{written}, the unit in the file")]
    return factor, faults


def _misplaced(source: str, layout: Layout, table: CurveTable) -> list[Fault]:
    """Faults of options that this format does not have."""
    faults = []
    if isinstance(table.rows, list) and layout.body is not None:
        words = "none: a table has one body; choose its columns with --columns"
        faults.append(Fault(source, "--body", layout.body, words))
    if not table.is_consistent and LENGTH in dict(layout.units):
        words = "none: only files of LS-DYNA have one unit of length"
        faults.append(Fault(source, "--units length", dict(layout.units)[LENGTH], words))
    return faults


def _axes_faults(source: str, layout: Layout, table: CurveTable) -> list[Fault]:
    if layout.axes or table.axes:
        return []
    words = f"--axes {BODY} or --axes {SCENE}: the file does not tell the axes of its rates"
    return [Fault(source, "rates", "no axes", words)]


def in_body_axes(time: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Rates (n,3) rad/s in body axes from ``rate`` (n,3) in scene axes at the times (n,) s; linear
    between samples, so the error falls with the square of their distance."""
    return _turned(np.ascontiguousarray(time, float), np.ascontiguousarray(rate, float))


@njit
def _turned(time, rate):
    turned = np.empty_like(rate)
    q = (1.0, 0.0, 0.0, 0.0)
    for i in range(time.size):
        if i > 0:
            mean = 0.5 * (rate[i - 1] + rate[i])
            q = step(q, (mean[0], mean[1], mean[2]), time[i] - time[i - 1])
        body = unrotate(matrix(q), (rate[i, 0], rate[i, 1], rate[i, 2]))
        turned[i, 0], turned[i, 1], turned[i, 2] = body
    return turned
