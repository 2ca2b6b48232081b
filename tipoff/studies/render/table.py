"""A table that is rendered as HTML, as Markdown and for the terminal."""

import io
import re
import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import compress
from numbers import Integral, Real
from operator import attrgetter
from typing import Any

from jinja2 import Environment
from markupsafe import Markup, escape

from tipoff.studies.render.column import Column as Column
from tipoff.studies.render.column import of_record
from tipoff.uncertain import LEAST, NOTHING, STEPS, Measured, number, rounded


@dataclass(frozen=True)
class Noted:
    """A cell with a remark after it, which the page shows in small type."""

    value: Any
    remark: str


Cells = Sequence[tuple[Column | str, str | Callable[[Any], Any]]]
"""Columns with their cells: the key of the cell in a record, or a function that makes the cell
from the record."""


@dataclass(frozen=True)
class Table:
    """``columns`` by title or as records, and ``rows`` of cells.

    A cell is a number, a sequence of numbers, text, yes or no, None, ``Noted`` or ``Measured``.
    ``title`` is the paragraph above the table, ``notes`` are those below it, ``details`` those on
    columns of detail; ``name`` is the id on the page.
    ``kinds`` holds for each row "good", "bad", "doubt", "best" or "". Words between backticks are
    code.
    """

    columns: Sequence[Column | str]
    rows: Sequence[Sequence[Any]]
    notes: tuple[str, ...] = ()
    title: str = ""
    name: str = ""
    kinds: Sequence[str] = ()
    dense: bool = False
    details: tuple[str, ...] = ()

    @classmethod
    def of(cls, records: Iterable[Any], columns: Cells, **others: Any) -> "Table":
        """The table with a row for each of the ``records``; ``others`` are further fields."""
        rows = [
            tuple(cell(record) if callable(cell) else record[cell] for _, cell in columns)
            for record in records
        ]
        return cls([column for column, _ in columns], rows, **others)

    @classmethod
    def of_records(
        cls,
        records: Sequence[Any],
        *columns: str | tuple[Column | str, Callable[[Any], Any]],
        kind: type | None = None,
        **others: Any,
    ) -> "Table":
        """The table of ``records`` of the dataclass ``kind``, by default that of the first record.
        A column is the name of a field that declares it (``column.of_record``), or a head with a
        function that makes the cell from the record. Without ``columns``: all fields that declare
        one. ``others`` are further fields."""
        declared = of_record(kind or type(records[0]))
        chosen = columns or tuple(declared)
        heads = [declared[item] if isinstance(item, str) else item[0] for item in chosen]
        cells = [attrgetter(item) if isinstance(item, str) else item[1] for item in chosen]
        return cls(heads, [tuple(cell(record) for cell in cells) for record in records], **others)

    def brief(self) -> "Table":
        """The table without its columns of detail and the notes on them, as the terminal shows it."""
        shown = [not (isinstance(item, Column) and item.detail) for item in self.columns]
        rows = [tuple(compress(row, shown)) for row in self.rows]
        return replace(self, columns=list(compress(self.columns, shown)), rows=rows, details=())

    @property
    def heads(self) -> list[str]:
        """The head of every column."""
        return [column.head for column in _records(self)]


def percent(value: float | None, form: str = ".3g") -> str:
    """A fraction as a number of percent."""
    return number(None if value is None else 100.0 * value, form, STEPS["%"])


def span(low: float | None, high: float | None, form: str = ".3g") -> str:
    """From ``low`` to ``high``; a dash if both are missing."""
    return (
        NOTHING if low is None and high is None else f"{number(low, form)} to {number(high, form)}"
    )


def estimate(row: Any, form: str = ".3g") -> Any:
    """The ``value`` of a record, with its bounds ``low`` and ``high`` as a remark if it has any;
    all rounded to half the width between the bounds."""
    return bounded(row.value, row.low, row.high, form)


def bounded(value: float, low: float | None, high: float | None, form: str = ".3g") -> Any:
    """A value with its bounds, as ``estimate`` shows them."""
    if low is None and high is None:
        return value
    if low is None or high is None or high <= low:
        return Noted(value, span(low, high, form))
    half = 0.5 * (high - low)
    bounds = (rounded(bound, half, LEAST * half) for bound in (low, high))
    return Noted(Measured(value, half, apart=True), " to ".join(bounds))


def plain(value: Any, column: Column = Column("")) -> str:
    """A cell as text."""
    if value is None:
        return column.nothing
    if isinstance(value, Noted):
        return f"{plain(value.value, column)} ({value.remark})"
    if isinstance(value, Measured):
        return column.measured(value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Integral):
        return f"{value:,}"
    if isinstance(value, Real):
        return column.text(float(value))
    if isinstance(value, (list, tuple)):
        return ", ".join(plain(part, column) for part in value) or column.nothing
    return str(value)


