"""A figure of lines, drawn by matplotlib as PNG and SVG; the page contains the SVG.

Colours differ in lightness, and models differ in width and dash, so that figures read in grey and
on paper.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.files import replacing
from tipoff.studies.render.palette import GREY, INK, NAVY, RULE
from tipoff.workspace import machine

_OFFSETS = {  # points
    "top center": (4, 6),
    "top right": (7, 3),
    "bottom right": (7, -9),
    "bottom left": (-7, -9),
}
_MARKERS = 20000  # largest number in a line of an SVG; longer lines become a bitmap


@dataclass(frozen=True)
class Line:
    """One curve (x, y); ``dash`` as in matplotlib, "" for markers only; ``marker`` "o", "s", "^",
    "v", "D", "x", "P" or ""; ``labels`` are texts at the points, ``size`` that of a marker (px)."""

    x: Sequence[float] | np.ndarray
    y: Sequence[float] | np.ndarray
    name: str
    colour: str = NAVY
    width: float = 1.6
    dash: str = "-"
    opacity: float = 1.0
    marker: str = ""
    legend: bool = True
    labels: tuple[str, ...] = ()
    beside: str = "top center"  # where a label stands, of ``_OFFSETS``
    size: float = 9.0


def marks(
    x: Sequence[float] | np.ndarray,
    y: Sequence[float] | np.ndarray,
    name: str,
    colour: str = "#000000",
    marker: str = "o",
    **others: Any,
) -> Line:
    """Markers without a line between them; ``others`` are further fields of a ``Line``."""
    return Line(x, y, name, colour, dash="", marker=marker, **others)


@dataclass(frozen=True)
class Panel:
    """One set of axes, both logarithmic, or x or y alone; ``band`` shades y below a value, with a
    text, ``spans`` stretches of x; ``ticks`` are labelled on a logarithmic x in place of whole
    decades."""

    title: str
    x_label: str
    y_label: str
    lines: list[Line]
    log: bool = False
    band: tuple[float, str] | None = None
    spans: tuple[tuple[float, float], ...] = ()
    log_x: bool = False
    log_y: bool = False
    ticks: tuple[float, ...] = ()

    @property
    def steep(self) -> bool:
        """Whether y is logarithmic."""
        return self.log or self.log_y


@dataclass(frozen=True)
class Chart:
    """Panels in rows of ``columns``; ``name`` is the file name and the id; ``height`` (px) of one
    row."""

    name: str
    panels: list[Panel] = field(default_factory=list)
    columns: int = 1
    height: int = 300

    @property
    def rows(self) -> int:
        """Rows of panels."""
        return -(-len(self.panels) // self.columns)


@dataclass(frozen=True)
class Picture:
    """A ``figure`` of matplotlib that is not a chart of lines: a map, bars."""

    name: str
    figure: Any


def to_files(chart: Chart | Picture, folder: Path, made: dict | None = None) -> list[Path]:
    """Draw a chart as a PNG and an SVG file with its name; returns their paths. The state in which
    its numbers were ``made`` (``machine.state``; default: the present one) stands below it."""
    if isinstance(chart, Picture):
        return save(chart.figure, folder / chart.name, made)
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(
        figsize=(
            4.1 * chart.columns + 1.4 if chart.columns > 1 else 8.0,
            chart.height / 96.0 * chart.rows + 0.9,
        ),
        dpi=130,
        layout="constrained",
    )
    handles: dict[str, Line2D] = {}
    for index, panel in enumerate(chart.panels):
        axes = figure.add_subplot(chart.rows, chart.columns, index + 1)
        for line in panel.lines:
            (handle,) = axes.plot(
                line.x,
                line.y,
                color=line.colour,
                linewidth=0.75 * line.width,
                linestyle=line.dash or "none",
                alpha=line.opacity,
                marker=line.marker or None,
                markersize=line.size * 2.0 / 3.0,
                rasterized=bool(line.marker) and len(line.x) > _MARKERS,
            )
            if line.legend:
                handles.setdefault(line.name, handle)
            for x, y, label in zip(line.x, line.y, line.labels):
                axes.annotate(
                    label,
                    (x, y),
                    textcoords="offset points",
                    xytext=_OFFSETS[line.beside],
                    horizontalalignment="right" if _OFFSETS[line.beside][0] < 0 else "left",
                    fontsize=7.5,
                    color=INK,
                )
        _dress(axes, panel)
        if chart.columns > 1 and axes.get_xscale() == "linear":
            axes.locator_params(axis="x", nbins=5)  # otherwise long numbers would touch
    if len(handles) > 1:
        widest = 5.2 * max(map(len, handles)) + 45.0  # points, with the line sample before the text
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=max(min(len(handles), 4, int(72.0 * figure.get_figwidth() / widest)), 1),
            frameon=False,
            fontsize=9,
        )
    return save(figure, folder / chart.name, made)


def save(figure, stem: Path, made: dict | None) -> list[Path]:
    """Write a figure of matplotlib to ``stem``.png and ``stem``.svg, atomically and with the same
    bytes every time in one state; returns their paths."""
    import matplotlib

    said = machine.stated(machine.state() if made is None else made)
    if figure.legends:  # which is at the place of the label
        figure.legends[0].set_title(said, prop={"size": 6.5})
        figure.legends[0].get_title().set_color(GREY)
    else:
        figure.supxlabel(said, x=0.995, horizontalalignment="right", fontsize=6.5, color=GREY)

    paths = [stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg")]
    with matplotlib.rc_context({"svg.hashsalt": stem.name, "svg.fonttype": "none"}):
        for path in paths:
            with replacing(path) as temporary:
                figure.savefig(
                    temporary,
                    format=path.suffix[1:],
                    metadata={"Date": None} if path.suffix == ".svg" else None,
                )
    return paths


def _dress(axes, panel: Panel) -> None:
    axes.set_title(panel.title, fontsize=10.5, color=INK)
    axes.set_xlabel(panel.x_label, fontsize=9.5, color=INK)
    axes.set_ylabel(panel.y_label, fontsize=9.5, color=INK)
    if panel.log_x:
        axes.set_xscale("log")
    if panel.log:
        axes.set_xscale("log")
        axes.set_xlim(across(panel))
        axes.xaxis.set_minor_formatter("")
        if panel.ticks:
            axes.set_xticks(panel.ticks, [f"{value:g}" for value in panel.ticks])
    if panel.steep:
        axes.set_yscale("log")
        axes.set_ylim(upwards(panel))
        axes.yaxis.set_minor_formatter("")
    for low, high in panel.spans:
        axes.axvspan(low, high, color=GREY, alpha=0.16, linewidth=0)
    if panel.band:
        axes.axhspan(
            upwards(panel)[0] if panel.steep else 0.0,
            panel.band[0],
            color=GREY,
            alpha=0.16,
            linewidth=0,
        )
        axes.annotate(
            panel.band[1],
            (0.98, 0.02),
            xycoords="axes fraction",
            ha="right",
            va="bottom",
            fontsize=8,
        )
    axes.grid(color=RULE, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5)


def across(panel: Panel) -> tuple[float, float]:
    """Limits of a logarithmic x: whole decades around all points, or the ticks, with a margin."""
    if panel.ticks:
        return min(panel.ticks) / 1.5, max(panel.ticks) * 1.5
    return _decades([value for line in panel.lines for value in line.x])


def upwards(panel: Panel) -> tuple[float, float]:
    """Limits of a logarithmic y: whole decades around all points and the band."""
    return _decades(
        [value for line in panel.lines for value in line.y]
        + ([panel.band[0]] if panel.band else [])
    )


def _decades(values: list[float]) -> tuple[float, float]:
    shown = [value for value in values if value > 0.0]  # zero has no logarithm
    low, high = min(shown, default=1.0) / 1.5, max(shown, default=1.0) * 1.5
    return 10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))
