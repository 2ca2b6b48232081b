"""The little HTML the report needs: escaped text, tables with units in their heads, numbers of a
sensible length."""

import re
from collections.abc import Iterable, Sequence
from html import escape


class Html(str):
    """Text that is markup already and is not escaped again."""


def text(value) -> str:
    """A cell: markup as it is, numbers short, nothing as a dash, all else escaped."""
    if isinstance(value, Html):
        return value
    if value is None:
        return '<span class="none">–</span>'
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value)
    return escape(str(value))


def number(value: float | None, digits: int = 3) -> str:
    """``digits`` significant figures, powers of ten written out."""
    if value is None:
        return "–"
    shown = f"{value:.{digits}g}"
    if "e" in shown:
        mantissa, exponent = shown.split("e")
        return Html(f"{mantissa}·10<sup>{int(exponent)}</sup>")
    return shown


def percent(value: float | None, digits: int = 3) -> str:
    """A fraction as a percentage."""
    return "–" if value is None else number(100.0 * value, digits)


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence],
    identity: str = "",
    kinds: Sequence[str] | None = None,
    dense: bool = False,
) -> Html:
    """A table; ``kinds`` names a class per row ("good", "bad", "doubt" or ""). Columns after the
    first are right-aligned where they hold numbers."""
    body = []
    for index, row in enumerate(rows):
        cells = "".join(f"<td{_side(cell)}>{text(cell)}</td>" for cell in row)
        kind = kinds[index] if kinds else ""
        body.append(f'<tr class="{kind}">{cells}</tr>' if kind else f"<tr>{cells}</tr>")
    head = "".join(
        f"<th>{label if isinstance(label, Html) else escape(label)}</th>" for label in heads
    )
    name = f' id="{identity}"' if identity else ""
    look = ' class="dense"' if dense else ""
    return Html(
        f'<div class="wide"><table{name}{look}><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(body)}</tbody></table></div>"
    )


def _side(cell) -> str:
    """Right-aligned where a cell is a number with little text, such as a unit, behind it."""
    plain = re.sub(r"<[^>]*>", "", str(cell))
    numeric = (
        isinstance(cell, str)
        and plain[:1] in "+-0123456789–"
        and len(re.findall("[A-Za-z]", plain)) <= 6
    )
    return (
        ' class="number"'
        if numeric or (isinstance(cell, (int, float)) and not isinstance(cell, bool))
        else ""
    )


def section(identity: str, title: str, *parts: str) -> Html:
    """A section of the page with its anchor."""
    return Html(f'<section id="{identity}"><h2>{escape(title)}</h2>{"".join(parts)}</section>')


def paragraph(*parts: str) -> Html:
    """A paragraph; plain strings are escaped."""
    return Html("<p>" + "".join(text(part) for part in parts) + "</p>")


def caption(words: str) -> Html:
    """What a figure shows and how to read it."""
    return Html(f'<p class="caption">{escape(words)}</p>')


def fold(summary: str, *parts: str) -> Html:
    """Detail that opens on demand, and is open in print."""
    return Html(f"<details><summary>{escape(summary)}</summary>{''.join(parts)}</details>")


def code(words: str) -> Html:
    """A command or a key."""
    return Html(f"<code>{escape(words)}</code>")
