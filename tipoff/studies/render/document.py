"""The report of a study: paragraphs, lists, tables and figures in order, rendered as HTML, as Markdown
and for the terminal."""

import base64
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup

from tipoff.studies.render import chart as charts
from tipoff.studies.render import table as tables
from tipoff.studies.render.chart import Chart, Picture
from tipoff.studies.render.column import of_record
from tipoff.studies.render.table import Table, inline
from tipoff.workspace.attempt import attempt


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
class Missing:
    """A paragraph that states how to make a missing result."""

    text: str


@dataclass(frozen=True)
class KeyFigures:
    """Numbers in large type, each with its meaning."""

    items: Sequence[tuple[str, str]]

    def __bool__(self) -> bool:
        return bool(self.items)


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
    """A chart and its caption. Only what shows the chart calls ``make``: the terminal does not."""

    make: Callable[[], Chart | Picture]
    caption: str

    @property
    def chart(self) -> Chart | Picture:
        """The chart, made now."""
        return self.make()


@dataclass(frozen=True)
class Image:
    """An image file that the page contains; ``text`` replaces it if it cannot be shown. A dark page
    shows ``dark``."""

    path: Path
    text: str
    dark: Path | None = None


@dataclass(frozen=True)
class Fold:
    """Details that the page opens on demand; the terminal leaves them out."""

    title: str
    parts: "Sequence[Part]"


Part = (
    str
    | Heading
    | Caption
    | Notice
    | Missing
    | KeyFigures
    | Bullets
    | Table
    | Figure
    | Image
    | Fold
)
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
        case Missing():
            return Markup('<div class="absent">{}</div>').format(inline(part.text))
        case KeyFigures():
            boxes = (
                Markup("<div><b>{}</b><span>{}</span></div>").format(*map(inline, item))
                for item in part.items
            )
            return Markup('<div class="figures">{}</div>').format(Markup("").join(boxes))
        case Image():
            return _image(part)
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


def _image(image: Image) -> Markup:
    """The image with its content, and its ``dark`` one for screens with a dark scheme."""
    shown = Markup('<img alt="{}" src="{}">').format(image.text, _data(image.path))
    if image.dark is not None:
        shown = Markup(
            '<picture><source media="screen and (prefers-color-scheme: dark)" srcset="{}">{}</picture>'
        ).format(_data(image.dark), shown)
    return Markup("<p>{}</p>").format(shown)


def _data(path: Path) -> str:
    """The data address with the content of an image file."""
    return f"data:{_MIME[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode()}"


def tables_of(found: Any) -> list[Part]:
    """A table of each tuple of records that declare columns, in the result ``found`` of a stage."""
    values = (getattr(found, field.name) for field in fields(found))
    groups = (value for value in values if isinstance(value, tuple) and value)
    return [
        Table.of_records(group)
        for group in groups
        if is_dataclass(group[0]) and of_record(type(group[0]))
    ]


_Result = TypeVar("_Result")


def with_figures(
    found: _Result, figures: Callable[[_Result], Iterable[Figure]], folder: Path
) -> tuple[_Result, list[Path]]:
    """The result ``found`` of a stage, and the PNG and SVG files of its ``figures`` in ``folder``.
    If they cannot be drawn, ``failed`` of the result has the reason, and the results of long runs
    are kept."""

    def drawn() -> list[Path]:
        return [path for item in figures(found) for path in charts.to_files(item.chart, folder)]

    paths, reason = attempt("drawing the figures", drawn)
    if paths is None:
        line = f"figures: {reason}"
        if isinstance(found, dict):
            return found | {"failed": [*found.get("failed", ()), line]}, []  # type: ignore[return-value]
        return replace(found, failed=(*found.failed, line)), []  # type: ignore[type-var, attr-defined]
    return found, paths


def markdown(parts: Sequence[Part]) -> str:
    """The parts as Markdown, without figures and images."""
    return "\n\n".join(_markdown(part) for part in parts if part and not isinstance(part, _DRAWN))


def _markdown(part: Part) -> str:
    match part:
        case Table():
            return tables.markdown(part)
        case Bullets():
            return "\n".join(f"- {line}" for line in part.sentences())
        case Heading():
            return f"### {part.text}"
        case Fold():
            return markdown([part.title, *part.parts])
        case _:
            return _text(part)


def terminal(parts: Sequence[Part]) -> str:
    """The parts for the terminal, without figures, images and folds."""
    shown = (part for part in parts if part and not isinstance(part, (*_DRAWN, Fold)))
    return "\n".join(_terminal(part) for part in shown)


def _terminal(part: Part) -> str:
    match part:
        case Table():
            return tables.terminal(part)
        case Bullets():
            return "\n".join(part.lines)
        case Heading():
            return f"\n{part.text}"
        case _:
            return _text(part)


def _text(part: Part) -> str:
    match part:
        case str():
            return part
        case KeyFigures():
            width = max(len(value) for value, _ in part.items)
            return "\n".join(f"  {value:<{width}}  {meaning}" for value, meaning in part.items)
        case Heading() | Caption() | Notice() | Missing():
            return part.text
        case _:
            raise TypeError(f"{type(part).__name__} has no text")


_DRAWN = (Figure, Image)
_MIME = {".png": "image/png", ".webp": "image/webp"}
