"""Named columns of numbers with units from a CSV file, each turned to SI; all that is wrong with
the file is found at once.

A header cell is a name with its unit in brackets, ``rate_x [deg/s]``, or a name alone where the
second line holds the units. Columns nobody asked for are passed over: another code's export has
more of them.
"""

import csv
import io
import re
from typing import NamedTuple

import numpy as np

from tipoff.scenes import units
from tipoff.scenes.faults import Fault

_HEAD = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")
_SHOWN = 5  # lines of a column that are named before the rest is counted


class _Column(NamedTuple):
    """Where it stands, and the unit its header names, if any."""

    place: int
    unit: str | None


def read(
    source: str, data: bytes, wanted: dict[str, str]
) -> tuple[dict[str, np.ndarray], list[Fault]]:
    """Columns (n,) in SI by name, and the faults of the file; ``wanted`` gives the SI unit of each
    column by name.

    A column with a fault is left out.
    """
    try:
        reader = csv.reader(io.StringIO(data.decode("utf-8-sig"), newline=""), strict=True)
        lines = [
            (reader.line_num, [cell.strip() for cell in row])
            for row in reader
            if any(map(str.strip, row))
        ]
    except (UnicodeDecodeError, csv.Error) as error:
        return {}, [Fault(source, "file", str(error), "a CSV file of text")]
    header = lines[0][1] if lines else []
    second = lines[1][1] if len(lines) > 1 and units.are_units(lines[1][1]) else None
    found, faults = _places(source, header, wanted)
    arrays = {}
    for name, column in found.items():
        unit = (
            column.unit
            if column.unit is not None or second is None
            else _cell(second, column.place)
        )
        values, wrong = _values(column.place, lines[2 if second else 1 :])
        problems = _unit_faults(source, name, unit, wanted[name]) + _cell_faults(
            source, name, wrong
        )
        if not problems:
            arrays[name] = values * units.to_si(f"1 {unit}", wanted[name])
        faults += problems
    return arrays, faults


def _places(
    source: str, header: list[str], wanted: dict[str, str]
) -> tuple[dict[str, _Column], list[Fault]]:
    heads = [_head(cell) for cell in header]
    names = [name for name, _ in heads]
    shown = ", ".join(filter(None, names)) or "nothing"
    faults = [
        Fault(
            source,
            name,
            "no such column" if name not in names else "twice",
            f"once in the header, which has {shown}",
        )
        for name in wanted
        if names.count(name) != 1
    ]
    once = {name for name in wanted if names.count(name) == 1}
    return {
        name: _Column(place, unit) for place, (name, unit) in enumerate(heads) if name in once
    }, faults


def _head(cell: str) -> tuple[str, str | None]:
    """Name and unit of a column."""
    found = _HEAD.fullmatch(" ".join(cell.split()))  # a quoted cell may hold line breaks
    assert found is not None
    return found[1], found[2]


def _cell(row: list[str], place: int) -> str:
    return row[place] if place < len(row) else ""


def _unit_faults(source: str, name: str, unit: str | None, wanted: str) -> list[Fault]:
    if not unit:
        return [
            Fault(
                source,
                name,
                "no unit",
                f'"{name} [{wanted}]" in the header or "{wanted}" in the second line, or the like',
            )
        ]
    try:
        units.to_si(f"1 {unit}", wanted)
    except ValueError as error:
        return [Fault(source, name, repr(unit), str(error))]
    return []


def _values(
    place: int, lines: list[tuple[int, list[str]]]
) -> tuple[np.ndarray, dict[str, list[int]]]:
    """The column as written, and the lines that hold no finite number by what they hold."""
    values = np.empty(len(lines))
    wrong: dict[str, list[int]] = {}
    for index, (number, row) in enumerate(lines):
        text = _cell(row, place)
        try:
            values[index] = float(text)
        except ValueError:
            values[index] = np.nan
        if not np.isfinite(values[index]):
            wrong.setdefault(repr(text) if text else "nothing", []).append(number)
    return values, wrong


def _cell_faults(source: str, name: str, wrong: dict[str, list[int]]) -> list[Fault]:
    return [
        Fault(source, name, f"{text} in {_listed(numbers)}", "a finite number in each line")
        for text, numbers in wrong.items()
    ]


def _listed(numbers: list[int]) -> str:
    more = [f"and {len(numbers) - _SHOWN} more"] if len(numbers) > _SHOWN else []
    return f"line{'s' if len(numbers) > 1 else ''} " + ", ".join(
        [*map(str, numbers[:_SHOWN]), *more]
    )
