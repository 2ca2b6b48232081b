"""Growth of a 1 um disturbance on the page: separation of each model from its disturbed twins, and
the time up to which curves can be compared."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.studies.agreement import stage
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.render.chart import Chart, Line, Panel, marks
from tipoff.studies.render.document import Bullets, Figure, Part
from tipoff.studies.render.palette import NAVY, VERMILION
from tipoff.studies.render.table import Column, Table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_SEPARATION = (
    "Largest difference of the body rates between a run and its twins with ±1 µm of clearance, "
    "from the first contact on. Grey: below the limit of agreement of the settled rates. "
    "Marker: the horizon, after which the difference stays above this limit."
)
_NOTES = (
    "The reference on the coarse mesh, for the conditions of the floor and for all conditions "
    "whose reference is not converged.",
    "Sensitive: 1 µm changes a settled rate by more than the limit of agreement ({gate:g} "
    "deg/s). Chaotic: sensitive, and the factor is above the number of contacts. Without "
    "growth, the factor equals the number of contacts.",
)
_SHOWN = 1e-4  # of the gate; smaller differences do not affect a comparison
_LOOKS = ((NAVY, 5.0, "-", 0.35), (VERMILION, 1.5, "-", 1.0))
_MARKERS = "Do"


def draw(page: "Page") -> list[Part]:
    """The section; empty if no pad touches a rail."""
    found = page.result(stage.STAGE)
    if found is None or not found.growth:
        return []
    return [Figure(lambda: picture(found.growth), _SEPARATION), *tables(found.growth)]


def picture(found: Sequence[Growth]) -> Chart:
    """Separation over time, one panel a condition, logarithmic."""
    panels = []
    for condition in dict.fromkeys(item.condition for item in found):
        own = [item for item in found if item.condition == condition]
        lines = [
            line
            for item, look, marker in zip(own, _LOOKS, _MARKERS)
            for line in _lines(item, look, marker)
        ]
        if lines:
            band = own[0].gate_deg_s, "below the limit of agreement"
            axes = "time after ignition (ms)", "separation (deg/s)"
            panels.append(Panel(condition, *axes, lines, band=band, log_y=True))
    return Chart("growth", panels, columns=min(3, max(1, len(panels))), height=270)


def _lines(item: Growth, look: tuple[str, float, str, float], marker: str) -> list[Line]:
    """The curve of one model and its horizon; nothing if the twins do not separate."""
    points = [
        (1e3 * time, apart)
        for time, apart in zip(item.time_s, item.separation_deg_s)
        if apart > _SHOWN * item.gate_deg_s
    ]
    if not points:
        return []
    times, separations = zip(*points)
    curve = Line(times, separations, item.model, *look)
    if item.horizon_s is None:
        return [curve]
    name = f"horizon, {item.model}"
    return [curve, marks([1e3 * item.horizon_s], [item.gate_deg_s], name, look[0], marker)]


def tables(found: Sequence[Growth]) -> list[Part]:
    """The time up to which curves can be compared, and the growth over the contacts."""
    columns = (
        *("condition", "model"),
        ("contacts", lambda item: len(item.contacts)),
        (
            Column("difference after each", "deg/s", ".2g"),
            lambda item: [contact.separation_deg_s for contact in item.contacts] or None,
        ),
        *("factor", "exponent_per_s", "settled_growth_deg_s_um"),
        ("horizon (ms)", _horizon),
        ("verdict", lambda item: item.verdict),
    )
    kinds = ["good" if item.sensitive is False else "doubt" for item in found]
    notes = tuple(note.format(gate=found[0].gate_deg_s) for note in _NOTES)
    own = [item for item in found if item.model == FINITE_ELEMENTS]
    return [
        Bullets(_sentences(own)),
        Table.of_records(found, *columns, notes=notes, name="growth", kinds=kinds, dense=True),
    ]


def _sentences(found: Sequence[Growth]) -> list[str]:
    """One line on all stable conditions, and one on each other condition."""
    stable = [item.condition for item in found if item.sensitive is False]
    others = [f"condition {sentence(item)}" for item in found if item.sensitive is not False]
    if not stable:
        return others
    return [f"stable, so that curves can be compared to the end: {', '.join(stable)}", *others]


def sentence(item: Growth) -> str:
    """The time up to which curves of one condition can be compared."""
    horizon = f"{1e3 * item.end_s:.1f}" if item.horizon_s is None else _horizon(item)
    return f"{item.condition}: {item.verdict}; curves can be compared up to {horizon} ms"


def _horizon(item: Growth) -> str:
    if item.horizon_s is None:
        return "none"
    return f"{1e3 * item.horizon_s:.1f} of {1e3 * item.end_s:.1f}"
