"""Tables of numbers in CSV files: lines, columns, units and cells. All faults of a table are found
in one pass.

A table has a header. The unit of a column is in brackets after its name, ``rate_x [deg/s]``, or in
the second line. Other columns are ignored.
"""

import contextlib
import csv
import io
import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from tipoff import units
from tipoff.faults import MOST_ALIKE, Fault, SceneError
from tipoff.files import encoding, open_input

Line = tuple[int, list[str]]  # its number in the file, and its cells
_HEAD = re.compile(r"(.*?)[\s/]*(?:\[([^\[\]]*)\]|\(((?:[^()]|\([^()]*\))*)\))")
_WORD = re.compile(r"\S+(?:[ \t]+[\[(][^\])\s]*[\])])?")  # between blanks, with its unit
_LONGEST = 2**20  # characters of a line
_MOST_COLUMNS = 1000
MOST_LINES = 1_000_000  # of a curve or a log, which is kept in memory as text
_SHOWN = 3  # lines listed for one fault; the others are counted
_CELL = 80  # characters of a cell that a fault shows


def lines(
    path: str | Path,
    data: bytes | None = None,
    comments: tuple[str, ...] = (),
    separator: str | None = ",",
) -> Iterator[Line]:
    """Lines of a CSV file that are not blank and do not begin with one of the ``comments``, one
    after another. ``data`` is the content of the file if the caller has read it. Without a
    ``separator`` cells are between blanks.

    Raises SceneError for a file that cannot be read, is not text, or is not CSV.
    """
    try:
        # Spreadsheets put a byte-order mark in front of UTF-8. "utf-8-sig" removes it.
        with (
            open_input(path) if data is None else io.BufferedReader(io.BytesIO(data)) as content,
            io.TextIOWrapper(content, encoding(content.peek(4)), newline="") as stream,
        ):
            for number, row in _rows(_text(stream, comments), separator):
                if len(row) > _MOST_COLUMNS:
                    raise csv.Error(f"{len(row)} columns, {_MOST_COLUMNS} at most")
                if len(row) > 1 or (row and row[0].strip()):
                    yield number, row
    except OSError as error:
        given = error.strerror or str(error)
        raise SceneError([Fault(str(path), "file", given, "a readable CSV file")]) from error
    except (UnicodeError, csv.Error) as error:
        raise SceneError([Fault(str(path), "file", str(error), "a CSV file of text")]) from error


def listed(
    path: str | Path,
    data: bytes | None = None,
    comments: tuple[str, ...] = (),
    separator: str | None = ",",
) -> list[Line]:
    """``lines`` as a list. Raises SceneError also for more than ``MOST_LINES`` lines."""
    found = list(itertools.islice(lines(path, data, comments, separator), MOST_LINES + 1))
    if len(found) > MOST_LINES:
        raise SceneError([Fault(str(path), "file", "more lines", f"{MOST_LINES:,} lines at most")])
    return found


def _text(stream: TextIO, comments: tuple[str, ...]) -> Iterator[str]:
    """Lines of text. A comment line becomes empty, so that the others keep their numbers."""
    while line := stream.readline(_LONGEST):
        if len(line) == _LONGEST:
            raise csv.Error(f"a line of {_LONGEST:,} characters or more")
        yield "\n" if line.lstrip().startswith(comments) else line


def _rows(text: Iterator[str], separator: str | None) -> Iterator[Line]:
    if separator is None:
        yield from ((number, between_blanks(line)) for number, line in enumerate(text, 1))
        return
    reader = csv.reader(text, strict=True, delimiter=separator)
    for row in reader:
        yield reader.line_num, row


def between_blanks(line: str) -> list[str]:
    """The cells of a line between blanks; a unit in brackets belongs to the cell before it."""
    return _WORD.findall(line)


def name_and_unit(cell: str) -> tuple[str, str | None]:
    """Name and unit of a column from its cell in a header: ``Time [ms]`` or ``Time (ms)``."""
    text = " ".join(cell.split())  # a quoted cell may hold line breaks
    if (found := _HEAD.fullmatch(text)) is None:
        return text, None
    return found[1], (found[2] if found[2] is not None else found[3]).strip()


def numbers(
    source: str, name: str, place: int, table: list[Line], gaps: bool = False
) -> tuple[np.ndarray, list[Fault]]:
    """The column (n,) ``name``, and its faults: cells without a finite number.

    With ``gaps`` an empty cell becomes NaN, and NaN and inf are no faults.
    """
    with contextlib.suppress(ValueError, IndexError):  # a table without faults needs no loop
        values = np.array([float(row[place]) for _, row in table])
        if gaps or np.isfinite(values).all():
            return values, []
    values = np.full(len(table), np.nan)
    wrong: dict[str, list[int]] = {}
    for index, (number, row) in enumerate(table):
        text = _cell(row, place)
        try:
            values[index] = float(text)
        except ValueError:
            sound = gaps and not text and place < len(row)
        else:
            sound = gaps or np.isfinite(values[index])
        if not sound:
            wrong.setdefault(_quoted(text), []).append(number)
    expected = "a number" if gaps else "a finite number in each line"
    shown = [f"{text} in {listed_lines(where)}" for text, where in list(wrong.items())[:MOST_ALIKE]]
    if rest := [number for where in list(wrong.values())[MOST_ALIKE:] for number in where]:
        shown.append(f"other text in {listed_lines(rest)}")
    return values, [Fault(source, name, given, expected) for given in shown]


def factor_to_si(
    source: str, name: str, unit: str | None, wanted: str
) -> tuple[float, list[Fault]]:
    """Factor from ``unit`` to the SI unit ``wanted`` of the column ``name``; NaN with a fault."""
    if not unit and wanted != "dimensionless":
        return np.nan, [
            Fault(source, name, "no unit", f'the unit of the column, such as "{wanted}"')
        ]
    try:
        return units.to_si(f"1 {unit or ''}", wanted), []
    except ValueError as error:
        return np.nan, [Fault(source, name, repr(unit), str(error))]


def _cell(row: list[str], place: int) -> str:
    return row[place].strip() if place < len(row) else ""


def _quoted(text: str) -> str:
    if len(text) > _CELL:
        text = f"{text[:_CELL]} ..."
    return repr(text) if text else "nothing"


def listed_lines(where: list[int]) -> str:
    """Numbers of lines in words, the first few of them."""
    more = [f"and {len(where) - _SHOWN} more"] if len(where) > _SHOWN else []
    return f"line{'s' if len(where) > 1 else ''} " + ", ".join([*map(str, where[:_SHOWN]), *more])
