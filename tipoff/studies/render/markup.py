"""HTML of text and tables for the sections that are not yet parts of a document."""

from collections.abc import Iterable, Sequence
from html import escape

from tipoff.studies.render import table as records


class Html(str):
    """Text that is markup already and is not escaped again."""

    def __html__(self) -> str:
        return self


def text(value) -> str:
    """A cell: markup as it is, numbers short, nothing as a dash, all else escaped."""
    return Html(records.inline(value if isinstance(value, str) else records.plain(value)))


def number(value: float | None, digits: int = 3) -> str:
    """``digits`` significant figures, powers of ten written out."""
    return Html(records.inline(records.number(value, f".{digits}g")))


def percent(value: float | None, digits: int = 3) -> str:
    """A fraction as a percentage."""
    return number(None if value is None else 100.0 * value, digits)


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence],
    identity: str = "",
    kinds: Sequence[str] | None = None,
    dense: bool = False,
) -> Html:
    """A table; see ``table.Table``, which replaces it."""
    found = records.Table(heads, list(rows), name=identity, kinds=kinds or (), dense=dense)
    return Html(records.html(found))


def section(identity: str, title: str, *parts: str) -> Html:
    """A section of the page with its anchor."""
    return Html(f'<section id="{identity}"><h2>{escape(title)}</h2>{"".join(parts)}</section>')


def joined(*parts: str) -> Html:
    """Markup one after the other."""
    return Html("".join(parts))


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
