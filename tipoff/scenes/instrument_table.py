"""Tables that instruments and other programs write. A table may have commas, semicolons or tabs
between its cells, comment lines, lines of text before its header, a header behind a comment mark,
and decimal commas.

The unit of a column is in brackets after its name, ``Time [ms]`` or ``Thrust (lbf)``, after a slash
or an underscore, ``Force/N`` or ``time_s``, or in a line of units below the header. A unit is never
guessed.
"""

import contextlib
import csv
import itertools
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.scenes import csv_file, units
from tipoff.scenes.csv_file import Line
from tipoff.scenes.faults import Fault

PAGE = "docs/reference/file_formats.md"
_MARKS = ("#", "%", "//", ";")  # of comment lines; a separator is no mark
_SEPARATORS = ("\t", ";", ",")
_SEARCHED = 1000  # lines in which the header is searched
_MOST_HEAD = 2**18  # bytes of them
_SHOWN = 200  # characters of a header in a message
_BRACKETS = re.compile(r"(.*?)[\s/]*(?:\[([^\[\]]*)\]|\(([^()]*)\))")
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")  # "1,234" may be 1234 or 1.234
_TIME = {"time", "t", "timestamp", "zeit"}
_SHORTEST = 3  # letters of a unit that may have another case, "Newtons"; "mN" and "MN" differ


class Written(NamedTuple):
    """Cells of the ``header``, none without one; cells of a line of units below it; lines of
    numbers."""

    header: list[str]
    units: list[str]
    rows: list[Line]

    def shown(self) -> str:
        """The header, or the first line, for a message."""
        cells = self.header or (self.rows[0][1] if self.rows else [])
        text = ", ".join(cells)
        return f"{'header' if self.header else 'no header, first line'} {text[:_SHOWN]!r}"

    def names(self) -> list[str]:
        """The cells of the header; without one, the numbers of the columns from 1 on."""
        widest = max((len(row) for _, row in self.rows[:_SEARCHED]), default=0)
        return self.header or [str(number + 1) for number in range(widest)]

    def unit(self, place: int, si: str) -> str | None:
        """The unit that the table states for a column of dimension ``si``; None without one."""
        stated = head(self.header[place], si)[1] if self.header else None
        below = self.units[place] if place < len(self.units) else ""
        return stated if stated is not None else below or None

    def places(self, name: str, si: str) -> list[int]:
        """Columns with this name, with or without its unit."""
        cells, name = self.names(), name.lstrip("#% ")  # a header may be behind a comment mark
        whole = [place for place, cell in enumerate(cells) if cell == name]
        return whole or [place for place, cell in enumerate(cells) if head(cell, si)[0] == name]

    def times(self) -> list[int]:
        """Columns whose name says that they are times."""
        return [
            place for place, cell in enumerate(self.header) if words(head(cell, "s")[0]) & _TIME
        ]

    def numbers(
        self, source: str, places: Iterable[int], gaps: bool = False
    ) -> tuple[list[np.ndarray], list[Fault]]:
        """Columns (n,) as they are written, and their faults (see ``csv_file.numbers``)."""
        places, names = list(places), self.names()
        rows = _with_points(self.rows, places)
        found = [csv_file.numbers(source, names[place], place, rows, gaps) for place in places]
        return [values for values, _ in found], [fault for _, wrong in found for fault in wrong]


def read(path: str | Path, data: bytes, is_header: Callable[[list[str]], bool]) -> Written:
    """The table in ``data``, the content of a file. The header is the first line that
    ``is_header`` accepts, above all numbers; otherwise the first line, if it has no numbers.

    Raises SceneError as ``csv_file.lines`` does.
    """
    data = _utf_8(data)
    top = data[:_MOST_HEAD].decode("utf-8-sig", "ignore").splitlines()[:_SEARCHED]
    separator = _separator(top)
    marks = tuple(mark for mark in _MARKS if mark != separator)
    rows = [
        (number, cells)
        for number, row in csv_file.listed(path, data, marks, separator)
        if any(cells := [cell.strip() for cell in row])
    ]
    first = next((k for k, (_, row) in enumerate(rows[:_SEARCHED]) if _is_data(row)), len(rows))
    above = [row for _, row in rows[: min(first, _SEARCHED)]]
    place = next((k for k, row in enumerate(above) if is_header(row)), None)
    if place is not None:
        return _written(_without_end(above[place]), rows[place + 1 :])
    for line in reversed(_above(top, separator)):
        cells = _cells(line.lstrip("".join(marks)), separator)
        if line.startswith(marks) and is_header(cells):
            return _written(_without_end(cells), rows)
    if above:
        return _written(_without_end(above[0]), rows[1:])
    return Written([], [], rows)


