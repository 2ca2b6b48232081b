"""Curves of other codes."""

from collections.abc import Iterable, Sequence

from tipoff.studies.curves.results import Compared, Drawn
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Table
from tipoff.units import duration
from tipoff.workspace.words import counted

_LOOKS = ((VERMILION, "-"), (AMBER, "--"), (TEAL, "-."), (GREY, ":"))
_TIME = "time after ignition (ms)"
_NOTE = (
    "Differences from {reference}, from ignition to the end of its settled window, at the same times. L2 "
    "and magnitude are relative to it. ISO 18571: 1 is equal, above 0.94 excellent, below 0.58 poor. "
    "Settled rates are means over 2 ms."
)
_APART = 0.01  # s
_APART_NOTE = (
    "The settled windows begin at different times. If the thrust goes on after the exit, their rates "
    'differ for this reason: --settled-from "{first}" takes one window of all.'
)
_CAPTION = "Curves over the time after ignition. {reference} is the broad line."


def draw(found: Compared) -> list[Part]:
    """Figure and tables."""
    condition = f" Condition {found.condition} of {found.scene}." if found.condition else ""
    notes = [_NOTE.format(reference=found.reference)]
    starts = [row.settled_from_s for row in found.rows]
    if max(starts) - min(starts) > _APART:
        notes.append(_APART_NOTE.format(first=duration(min(starts), 4)))
    sources = [(name, item.source) for name, item in found.drawn.items()]
    return [
        f"{counted(len(found.rows) - 1, 'curve')} against {found.reference}.{condition}",
        *figures(found),
        Table.of_records(found.rows, notes=tuple(notes)),
        Table.of_records(found.ratings, title="ISO 18571 of each channel:"),
        Fold("Files", [Table(("curve", "source"), sources)]),
    ]


def figures(found: Compared) -> tuple[Figure]:
    """v_x and the three rates of all curves."""
    rates = {
        f"rate about {axis.upper()}": [
            (name, item, [rate[index] for rate in item.rate_deg_s])
            for name, item in found.drawn.items()
        ]
        for index, axis in enumerate("xyz")
    }
    speeds = [
        (name, item, item.velocity_m_s)
        for name, item in found.drawn.items()
        if item.velocity_m_s is not None
    ]
    panels = (
        [Panel("velocity along X", _TIME, "v_x (m/s)", _lines(found, speeds))] if speeds else []
    )
    panels += [
        Panel(title, _TIME, "rate (deg/s)", _lines(found, own)) for title, own in rates.items()
    ]
    caption = _CAPTION.format(reference=found.reference)
    return (Figure(lambda: Chart("curves", panels, columns=2, height=260), caption),)


def _lines(found: Compared, curves: Iterable[tuple[str, Drawn, Sequence[float]]]) -> list[Line]:
    """The lines of some curves; each curve has one look in all panels."""
    others = [name for name in found.drawn if name != found.reference]
    lines = []
    for name, item, values in curves:
        time = [1e3 * instant for instant in item.time_s]
        if name == found.reference:  # a broad pale line under the thin lines of the others
            lines.append(Line(time, values, name=name, colour=NAVY, width=5.0, opacity=0.35))
        else:
            colour, dash = _LOOKS[others.index(name) % len(_LOOKS)]
            lines.append(Line(time, values, name=name, colour=colour, dash=dash))
    return lines
