"""A table of text: any separator, comments, a block of text in front, decimal commas.

The table is from the first line of numbers to the last one. Its header is in front of it,
also in a comment; the unit of a column is in brackets after its name, or in the line below the header.
"""

import csv
import io
import re
from collections.abc import Collection, Iterator

from tipoff.comparison.curve_files.table import Table
from tipoff.scenes import units
from tipoff.scenes.csv_file import MOST_LINES, Line
from tipoff.scenes.faults import Fault, SceneError

_COMMENTS = ("#", "%", "!", "//")
_NUMBER = re.compile(r'\s*"?\s*[+-]?(\d|[.,]\d|nan\b|inf\b)', re.I)
_DECIMAL_COMMAS = re.compile(
    r"\s*[+-]?\d+(,\d+)?([eE][+-]?\d+)?(\s+[+-]?\d+(,\d+)?([eE][+-]?\d+)?)+\s*"
)
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_HEAD = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")
_WORD = re.compile(r"\S+(?:[ \t]+[\[(][^\])\s]*[\])])?")  # between blanks, with its unit
_LONGEST = 2**20  # characters of a line
_MOST_COLUMNS = 1000
_SUMMARY = ("minimum", "maximum", "total")  # last lines of a report of Abaqus
_MOST_BEFORE = 1000  # lines in front of the table that may be its header


def read(source: str, data: bytes, wanted: Collection[str]) -> Table:
    """The table in ``data``. Of the lines that may be the header, the one with most of the
    ``wanted`` names is taken. Raises SceneError for what is no table of text."""
    try:
        lines = list(io.StringIO(data.decode("utf-8-sig"), newline=""))
        if any(len(line) >= _LONGEST for line in lines):
            raise csv.Error(f"a line of {_LONGEST:,} characters or more")
        separator, comma = _separator([line for line in lines if not _is_comment(line)])
        before, body = _parts(list(_cells(lines, separator)), separator is None)
    except (UnicodeDecodeError, csv.Error) as error:
        raise SceneError([Fault(source, "file", str(error), "a CSV file of text")]) from error
    if not body:
        given, words = "no line of numbers", "a table with times in a column"
        raise SceneError([Fault(source, "file", given, words)])
    if len(body) > MOST_LINES:
        raise SceneError([Fault(source, "file", "more lines", f"{MOST_LINES:,} lines at most")])
    if comma or separator != ",":
        body = [
            (number, [_COMMA.sub(".", cell) if "," in cell else cell for cell in row])
            for number, row in body
        ]
    names, stated = _header(before, len(body[0][1]), wanted)
    return Table(names, stated, body)


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENTS)


def _separator(lines: list[str]) -> tuple[str | None, bool]:
    """The separator of the cells, None for blanks, and whether commas are decimal."""
    sample = [line for line in lines if _NUMBER.match(line)][:100] or lines[:100]
    for one in ("\t", ";"):
        if any(one in line for line in sample):
            return one, True
    if sample and all(_DECIMAL_COMMAS.fullmatch(line) for line in sample):
        return None, True
    return ("," if any("," in line for line in sample) else None), False


def _cells(lines: list[str], separator: str | None) -> Iterator[tuple[Line, bool]]:
    """Each line that is not blank with its number and cells, and whether it is a comment."""
    # a comment is no CSV; the blank line in its place keeps the numbers of the others
    plain = ["\n" if _is_comment(line) else line for line in lines]
    rows: Iterator[Line]
    if separator is None:
        rows = ((number, _split(line, None)) for number, line in enumerate(plain, 1))
    else:
        reader = csv.reader(plain, delimiter=separator, strict=True)
        rows = ((reader.line_num, row) for row in reader)
    comments = iter([(number, line) for number, line in enumerate(lines, 1) if _is_comment(line)])
    comment = next(comments, None)
    for number, row in rows:
        while comment is not None and comment[0] <= number:
            text = comment[1].strip().lstrip("".join(_COMMENTS))
            yield (comment[0], _split(text, separator)), True
            comment = next(comments, None)
        if len(row) > _MOST_COLUMNS:
            raise csv.Error(f"{len(row)} columns, {_MOST_COLUMNS} at most")
        if any(map(str.strip, row)):
            yield (number, row), False


def _split(text: str, separator: str | None) -> list[str]:
    return _WORD.findall(text) if separator is None else text.split(separator)


def _parts(cells: list[tuple[Line, bool]], has_blanks: bool) -> tuple[list[Line], list[Line]]:
    """Lines in front of the table, and those of the table. Between blanks a title may have numbers,
    so the first line has as many cells as the last one with numbers."""
    plain = (row for (_, row), is_comment in reversed(cells) if not is_comment)
    width = len(next(filter(_has_numbers, plain), []))
    first = len(cells)
    for place, ((_, row), is_comment) in enumerate(cells):
        if not is_comment and _has_numbers(row) and (not has_blanks or len(row) == width):
            first = place
            break
    body = [line for line, is_comment in cells[first:] if not is_comment]
    while body and body[-1][1][0].strip().lower() in _SUMMARY:
        body.pop()
    return [line for line, _ in cells[max(0, first - _MOST_BEFORE) : first]], body


def _has_numbers(row: list[str]) -> bool:
    """Whether the first cell that is not empty is a number, or two others are."""
    texts = list(filter(str.strip, row))
    return _is_number(texts[0]) or sum(map(_is_number, texts)) > 1


def _is_number(cell: str) -> bool:
    try:
        float(_COMMA.sub(".", cell))
    except ValueError:
        return False
    return True


def _header(
    before: list[Line], width: int, wanted: Collection[str]
) -> tuple[list[str], list[str | None]]:
    """Names and units of the columns."""
    if not before:
        return [], [None] * width
    heads = [[_head(cell) for cell in row] for _, row in before]
    alike = [
        (sum(name in wanted for name in _spellings(row)), len(row) == width, place)
        for place, row in enumerate(heads)
    ]
    place = max(alike, key=lambda item: item[:2])[2]
    if not alike[place][0]:  # the last line that fits and is no line of units
        fitting = [at for _, fits, at in alike if fits and not _has_units(before[at][1])]
        if not fitting:
            return [], [None] * width
        place = fitting[-1]
    chosen = heads[place]
    texts = [" ".join(cell.split()) for cell in before[place][1]]
    # a name in --columns may have the brackets
    names = [
        text if text in wanted and name not in wanted else name
        for text, (name, _) in zip(texts, chosen)
    ]
    stated = [unit for _, unit in chosen]
    below = [row for _, row in before[place + 1 :] if len(row) == len(chosen)]
    if below and units.are_units(below[0]):
        stated = [unit or cell.strip() or None for unit, cell in zip(stated, below[0])]
    return names, stated


def _spellings(row: list[tuple[str, str | None]]) -> set[str]:
    return {
        spelling
        for name, unit in row
        for spelling in (name, f"{name} [{unit}]", f"{name} ({unit})")
    }


def _has_units(cells: list[str]) -> bool:
    """Whether a cell is a unit that curves have."""

    def is_unit(text: str) -> bool:
        for si in ("s", "m/s", "rad/s"):
            try:
                units.to_si(f"1 {text.strip()}", si)
            except ValueError:
                continue
            return True
        return False

    return any(is_unit(cell.strip("[]() ")) for cell in cells if cell.strip())


def _head(cell: str) -> tuple[str, str | None]:
    """Name and unit of a column."""
    found = _HEAD.fullmatch(" ".join(cell.split()))  # a quoted cell may hold line breaks
    assert found is not None
    return found[1], found[2]
