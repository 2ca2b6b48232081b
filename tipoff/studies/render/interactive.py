"""A figure as part of the page: drawn by plotly, in colours that the style of the page can change."""

import io
import math
from collections.abc import Sequence

import numpy as np

from tipoff.studies.render.chart import Chart, Line, Panel, Picture, across, upwards
from tipoff.studies.render.palette import EDGE, GREY, INK, RULE, ZERO, themed

_GAP = 106.0  # px between rows: an axis label, and the title below it
_FONT = 'system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif'
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
_AXIS = {
    "title_font": {"size": 13},
    "showline": True,
    "linecolor": EDGE,
    "gridcolor": RULE,
    "zerolinecolor": ZERO,
    "ticks": "outside",
}


def to_html(chart: Chart | Picture) -> str:
    """A ``div`` that draws itself once plotly is on the page, or an SVG."""
    if isinstance(chart, Picture):
        stream = io.StringIO()
        chart.figure.savefig(stream, format="svg")
        return themed(stream.getvalue(), f"chart-{chart.name}")
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(
        rows=chart.rows,
        cols=chart.columns,
        subplot_titles=[panel.title for panel in chart.panels],
        horizontal_spacing=0.09 if chart.columns > 1 else 0.0,
        vertical_spacing=_GAP / (chart.height * chart.rows),
    )
    named: set[str] = set()  # lines that the legend has
    for index, panel in enumerate(chart.panels):
        place = {"row": index // chart.columns + 1, "col": index % chart.columns + 1}
        for line in panel.lines:
            shown = line.legend and line.name not in named
            figure.add_trace(go.Scatter(**_trace(line), showlegend=shown), **place)
            named |= {line.name} if line.legend else set()
        figure.update_xaxes(title_text=panel.x_label, **_x_axis(panel), **place)
        figure.update_yaxes(title_text=panel.y_label, **_y_axis(panel), **place)
        _shade(figure, panel, place)
    figure.update_layout(**_layout(chart.height * chart.rows))
    figure.update_annotations(font={"size": 14})
    figure.update_xaxes(**_AXIS)
    figure.update_yaxes(**_AXIS)
    return figure.to_html(
        full_html=False,
        include_plotlyjs=False,
        div_id=f"chart-{chart.name}",
        config={"displayModeBar": False, "responsive": True},
    )


def _trace(line: Line) -> dict:
    x, y = _thinned(line)
    return {
        "x": x,
        "y": y,
        "name": line.name,
        "legendgroup": line.name,
        "opacity": line.opacity,
        "text": list(line.labels) or None,
        "mode": _mode(line),
        "textposition": line.beside,
        "cliponaxis": not line.labels,
        "line": {"color": line.colour, "width": line.width, "dash": _PLOTLY_DASH[line.dash]},
        "marker": {"symbol": _PLOTLY_MARKER[line.marker], "size": line.size},
    }


def _shade(figure, panel: Panel, place: dict) -> None:
    """Spans of x, and the band at the foot of the panel with its words."""
    grey = {"fillcolor": GREY, "opacity": 0.16, "line_width": 0}
    for low, high in panel.spans:
        figure.add_vrect(x0=low, x1=high, **grey, **place)
    if not panel.band:
        return
    top, words = panel.band
    figure.add_hrect(y0=upwards(panel)[0] if panel.steep else 0.0, y1=top, **grey, **place)
    figure.add_annotation(
        text=words,
        xref="x domain",
        yref="y domain",
        x=0.98,
        y=0.02,
        xanchor="right",
        yanchor="bottom",
        showarrow=False,
        **place,
    )


def _layout(height: float) -> dict:
    """Of a chart whose panels are ``height`` px high together."""
    return {
        "height": height + 90,
        "template": "plotly_white",
        "margin": {"l": 62, "r": 18, "t": 40, "b": 60},
        "font": {"family": _FONT, "size": 13, "color": INK},
        "hovermode": "closest",
        "legend": {"orientation": "h", "yanchor": "top", "y": -90.0 / height, "x": 0.0},
    }


def _x_axis(panel: Panel) -> dict:
    if panel.log:
        return _log_axis(across(panel), panel.ticks)
    return {"type": "log", "dtick": _tick_step(panel)} if panel.log_x else {}


def _y_axis(panel: Panel) -> dict:
    return _log_axis(upwards(panel)) if panel.steep else {}


def _tick_step(panel: Panel) -> int | str:
    """Ticks at decades; at 1, 2 and 5 where x spans less than two of them."""
    low, high = across(panel)
    return "D2" if high < 150.0 * low else 1


def _log_axis(limits: tuple[float, float], ticks: Sequence[float] = ()) -> dict:
    marks = {"tickvals": list(ticks)} if ticks else {"dtick": 1, "minor_ticks": "outside"}
    return {
        "type": "log",
        "range": [math.log10(value) for value in limits],
        "exponentformat": "power",
        **marks,
    }


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
