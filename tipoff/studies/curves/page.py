"""Curves of other codes on the page and in the terminal."""

from typing import TYPE_CHECKING

from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Table

if TYPE_CHECKING:
    from tipoff.studies.curves.stage import Compared, Drawn

# The reference is a broad pale line under the thin lines of the others.
_REFERENCE = {"colour": NAVY, "width": 5.0, "opacity": 0.35}
_LOOKS = ((VERMILION, "-"), (AMBER, "--"), (TEAL, "-."), (GREY, ":"))
_TIME = "time after ignition (ms)"
_NOTE = (
    "Differences from {reference}, from ignition to the end of its settled window, at the same times. L2 "
    "and magnitude are relative to it. ISO 18571: 1 is equal, above 0.94 excellent, below 0.58 poor. "
    "Settled rates are means over 2 ms."
)
_CAPTION = "Curves over the time after ignition. {reference} is the broad line."


def draw(found: "Compared") -> list[Part]:
    """Figure and tables."""
    (figure,) = figures(found)
    sources = [(item.curve, item.source) for item in found.drawn]
    return [figure, *_tables(found), Fold("Files", [Table(("curve", "source"), sources)])]


def terminal(found: "Compared") -> list[Part]:
    """The tables."""
    condition = f" Condition {found.condition} of {found.scene}." if found.condition else ""
    return [f"{len(found.rows)} curves against {found.reference}.{condition}", *_tables(found)]


def _tables(found: "Compared") -> list[Part]:
    note = _NOTE.format(reference=found.reference)
    return [
        Table.of_records(found.rows, notes=(note,)),
        Table.of_records(found.ratings, title="ISO 18571 of each channel:"),
    ]


def figures(found: "Compared") -> tuple[Figure]:
    """v_x and the three rates of all curves."""
    panels = [
        Panel(
            f"rate about {axis.upper()}",
            _TIME,
            y_label="rate (deg/s)",
            lines=[
                _line(place, item, [rate[index] for rate in item.rate_deg_s])
                for place, item in enumerate(found.drawn)
            ],
        )
        for index, axis in enumerate("xyz")
    ]
    speeds = [
        _line(place, item, list(item.velocity_m_s))
        for place, item in enumerate(found.drawn)
        if item.velocity_m_s is not None
    ]
    if speeds:
        panels.insert(0, Panel("velocity along X", _TIME, y_label="v_x (m/s)", lines=speeds))
    caption = _CAPTION.format(reference=found.reference)
    return (Figure(Chart("curves", panels, columns=2, height=260), caption),)


def _line(place: int, item: "Drawn", values: list[float]) -> Line:
    time = [1e3 * instant for instant in item.time_s]
    if place == 0:
        return Line(time, values, name=item.curve, **_REFERENCE)  # type: ignore[arg-type]
    colour, dash = _LOOKS[(place - 1) % len(_LOOKS)]
    return Line(time, values, name=item.curve, colour=colour, dash=dash)
