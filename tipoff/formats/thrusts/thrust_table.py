"""A table with a column of times and a column of thrusts: the layout of tipoff, RocketPy's, or the
log of a firing.

A column is chosen by its name where that is unambiguous, otherwise by ``thrust.time_column`` and
``thrust.thrust_column``. Its unit is in the table or in ``thrust.time_unit`` and
``thrust.thrust_unit``.
"""

from typing import NoReturn

import numpy as np

from tipoff.faults import SceneError
from tipoff.formats.declared import Format
from tipoff.formats.instrument_table import Written, name_and_unit, read_table, scale, stated, words
from tipoff.formats.thrusts.record import SECTION, Choice, Record

_HOUSE = ["time_s", "force_N"]
_THRUST = {"thrust", "force", "f", "load", "schub", "kraft"}
_NAMES = {"time": "s", "thrust": "N"}
_LAYOUT = "time_s,force_N or Time [ms];Thrust (lbf)"


def read_thrust_table(path: str, data: bytes, choice: Choice) -> Record:
    """The two columns. Raises ValueError with every fault of the table."""
    choice.require_only(Choice._fields[1:], "a table")
    named = {"time": choice.time_column, "thrust": choice.thrust_column}

    def is_header(cells: list[str]) -> bool:
        table = Written(cells, [], [])
        return all(_candidates(table, kind, named[kind]) for kind in _NAMES)

    try:
        table = read_table(path, data, is_header)
    except SceneError as error:
        raise ValueError(f"{error.faults[0].expected} ({error.faults[0].given})") from error
    places = [_place(table, kind, named[kind]) for kind in _NAMES]
    if places[0] == places[1]:
        _refuse(table, "one column is both")
    keys = {"time": choice.time_unit, "thrust": choice.thrust_unit}
    factors = [_factor(table, place, kind, keys[kind]) for place, kind in zip(places, _NAMES)]
    _require_rows(table, max(places))
    columns, faults = table.numbers(path, places)
    used = " and ".join(table.names()[place] for place in places)
    said = "" if table.header == _HOUSE else f"columns {used}"
    if not table.header:
        said = f"columns {used} of a table without a header"
    with np.errstate(over="ignore"):  # infinite values are refused
        time, force = (values * factor for values, factor in zip(columns, factors))
    wrong = tuple(f"{f.expected} ({f.key}: {f.given})" for f in faults)
    if any("," in fault.given for fault in faults):
        wrong += ("a comma only as decimal comma, which cannot be a mark of thousands",)
    return Record(time, force, said, tuple(number for number, _ in table.rows), wrong)


def _candidates(table: Written, kind: str, name: str | None) -> list[int]:
    """Columns that may be the time or the thrust."""
    if name is not None:
        return table.places(name, _NAMES[kind])
    if not table.header:  # two columns without names: the time and the thrust
        return [list(_NAMES).index(kind)] if len(table.names()) == len(_NAMES) else []
    if kind == "time":
        found = table.times()
    else:
        found = [
            k for k, cell in enumerate(table.header) if words(name_and_unit(cell, "N")[0]) & _THRUST
        ]
    fitting = [place for place in found if _is_in(table.unit(place, _NAMES[kind]), _NAMES[kind])]
    return fitting if len(found) > 1 and fitting else found


def _is_in(unit: str | None, si: str) -> bool:
    try:
        return unit is None or scale(unit, si) > 0.0
    except ValueError:
        return False


def _place(table: Written, kind: str, name: str | None) -> int:
    found = _candidates(table, kind, name)
    if len(found) == 1:
        return found[0]
    if name is not None:
        _refuse(table, f"thrust.{kind}_column = {name!r} is {'twice' if found else 'not'} there")
    if not found:
        _refuse(table, f"no column is clearly the {kind}: name it in thrust.{kind}_column")
    cells = " or ".join(table.names()[place] for place in found)
    _refuse(table, f"the {kind} may be {cells}: name it in thrust.{kind}_column")


def _factor(table: Written, place: int, kind: str, key: str | None) -> float:
    """From the unit of the table or of the key to SI. A key that contradicts the table is
    refused."""
    si, unit, name = _NAMES[kind], table.unit(place, _NAMES[kind]), f"thrust.{kind}_unit"
    if unit is None and key is None:
        _refuse(table, f"no unit of the {kind}: state it in {name}")
    try:
        given = None if key is None else stated(key, si)
    except ValueError as error:
        raise ValueError(f"{name} with {error}") from error
    if unit is None or (given is not None and not _is_in(unit, si)):
        assert given is not None
        return given
    try:
        found = scale(unit, si)
    except ValueError as error:
        _refuse(table, f"unit of the {kind}: {error}; or state it in {name}")
    if given is not None and abs(given / found - 1.0) > 1e-9:
        _refuse(table, f"{name} = {key!r} contradicts the unit {unit!r} of the header")
    return found


def _require_rows(table: Written, last: int) -> None:
    """Check that every line has as many cells as the header. Empty cells at the end do not count."""
    most = len(table.header) if table.header else len(table.names())
    for number, row in table.rows:
        if any(row[most:]) or len(row) <= last:
            count = "two numbers" if most == len(_NAMES) else f"{most} cells"
            raise ValueError(f"{count} in every row (line {number} has another count); {SECTION}")


def _refuse(table: Written, why: str) -> NoReturn:
    raise ValueError(
        f"a table whose header names a time and a thrust with their units, as in {_LAYOUT} "
        f"({why}; {table.shown()}); {SECTION}"
    )


FORMATS = (
    Format(
        "table with a header such as time_s,force_N",
        read_thrust_table,
        [
            ("table of tipoff, `time_s,force_N`", "both columns", "in the header", "by the header"),
            (
                "table of another program or a log: commas, semicolons, tabs or blanks; comment lines with "
                "`#`, `%`, `//` or `;`; lines of text above the header; a header behind a comment mark; "
                "decimal commas",
                "a column of times and one of thrusts; other columns are ignored",
                "in the header, `Time [ms]`, `Thrust (lbf)`, `Force/N`, `time_us`, or in a line below it; "
                "otherwise in `time_unit` and `thrust_unit`",
                "by a name with the word time, timestamp, zeit or t, and one with thrust, force, load, "
                "schub, kraft or f; if several fit, by `time_column` and `thrust_column`",
            ),
            (
                "table of RocketPy without a header",
                "the two columns",
                "`time_unit` and `thrust_unit`",
                'the first is the time; of more than two columns, by number: `time_column = "2"`',
            ),
        ],
        is_any_other=True,
    ),
)
