"""A figure described once and drawn twice: with plotly for the page, with matplotlib for PNG and
SVG.

Colours differ in lightness, and models differ in width and dash, so that figures read in grey and
on paper.
"""

import base64
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.files import replacing

NAVY, VERMILION, AMBER, TEAL, GREY = "#1d3461", "#d1495b", "#e8a33d", "#2e8b7a", "#7a7f87"
AXIS_COLOURS = {"x": NAVY, "y": VERMILION, "z": AMBER}
_VECTORS = 5000  # points of a line in an SVG, beyond which it holds a picture of them
_GAP = 106.0  # px between rows: an axis label, and the title below it
_FONT = 'system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif'
_INK, _RULE = "#24292f", "#e3e6ea"
_PLOTLY_DASH = {"-": "solid", "--": "dash", "-.": "dashdot", ":": "dot", "": "solid"}
_PLOTLY_MARKER = {
    "o": "circle",
    "s": "square",
    "^": "triangle-up",
    "v": "triangle-down",
    "D": "diamond",
    "": "circle",
    "x": "x",
}


@dataclass(frozen=True)
class Line:
    """One curve (x, y); ``dash`` as in matplotlib, "" for markers only; ``marker`` "o", "s", "^",
    "v", "D", "x" or ""; ``labels`` are texts at the points, ``size`` that of a marker (px); about
    ``kept`` points are on the page."""

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
    size: float = 9.0
    kept: int = 500


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
    """Panels in rows of ``columns``; ``name`` is the file name and the id, ``height`` (px) that of
    one row."""

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
    """A ``figure`` of matplotlib where a chart has no such kind: a map, bars. It stands on the page
    as an image."""

    name: str
    figure: Any


def to_html(chart: Chart | Picture) -> str:
    """A ``div`` that draws itself once plotly is on the page, or an image."""
    if isinstance(chart, Picture):
        stream = io.BytesIO()
        chart.figure.savefig(stream, format="png")
        return (
            f'<img id="chart-{chart.name}" alt="{chart.name}" '
            f'src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'
        )
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(
        rows=chart.rows,
        cols=chart.columns,
        subplot_titles=[panel.title for panel in chart.panels],
        horizontal_spacing=0.09 if chart.columns > 1 else 0.0,
        vertical_spacing=_GAP / (chart.height * chart.rows),
    )
    shown: set[str] = set()
    for index, panel in enumerate(chart.panels):
        place = {"row": index // chart.columns + 1, "col": index % chart.columns + 1}
        for line in panel.lines:
            x, y = _thinned(line)
            figure.add_trace(
                go.Scatter(
                    x=x,
                    y=y,
                    name=line.name,
                    legendgroup=line.name,
                    opacity=line.opacity,
                    text=list(line.labels) or None,
                    showlegend=line.legend and line.name not in shown,
                    mode=_mode(line),
                    textposition="top center",
                    line={
                        "color": line.colour,
                        "width": line.width,
                        "dash": _PLOTLY_DASH[line.dash],
                    },
                    marker={"symbol": _PLOTLY_MARKER[line.marker], "size": line.size},
                ),
                **place,
            )
            shown |= {line.name} if line.legend else set()
        x_kind = (
            _log_axis(_across(panel), panel.ticks)
            if panel.log
            else {"type": "log", "dtick": 1}
            if panel.log_x
            else {}
        )
        y_kind = _log_axis(_upwards(panel)) if panel.steep else {}
        figure.update_xaxes(title_text=panel.x_label, **x_kind, **place)
        figure.update_yaxes(title_text=panel.y_label, **y_kind, **place)
        for low, high in panel.spans:
            figure.add_vrect(x0=low, x1=high, fillcolor=GREY, opacity=0.16, line_width=0, **place)
        if panel.band:
            figure.add_hrect(
                y0=_upwards(panel)[0] if panel.steep else 0.0,
                y1=panel.band[0],
                fillcolor=GREY,
                opacity=0.16,
                line_width=0,
                **place,
            )
            figure.add_annotation(
                text=panel.band[1],
                xref="x domain",
                yref="y domain",
                x=0.98,
                y=0.02,
                xanchor="right",
                yanchor="bottom",
                showarrow=False,
                **place,
            )
    figure.update_layout(
        height=chart.height * chart.rows + 90,
        template="plotly_white",
        margin={"l": 62, "r": 18, "t": 40, "b": 60},
        font={"family": _FONT, "size": 13, "color": _INK},
        hovermode="closest",
        legend={
            "orientation": "h",
            "yanchor": "top",
            "y": -90.0 / (chart.height * chart.rows),
            "x": 0.0,
        },
    )
    figure.update_annotations(font={"size": 14})
    figure.update_xaxes(
        title_font={"size": 13},
        showline=True,
        linecolor="#9aa1a9",
        gridcolor=_RULE,
        zerolinecolor="#c9ced4",
        ticks="outside",
    )
    figure.update_yaxes(
        title_font={"size": 13},
        showline=True,
        linecolor="#9aa1a9",
        gridcolor=_RULE,
        zerolinecolor="#c9ced4",
        ticks="outside",
    )
    return figure.to_html(
        full_html=False,
        include_plotlyjs=False,
        div_id=f"chart-{chart.name}",
        config={"displayModeBar": False, "responsive": True},
    )


def to_files(chart: Chart | Picture, folder: Path) -> list[Path]:
    """Draw the same with matplotlib as PNG and SVG files called after the chart; their paths."""
    if isinstance(chart, Picture):
        return save(chart.figure, folder / chart.name)
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
                rasterized=len(line.x) > _VECTORS,
            )
            if line.legend:
                handles.setdefault(line.name, handle)
            for x, y, label in zip(line.x, line.y, line.labels):
                axes.annotate(
                    label,
                    (x, y),
                    textcoords="offset points",
                    xytext=(4, 6),
                    fontsize=7.5,
                    color=_INK,
                )
        _dress(axes, panel)
    if len(handles) > 1:
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=min(len(handles), 4),
            frameon=False,
            fontsize=9,
        )
    return save(figure, folder / chart.name)