def markdown(table: Table) -> str:
    """The table with its title and notes as Markdown."""
    lines = [_line(table.heads), "|---" * len(table.columns) + "|"]
    for row, kind in zip(_texts(table), _kinds(table)):
        lines.append(_line([f"**{row[0]}**", *row[1:]] if kind == "best" else row))
    return "\n\n".join(
        [*([table.title] if table.title else []), "\n".join(lines), *table.notes, *table.details]
    )


def terminal(table: Table) -> str:
    """The table in brief with its title and notes as lines of text, as wide as the terminal at most."""
    from rich import box
    from rich.console import Console
    from rich.table import Table as Grid
    from rich.text import Text

    table = table.brief()
    grid = Grid(box=box.SIMPLE_HEAD, pad_edge=False)
    rows = _texts(table)
    columns = list(zip(table.heads, *rows))
    limit = max(100, shutil.get_terminal_size((160, 24)).columns)
    widths = _widths(columns, limit - 3 * len(columns))
    for (head, *cells), width in zip(columns, widths):
        right = all(_numeric(cell) for cell in cells if cell)
        grid.add_column(Text(head), justify="right" if right else "left", width=width)
    for row in rows:
        grid.add_row(*map(Text, row))
    stream = io.StringIO()
    Console(file=stream, width=max(limit, sum(widths) + 3 * len(columns))).print(grid)
    drawn = "\n".join(line.rstrip() for line in stream.getvalue().strip("\n").splitlines())
    return "\n".join([*([table.title] if table.title else []), drawn, *table.notes])


def _widths(columns: Sequence[Sequence[str]], limit: int) -> list[int]:
    """Widths of columns of text, in all at most ``limit`` if this cuts no word."""
    widths = [max(map(len, cells)) for cells in columns]
    words = [max(map(len, " ".join(cells).split()), default=0) for cells in columns]
    while sum(widths) > limit and widths != words:
        wide = max(
            range(len(widths)), key=lambda place: (widths[place] > words[place], widths[place])
        )
        widths[wide] -= 1
    return widths


def html(table: Table) -> Markup:
    """The table with its title and notes as HTML; all text is escaped."""
    rows = [
        (kind, [_cell(value, column.of_row(row)) for value, column in zip(row, _records(table))])
        for row, kind in zip(table.rows, _kinds(table))
    ]
    judged = bool({"good", "bad", "doubt"} & set(table.kinds))
    return Markup(_TEMPLATE.render(table=table, rows=rows, judged=judged))


def inline(text: str) -> Markup:
    """Text as HTML: escaped, with powers of ten as exponents and code marked."""
    if hasattr(text, "__html__"):
        return Markup(text)
    shown = _POWER.sub(lambda found: f"·10<sup>{int(found[1])}</sup>", str(escape(text)))
    return Markup(_CODE.sub(r"<code>\1</code>", shown))


_POWER = re.compile(r"(?<=\d)e([+-]\d\d+)\b")
_NUMBER = re.compile(r"[+-]?<?\d|–")
_CODE = re.compile("`([^`]+)`")
_ENVIRONMENT = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
_ENVIRONMENT.filters["inline"] = inline
_TEMPLATE = _ENVIRONMENT.from_string(
    """
{% if table.title %}<p>{{ table.title | inline }}</p>{% endif %}
<div class="wide"><table
{%- if table.name %} id="{{ table.name }}"{% endif %}
{%- if table.dense or judged %} class="{{ "dense" if table.dense }}{{ " judged" if judged }}"{% endif %}>
<thead><tr>{% for head in table.heads %}<th>{{ head | inline }}</th>{% endfor %}</tr></thead>
<tbody>
{% for kind, cells in rows %}
<tr{% if kind %} class="{{ kind }}"{% endif %}>
{%- for right, cell in cells %}
<td{% if right %} class="number"{% endif %}>{{ cell }}</td>
{%- endfor %}
</tr>
{% endfor %}
</tbody></table></div>
{% for note in table.notes + table.details %}<p class="caption">{{ note | inline }}</p>{% endfor %}
"""
)


def _records(table: Table) -> list[Column]:
    return [item if isinstance(item, Column) else Column(item) for item in table.columns]


def _kinds(table: Table) -> Sequence[str]:
    return table.kinds or [""] * len(table.rows)


def _texts(table: Table) -> list[list[str]]:
    return [
        [plain(value, column.of_row(row)) for value, column in zip(row, _records(table))]
        for row in table.rows
    ]


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _cell(value: Any, column: Column) -> tuple[bool, Markup]:
    """Whether a cell is aligned right, and its HTML."""
    if hasattr(value, "__html__"):
        return _numeric(Markup(value).striptags()), Markup(value)
    if isinstance(value, Noted):
        right, shown = _cell(value.value, column)
        return right, shown + Markup(' <span class="small">{}</span>').format(inline(value.remark))
    if value is None:
        return True, Markup('<span class="none">{}</span>').format(column.nothing)
    text = plain(value, column)
    return not isinstance(value, bool) and _numeric(text), inline(text)


def _numeric(text: str) -> bool:
    """Whether a cell is a number with a short text, such as a unit, after it."""
    return bool(_NUMBER.match(text)) and len(re.findall("[A-Za-z]", text)) <= 6
