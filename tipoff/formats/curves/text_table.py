"""A table of text: any separator, comments, a block of text in front, decimal commas.

The table is from the first line of numbers to the last one. Its header is in front of it,
also in a comment; the unit of a column is in brackets after its name, or in the line below the header.
"""

import re

from tipoff.faults import Fault, SceneError
from tipoff.files import MOST_TEXT
from tipoff.formats.csv_file import name_and_unit
from tipoff.formats.curves.record import Asked, CurveFile, CurveFormat, CurveTable
from tipoff.formats.instrument_table import is_unit, read_table

_COMMA = re.compile(r"(?<=\d),(?=\d)")


def read_text_table(file: CurveFile, asked: Asked) -> CurveTable:
    """The table in a file. Of the lines that may be the header, the one with most of the names that are
    ``asked`` is taken. Raises SceneError for what is no table of text."""
    source, data, wanted = file.source, file.data, {*asked.unsigned(), *asked.names}
    if len(data) > MOST_TEXT:
        given = f"more than {MOST_TEXT // 2**20} MiB"
        raise SceneError([Fault(source, "file", given, "a smaller table")])
    names_asked = {name for name in wanted if not name.isdecimal()}  # a title may have numbers

    def likeness(cells: list[str]) -> float:
        known = sum(not names_asked.isdisjoint(_spellings(cell)) for cell in cells)
        return known or 0.5 * (not any(map(is_unit, filter(None, cells))))

    table = read_table(source, data, likeness, is_loose=True)
    if not table.rows:
        given, words = "no line of numbers", "a table with times in a column"
        raise SceneError([Fault(source, "file", given, words)])
    heads = [name_and_unit(cell) for cell in table.header]
    below = [cell or None for cell in table.units] or [None] * len(heads)
    # a name in --columns may have the brackets
    names = [
        text if (text := " ".join(cell.split())) in wanted and name not in wanted else name
        for cell, (name, _) in zip(table.header, heads)
    ]
    rows = table.rows
    if table.separator != ",":
        rows = [(number, [_COMMA.sub(".", cell) for cell in row]) for number, row in rows]
    return CurveTable(names, [unit or other for (_, unit), other in zip(heads, below)], rows)


def _spellings(cell: str) -> set[str]:
    name, unit = name_and_unit(cell)
    return {name, f"{name} [{unit}]", f"{name} ({unit})"}


FORMATS = (
    CurveFormat(
        "table of text (CSV, Adams .tab, Abaqus .rpt, Exudyn)",
        read_text_table,
        [
            (
                "table of text: CSV, Adams `.tab`, Abaqus `.rpt`, sensor files of Exudyn, output of Chrono, "
                "MuJoCo or numpy",
                "columns by name or number",
                "none",
                "in the file or in `--units`",
                "body, unless `--axes scene`",
            )
        ],
        is_any_other=True,
    ),
)
