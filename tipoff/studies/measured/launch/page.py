"""Launches on the page and in the terminal: measured rates in the predicted range, and every comparison."""

from collections.abc import Sequence

import numpy as np

from tipoff.studies.measured.results import Comparison, Launch, Measurements
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.palette import AXIS_COLOURS, GREY
from tipoff.studies.render.table import Column, Noted, Table

_CAPTION = (
    "Measured rates in payload body axes over the time from the start, and the predicted range of 95 % of launches, "
    "grey, without noise of the sensor. Dotted: the exit."
)
_ABOUT = (
    "Measured: with the half width that contains the true value with 95 % probability; without one the noise is in "
    "the predictions. Predicted: range of 95 % of {cases:,} launches of {model} with errors of {errors}, errors of "
    "measurement included{lost}. One launch is one draw: a value inside does not prove the model, and of many "
    "values about one in twenty is outside by chance."
)


def figure(found: Measurements) -> Figure:
    """The rates of every launch."""
    panels = [panel for row in found.launches for panel in _panels(row)]
    return Figure(lambda: Chart("measured-launches", panels, columns=3, height=250), _CAPTION)


def _panels(row: Launch) -> list[Panel]:
    time = 1e3 * np.array(row.band.time_s)
    measured, low, high = map(
        np.array, (row.band.rate_deg_s, row.band.low_deg_s, row.band.high_deg_s)
    )
    panels = []
    for place, (axis, colour) in enumerate(AXIS_COLOURS.items()):
        ends = [
            Line(
                time,
                values[:, place],
                name="95 % of launches",
                colour=GREY,
                width=1.2,
                legend=first,
            )
            for values, first in ((low, True), (high, False))
        ]
        lines = [
            *ends,
            Line(time, measured[:, place], name="measured", colour=colour, width=1.4),
            Line(
                [1e3 * row.exit_s] * 2,
                [measured[:, place].min(), measured[:, place].max()],
                name="exit",
                colour=GREY,
                width=1.6,
                dash=":",
            ),
        ]
        title = f"{row.test}{', SIMULATED' if row.simulated else ''}, about {axis.upper()}"
        panels.append(Panel(title, "time from the start (ms)", y_label="rate (deg/s)", lines=lines))
    return panels


def tables(found: Measurements) -> list[Part]:
    """The launches and every comparison."""
    found_ = Table.of_records(
        found.launches,
        ("test", lambda row: Noted(row.test, "SIMULATED") if row.simulated else row.test),
        "start_s",
        "exit_by",
        "exit_s",
        "at_rest_m_s2",
        "gravity_m_s2",
    )
    return [found_, *(_comparisons(found, row) for row in found.launches)]


def _comparisons(found: Measurements, row: Launch) -> Table:
    rows = [_cells(each) for each in found.comparisons if each.test == row.test]
    lost = f"; {row.lost:,} more did not leave the rail" if row.lost else ""
    words = _ABOUT.format(cases=row.cases, model=found.model, errors=found.errors, lost=lost)
    heads: list[Column | str] = [
        row.test,
        "unit",
        "measured",
        "predicted",
        Column("share below", form=".3f"),
        "",
    ]
    return Table(heads, rows, notes=(words,))


def _cells(row: Comparison) -> tuple:
    spread = "" if row.expanded is None else f" ± {row.expanded:.2g}"
    return (
        row.quantity,
        row.unit,
        f"{row.measured:.3g}{spread}",
        f"{row.low:.3g} to {row.high:.3g}",
        row.share_below,
        "inside" if row.inside else "OUTSIDE",
    )


def budgets(launches: Sequence[Launch]) -> Fold:
    """Standard uncertainties of every launch by part."""
    exits = [
        (row.test, name, 1e3 * instant, 1e3 * time, speed)
        for row in launches
        for name, (instant, time, speed) in row.exit_budget.items()
    ]
    units = (("instant in the log", "ms"), ("time from the start", "ms"), ("speed", "m/s"))
    heads: list[Column | str] = [
        "test",
        "end of the rail",
        *(Column(name, unit, ".2g") for name, unit in units),
    ]
    rates = [
        (row.test, name, *part) for row in launches for name, part in row.rate_budget_deg_s.items()
    ]
    axes: list[Column | str] = [
        "test",
        "rates at the exit",
        *(Column(axis, "deg/s", ".2g") for axis in "xyz"),
    ]
    return Fold(
        "Uncertainty of launches: standard uncertainties",
        [Table(heads, exits, dense=True), Table(axes, rates, dense=True)],
    )
