"""What a study reports: paragraphs, lists, tables and figures in order, rendered as HTML, as
Markdown and for the terminal."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from tipoff.studies.render import table as tables
from tipoff.studies.render.chart import Chart, Picture
from tipoff.studies.render.table import Table, inline


@dataclass(frozen=True)
class Heading:
    """A heading below that of the section."""

    text: str


@dataclass(frozen=True)
class Caption:
    """A paragraph in small type."""

    text: str


@dataclass(frozen=True)
class Notice:
    """A paragraph that warns the reader."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of sentences; each gets its capital and its full stop here."""

    lines: Sequence[str]

    def __bool__(self) -> bool:
        return bool(self.lines)

    def sentences(self) -> list[str]:
        """The lines as they are shown."""
        return [f"{line[0].upper()}{line[1:].rstrip('.')}." for line in self.lines]


@dataclass(frozen=True)
class Figure:
    """A chart, and what it shows."""

    chart: Chart | Picture
    caption: str


@dataclass(frozen=True)
class Fold:
    """Detail that the page opens on demand; the terminal leaves it out."""

    title: str
    parts: "Sequence[Part]"


Part = str | Heading | Caption | Notice | Bullets | Table | Figure | Fold
"""A string is a paragraph."""


def html(parts: Sequence[Part], figure: Callable[[Chart | Picture, str], str]) -> Markup:
    """The parts as HTML; ``figure`` renders a chart with its caption as HTML. An empty string
    or list renders as nothing."""
    return Markup("").join(_html(part, figure) for part in parts if part)


def _html(part: Part, figure: Callable[[Chart | Picture, str], str]) -> Markup:
    match part:
        case Table():
            return tables.html(part)
        case Figure():
            return Markup(figure(part.chart, part.caption))
        case Heading():
            return Markup("<h3>{}</h3>").format(inline(part.text))
        case Caption():
            return Markup('<p class="caption">{}</p>').format(inline(part.text))
        case Notice():
            return Markup('<div class="notice">{}</div>').format(inline(part.text))
        case Bullets():
            lines = map(inline, part.sentences())
            return Markup("<ul>{}</ul>").format(
                Markup("").join(Markup("<li>{}</li>").format(line) for line in lines)
            )
        case Fold():
            return Markup("<details><summary>{}</summary>{}</details>").format(
                inline(part.title), html(part.parts, figure)
            )
        case str() if hasattr(part, "__html__"):
            return Markup(part)
        case str():
            return Markup("<p>{}</p>").format(inline(part))


def markdown(parts: Sequence[Part]) -> str:
    """The parts as Markdown, without figures."""
    shown = [
        tables.markdown(part)
        if isinstance(part, Table)
        else "\n".join(f"- {line}" for line in part.sentences())
        if isinstance(part, Bullets)
        else f"### {part.text}"
        if isinstance(part, Heading)
        else markdown([part.title, *part.parts])
        if isinstance(part, Fold)
        else part
        if isinstance(part, str)
        else part.text
        for part in parts
        if part and not isinstance(part, Figure)
    ]
    return "\n\n".join(shown)


def terminal(parts: Sequence[Part]) -> str:
    """The parts for the terminal, without figures and folds."""
    shown = [
        tables.terminal(part)
        if isinstance(part, Table)
        else "\n".join(part.lines)
        if isinstance(part, Bullets)
        else part
        if isinstance(part, str)
        else part.text
        for part in parts
        if part and not isinstance(part, (Figure, Fold))
    ]
    return "\n".join(shown)
