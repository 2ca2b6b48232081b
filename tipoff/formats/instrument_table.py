"""Tables that instruments and other programs write. A table may have commas, semicolons, tabs or
blanks between its cells, comment lines, lines of text before its header, a header behind a comment mark,
and decimal commas.

The unit of a column is in brackets after its name, ``Time [ms]`` or ``Thrust (lbf)``, after a slash
or an underscore, ``Force/N`` or ``time_s``, or in a line of units below the header. A unit is never
guessed.
"""

import contextlib
import csv
import io
import itertools
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff import units
from tipoff.faults import Fault, SceneError
from tipoff.formats import csv_file
from tipoff.formats.csv_file import Line

PAGE = "docs/reference/file_formats.md"
_MARKS = ("#", "%", "!", "//", ";")  # of comment lines; a separator is no mark
_SEPARATORS = ("\t", ";", ",")
_SEARCHED = 1000  # lines in front of the numbers in which the header is searched
_SAMPLE = 100  # lines in which the separator is searched
_COLUMNS = ("s", "N", "m/s", "rad/s", "m/s**2")  # units of which a line of units has one
_SUMMARY = ("minimum", "maximum", "total")  # last lines of a report of Abaqus
_ALIKE = 10  # lines of a program, which writes all numbers in one way
_SHOWN = 200  # characters of a header in a message
_NUMBER = re.compile(r'\s*"?\s*[+-]?(\d|[.,]\d|nan\b|inf\b)', re.I)
_DECIMAL_COMMAS = re.compile(
    r"\s*[+-]?\d+(,\d+)?([eE][+-]?\d+)?( +[+-]?\d+(,\d+)?([eE][+-]?\d+)?)+\s*"
)
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")  # "1,234" may be 1234 or 1.234
_PARTS = re.compile(r"[+-]?\d*(?:[.,](\d*))?(?:[eEdD][+-]?(\d*))?")
_TIME = {"time", "t", "timestamp", "zeit"}
_SHORTEST = 3  # letters of a unit that may have another case, "Newtons"; "mN" and "MN" differ


class _Head(NamedTuple):
    """A line in front of the numbers."""

    number: int
    is_plain: bool  # no comment
    cells: list[str]


class Written(NamedTuple):
    """Cells of the ``header``, none without one; cells of a line of units below it; lines of
    numbers; what is between cells, None for blanks."""

    header: list[str]
    units: list[str]
    rows: list[Line]
    separator: str | None = ","

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
        stated = name_and_unit(self.header[place], si)[1] if self.header else None
        below = self.units[place].strip("[]() ") if place < len(self.units) else ""
        return stated if stated is not None else below or None

    def places(self, name: str, si: str) -> list[int]:
        """Columns with this name, with or without its unit."""
        cells, name = self.names(), name.lstrip("#% ")  # a header may be behind a comment mark
        whole = [place for place, cell in enumerate(cells) if cell == name]
        return whole or [
            place for place, cell in enumerate(cells) if name_and_unit(cell, si)[0] == name
        ]

    def times(self) -> list[int]:
        """Columns whose name says that they are times."""
        return [
            place
            for place, cell in enumerate(self.header)
            if words(name_and_unit(cell, "s")[0]) & _TIME
        ]

    def numbers(
        self, source: str, places: Iterable[int], gaps: bool = False
    ) -> tuple[list[np.ndarray], list[Fault]]:
        """Columns (n,) as they are written, and their faults (see ``csv_file.numbers``)."""
        places, names = list(places), self.names()
        rows = _with_points(self.rows, places)
        found = [csv_file.numbers(source, names[place], place, rows, gaps) for place in places]
        return [values for values, _ in found], [fault for _, wrong in found for fault in wrong]


def read_table(
    path: str | Path, data: bytes, likeness: Callable[[list[str]], float], is_loose: bool = False
) -> Written:
    """The table in ``data``, the content of a file. The header is the line above the numbers, also
    in a comment, that has the greatest ``likeness``; below 1 it must have as many cells as the
    numbers. If none has, it is the first such line that is no comment. Lines at the end with a
    summary are left out.

    With ``is_loose`` rows of text may be between blanks too, and lines between the header and the numbers are
    left out, and a last line that is cut. Raises SceneError as ``csv_file.lines`` does, and for a last
    number that is cut.
    """
    data = _utf_8(data)
    lines = list(io.StringIO(data.decode("utf-8-sig", "ignore"), newline=""))
    separator = _separator(lines, is_loose)
    marks = tuple(mark for mark in _MARKS if mark != separator)
    rows = [
        (number, cells)
        for number, row in csv_file.listed(path, data, marks, separator)
        if any(cells := [cell.strip() for cell in row])
    ]
    if data[-1:] not in b"\r\n" and (cut := _cut_cell(rows)) is not None:
        if not is_loose:
            given = f"a last line without its end, with fewer digits in {cut!r} than before"
            raise SceneError([Fault(str(path), "file", given, "a whole file")])
        rows.pop()
    while rows and rows[-1][1][0].lower() in _SUMMARY:
        rows.pop()
    # between blanks a title may have numbers
    width = next((len(row) for _, row in reversed(rows) if _is_data(row)), None)
    first = next(
        (
            k
            for k, (_, row) in enumerate(rows)
            if _is_data(row) and (separator or len(row) == width)
        ),
        len(rows),
    )
    width = len(rows[first][1]) if first < len(rows) else None
    above = [_Head(number, True, cells) for number, cells in rows[:first] if not _is_data(cells)]
    end = rows[first][0] if width else len(lines) + 1
    for number, line in enumerate(lines[: end - 1], 1):
        if (text := line.strip()).startswith(marks):
            cells = _cells(text.lstrip("".join(marks)), separator)
            above += [] if _is_data(cells) else [_Head(number, False, cells)]
    above = sorted(above)[-_SEARCHED:] if width else sorted(above)[:_SEARCHED]
    chosen = _header(above, width, likeness)
    if chosen is None:
        return Written([], [], rows[first:] if is_loose else rows, separator)
    below = _units_below(chosen, above)
    used = {chosen.number, below.number} if below else {chosen.number}
    body = [row for row in rows if row[0] > chosen.number and row[0] not in used]
    return Written(
        _without_end(chosen.cells),
        below.cells if below else [],
        rows[first:] if is_loose else body,
        separator,
    )