def head(cell: str, si: str) -> tuple[str, str | None]:
    """Name and unit of a column of dimension ``si`` from its cell in a header."""
    text = " ".join(cell.split())  # a quoted cell may hold line breaks
    found = _BRACKETS.fullmatch(text)
    unit = found and (found[2] if found[2] is not None else found[3]).strip()
    if found and unit and not unit.isdigit():  # a number counts the parts of a vector
        return found[1], unit
    for name, mark, after in (text.partition("/"), text.rpartition("_")):
        if name and mark:
            with contextlib.suppress(ValueError):
                scale(after.strip(), si)
                return name.strip(), after.strip()
    return text, None


def scale(unit: str, si: str) -> float:
    """Factor to ``si`` from a unit in a header. A number is no unit: "Load cell (5 kN)" states a
    range. Raises ValueError."""
    try:
        return units.to_si(f"1 {unit}", si)
    except ValueError:
        if len(unit) >= _SHORTEST:
            with contextlib.suppress(ValueError):
                return units.to_si(f"1 {unit.lower()}", si)
        raise


def stated(unit: str, si: str) -> float:
    """Factor to ``si`` from a unit that a user states, which may have a number, as "0.0048 m/s**2"
    of a count. Raises ValueError."""
    if not unit[:1].isdigit() and unit[:1] not in ("+", "-", "."):
        return scale(unit, si)
    factor = units.to_si(unit, si)
    if factor == 0.0:
        raise ValueError(f"{units.named(si)} (given {unit!r})")
    return factor


def words(name: str) -> set[str]:
    """The words of a name, in lower case."""
    return set(re.findall(r"[^\W\d_]+", name.lower()))


def _written(header: list[str], rows: list[Line]) -> Written:
    """A line without numbers below the header has the units, if one is a unit of time."""
    below = rows[0][1] if rows else []
    if units.are_units(below) and not any(map(_is_number, below)) and any(map(_is_time, below)):
        return Written(header, below, rows[1:])
    return Written(header, [], rows)


def _is_time(unit: str) -> bool:
    try:
        return bool(unit) and scale(unit, "s") > 0.0
    except ValueError:
        return False


def _utf_8(data: bytes) -> bytes:
    """The text in UTF-8 if it is in UTF-16 or in the code page of Windows; else unchanged."""
    with contextlib.suppress(UnicodeDecodeError):
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            return data.decode("utf-16").encode()
    if b"\0" not in data:
        try:
            data.decode("utf-8")
        except UnicodeDecodeError:
            with contextlib.suppress(UnicodeDecodeError):
                return data.decode("cp1252").encode()
    return data


def _separator(top: list[str]) -> str:
    """The separator with which a line has two numbers; without such a line, the one that occurs."""
    for line in top:
        for separator in _SEPARATORS:
            if separator in line and _is_data(_cells(line, separator)):
                return separator
    text = "\n".join(line for line in top if not line.startswith(_MARKS))
    return next((separator for separator in _SEPARATORS if separator in text), ",")


def _above(top: list[str], separator: str) -> list[str]:
    """The lines above the first one with numbers."""
    return list(itertools.takewhile(lambda line: not _is_data(_cells(line, separator)), top))


def _cells(line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]
    except csv.Error:
        return []


def _is_data(row: list[str]) -> bool:
    return sum(map(_is_number, row)) > 1


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def _without_end(cells: list[str]) -> list[str]:
    """The cells without empty ones at the end."""
    count = max((k + 1 for k, cell in enumerate(cells) if cell), default=0)
    return cells[:count]


def _with_points(rows: list[Line], places: list[int]) -> list[Line]:
    """The lines with decimal points in place of decimal commas. Nothing changes if a cell of the
    ``places`` has a point too, or if all commas can be marks of thousands."""
    cells = [row[place] for _, row in rows for place in places if place < len(row)]
    commas = [cell for cell in cells if "," in cell]
    if not commas or any("." in cell for cell in cells) or all(map(_GROUPED.fullmatch, commas)):
        return rows
    return [(number, [cell.replace(",", ".") for cell in row]) for number, row in rows]
