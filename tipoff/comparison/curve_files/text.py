"""A table of text: any separator, comments, a block of text in front, decimal commas.

The table is from the first line of numbers to the last one. Its header is in front of it,
also in a comment; the unit of a column is in brackets after its name, or in the line below the header.
"""

import re

from tipoff.comparison.curve_files.table import Table
from tipoff.faults import Fault, SceneError
from tipoff.formats import instrument_table
from tipoff.formats.csv_file import head

_COMMA = re.compile(r"(?<=\d),(?=\d)")


def read(source: str, data: bytes, wanted: set[str]) -> Table:
    """The table in ``data``. Of the lines that may be the header, the one with most of the
    ``wanted`` names is taken. Raises SceneError for what is no table of text."""
    asked = {name for name in wanted if not name.isdecimal()}  # a title may have numbers

    def likeness(cells: list[str]) -> float:
        known = sum(not asked.isdisjoint(_spellings(cell)) for cell in cells)
        return known or 0.5 * (not any(map(instrument_table.is_unit, filter(None, cells))))

    table = instrument_table.read_table(source, data, likeness, is_loose=True)
    if not table.rows:
        given, words = "no line of numbers", "a table with times in a column"
        raise SceneError([Fault(source, "file", given, words)])
    heads = [head(cell) for cell in table.header]
    below = [cell or None for cell in table.units] or [None] * len(heads)
    # a name in --columns may have the brackets
    names = [
        text if (text := " ".join(cell.split())) in wanted and name not in wanted else name
        for cell, (name, _) in zip(table.header, heads)
    ]
    rows = table.rows
    if table.separator != ",":
        rows = [(number, [_COMMA.sub(".", cell) for cell in row]) for number, row in rows]
    return Table(names, [unit or other for (_, unit), other in zip(heads, below)], rows)


def _spellings(cell: str) -> set[str]:
    name, unit = head(cell)
    return {name, f"{name} [{unit}]", f"{name} ({unit})"}