def name_and_unit(cell: str, si: str) -> tuple[str, str | None]:
    """Name and unit of a column of dimension ``si`` from its cell in a header."""
    text, unit = csv_file.name_and_unit(cell)
    if unit and not unit.isdigit():  # a number counts the parts of a vector
        return text, unit
    text = " ".join(cell.split())
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


def _cut_cell(rows: list[Line]) -> str | None:
    """The last cell of a table that ends without a line end, if it may be cut: the lines before have a
    number there with as many decimals and digits of the exponent, and it has fewer, or its line has
    fewer cells. None otherwise."""
    before = [cells for _, cells in rows[-_ALIKE - 1 : -1]]
    if len(before) < _ALIKE or len({len(cells) for cells in before}) > 1:
        return None
    last = rows[-1][1]
    place = min(len(last), len(before[0])) - 1
    ways = {_digits(cells[place]) for cells in before}
    own, usual = _digits(last[place]), ways.pop()
    if ways or own is None or usual is None:
        return None
    is_shorter = own != usual and all(one <= other for one, other in zip(own, usual))
    return last[place] if is_shorter or len(last) < len(before[0]) else None


def _digits(cell: str) -> tuple[int, int] | None:
    """Decimals and digits of the exponent of a number, -1 without a point or an exponent; None for other
    text."""
    if (found := _PARTS.fullmatch(cell)) is None:
        return None
    decimals, exponent = (-1 if part is None else len(part) for part in found.groups())
    return decimals, exponent


def _header(
    above: list[_Head], width: int | None, likeness: Callable[[list[str]], float]
) -> _Head | None:
    """The line that is most alike; of equal ones the last, and no comment before a comment."""
    alike = []
    for head in above:
        degree, fits = likeness(head.cells), width in (None, len(head.cells))
        if degree >= 1.0 or (degree and fits):
            alike.append((degree, fits, head.is_plain, head))
    if alike:
        return max(alike)[-1]
    return next(
        (head for head in above if head.is_plain and width in (None, len(head.cells))), None
    )


def _units_below(header: _Head, above: list[_Head]) -> _Head | None:
    """The line of units below the header, which has as many cells; a comment only if it is the only
    such line."""
    below = [head for head in above if head.number > header.number]
    alike = [head for head in below if len(head.cells) == len(header.cells)]
    plain = [head for head in alike if head.is_plain]
    for head in plain[:1] or alike:
        count = sum(map(is_unit, head.cells))
        if units.are_units(head.cells) and 2 * count > (0 if head.is_plain else len(head.cells)):
            return head
    return None


def is_unit(cell: str) -> bool:
    """Whether a cell is a unit of a quantity that tables have."""
    for si in _COLUMNS:
        with contextlib.suppress(ValueError):
            return scale(cell.strip("[]() "), si) > 0.0
    return False


def _utf_8(data: bytes) -> bytes:
    """The text in UTF-8 if it is in the code page of Windows; else unchanged."""
    if b"\0" not in data:
        try:
            data.decode("utf-8")
        except UnicodeDecodeError:
            with contextlib.suppress(UnicodeDecodeError):
                return data.decode("cp1252").encode()
    return data


def _separator(lines: list[str], is_loose: bool) -> str | None:
    """The separator with which a line has two numbers, first of lines that begin with one; without
    such a line None for blanks, if ``is_loose``, or the separator that occurs."""
    plain = [line for line in lines if not line.lstrip().startswith(_MARKS[:-1])]
    begun = list(itertools.islice(filter(_NUMBER.match, plain), _SAMPLE))
    if begun and (all(map(_DECIMAL_COMMAS.fullmatch, begun)) or all(map(_has_blanks, begun))):
        return None
    for line in itertools.chain(begun, plain[:_SEARCHED]):
        for separator in _SEPARATORS:
            if separator in line and _is_data(_cells(line, separator)):
                return separator
    text = "".join(plain[:_SEARCHED])
    occurring = next((separator for separator in _SEPARATORS if separator in text), ",")
    return None if is_loose else occurring


def _has_blanks(line: str) -> bool:
    """Whether two numbers of a line have blanks between them, and nothing else is between cells."""
    return not any(mark in line for mark in _SEPARATORS) and _is_data(line.split())


def _cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return csv_file.between_blanks(line)
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