def save(figure, stem: Path) -> list[Path]:
    """Write a figure of matplotlib to ``stem``.png and ``stem``.svg, each in one piece and the same
    bytes every time; their paths."""
    import matplotlib

    paths = [stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg")]
    with matplotlib.rc_context({"svg.hashsalt": stem.name}):
        for path in paths:
            with replacing(path) as temporary:
                figure.savefig(
                    temporary,
                    format=path.suffix[1:],
                    metadata={"Date": None} if path.suffix == ".svg" else None,
                )
    return paths


def _dress(axes, panel: Panel) -> None:
    axes.set_title(panel.title, fontsize=10.5, color=_INK)
    axes.set_xlabel(panel.x_label, fontsize=9.5, color=_INK)
    axes.set_ylabel(panel.y_label, fontsize=9.5, color=_INK)
    if panel.log_x:
        axes.set_xscale("log")
    if panel.log:
        axes.set_xscale("log")
        axes.set_xlim(_across(panel))
        axes.xaxis.set_minor_formatter("")
        if panel.ticks:
            axes.set_xticks(panel.ticks, [f"{value:g}" for value in panel.ticks])
    if panel.steep:
        axes.set_yscale("log")
        axes.set_ylim(_upwards(panel))
        axes.yaxis.set_minor_formatter("")
    for low, high in panel.spans:
        axes.axvspan(low, high, color=GREY, alpha=0.16, linewidth=0)
    if panel.band:
        axes.axhspan(
            _upwards(panel)[0] if panel.steep else 0.0,
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
    axes.grid(color=_RULE, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5)


def _log_axis(limits: tuple[float, float], ticks: Sequence[float] = ()) -> dict:
    marks = {"tickvals": list(ticks)} if ticks else {"dtick": 1, "minor_ticks": "outside"}
    return {
        "type": "log",
        "range": [math.log10(value) for value in limits],
        "exponentformat": "power",
        **marks,
    }


def _across(panel: Panel) -> tuple[float, float]:
    """Limits of a logarithmic x, whole decades that hold every point, or the ticks, with some
    air."""
    if panel.ticks:
        return min(panel.ticks) / 1.5, max(panel.ticks) * 1.5
    return _decades([value for line in panel.lines for value in line.x])


def _upwards(panel: Panel) -> tuple[float, float]:
    """The same of y, with the band."""
    return _decades(
        [value for line in panel.lines for value in line.y]
        + ([panel.band[0]] if panel.band else [])
    )


def _decades(values: list[float]) -> tuple[float, float]:
    low, high = min(values, default=1.0) / 1.5, max(values, default=1.0) * 1.5
    return 10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))


def _mode(line: Line) -> str:
    parts = (
        (["lines"] if line.dash else [])
        + (["markers"] if line.marker else [])
        + (["text"] if line.labels else [])
    )
    return "+".join(parts)


def _thinned(line: Line) -> tuple[list, list]:
    """About as many points as are kept, and six digits, which no screen can tell from all of
    them."""
    x, y = np.asarray(line.x, dtype=float), np.asarray(line.y, dtype=float)
    every = max(1, x.size // line.kept)
    keep = np.unique(np.append(np.arange(0, x.size, every), np.arange(x.size)[-1:]))
    return [float(f"{value:.6g}") for value in x[keep]], [
        float(f"{value:.6g}") for value in y[keep]
    ]
