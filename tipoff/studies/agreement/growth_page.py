"""How 1 um grows on the page: separation of each model from its disturbed twins, and what follows
for comparing curves."""

from html import escape
from typing import TYPE_CHECKING

from tipoff.mechanics.models import FINITE_ELEMENTS
from tipoff.studies.render.chart import NAVY, VERMILION, Chart, Line, Panel
from tipoff.studies.render.markup import Html, caption, number, section, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

WORDS = (
    "Largest separation of the body rates from those of twins whose clearance differs by ±1 µm. "
    "Grey: below the gate of the "
    "settled rates. Marks: the horizon, where it passes the gate for good; peaks that a contact "
    "takes back are contacts that "
    "come a little earlier or later. A curve begins where the twins first touch."
)
_LEGEND = (
    "Reference on the coarse mesh, as for the floor. Sensitive: 1 µm moves a settled rate by more "
    "than the gate "
    "({gate:g} deg/s). Chaotic: so it does, and by growth from contact to contact: the factor is "
    "above their number, which "
    "is what a wall 1 µm elsewhere brings at every contact without growth. Conditions are those of "
    "the floor "
    "and all whose reference is not converged."
)
_SHOWN = 1e-4  # of the gate; nothing below matters to a comparison
_LOOKS = ((NAVY, 5.0, "-", 0.35), (VERMILION, 1.5, "-", 1.0))
_MARKERS = "Do"


def draw(page: "Page") -> Html:
    """The section, where anything touches; agreement reminds of its own stage."""
    found = (page.documents.get("agreement") or {}).get("growth")
    if not found:
        return Html("")
    return section(
        "growth-section", "How 1 µm grows", page.figure(picture(found), WORDS), tables(found)
    )


def picture(found: list[dict]) -> Chart:
    """Separation over time, one panel a condition, logarithmic; ``found`` is that part of
    agreement.json."""
    panels = []
    for condition in dict.fromkeys(item["condition"] for item in found):
        own = [item for item in found if item["condition"] == condition]
        lines = [
            line
            for item, look, marker in zip(own, _LOOKS, _MARKERS)
            for line in _lines(item, look, marker)
        ]
        if lines:
            panels.append(
                Panel(
                    condition,
                    "time after ignition (ms)",
                    "separation (deg/s)",
                    lines,
                    band=(own[0]["gate_deg_s"], "below the gate"),
                    log_y=True,
                )
            )
    return Chart("growth", panels, columns=min(3, max(1, len(panels))), height=270)


def _lines(item: dict, look: tuple[str, float, str, float], marker: str) -> list[Line]:
    """The curve of one model and its horizon; nothing where twins do not part."""
    known = [
        (1e3 * time, apart)
        for time, apart in zip(item["time_s"], item["separation_deg_s"])
        if apart > _SHOWN * item["gate_deg_s"]
    ]
    if not known:
        return []
    times, separations = zip(*known)
    curve = Line(times, separations, item["model"], *look)
    if item["horizon_s"] is None:
        return [curve]
    return [
        curve,
        Line(
            [1e3 * item["horizon_s"]],
            [item["gate_deg_s"]],
            f"horizon, {item['model']}",
            look[0],
            1.0,
            "",
            marker=marker,
        ),
    ]


def tables(found: list[dict]) -> Html:
    """In words up to when a curve comparison means anything, then growth from contact to
    contact."""
    heads = (
        "condition",
        "model",
        "contacts",
        "separation after each (deg/s)",
        "factor, first to last",
        "exponent (1/s)",
        "settled (deg/s per µm)",
        "horizon (ms)",
        "verdict",
    )
    rows = [
        (
            item["condition"],
            item["model"],
            len(item["contacts"]),
            "; ".join(f"{contact['separation_deg_s']:.2g}" for contact in item["contacts"]) or None,
            number(item["factor"]),
            number(item["exponent_per_s"]),
            number(item["settled_growth_deg_s_um"]),
            _horizon(item),
            verdict(item),
        )
        for item in found
    ]
    kinds = ["good" if item["sensitive"] is False else "doubt" for item in found]
    said = "".join(
        f"<li>{escape(sentence(item))}</li>" for item in found if item["model"] == FINITE_ELEMENTS
    )
    return Html(
        f"<ul>{said}</ul>"
        + table(heads, rows, "growth", kinds, dense=True)
        + caption(_LEGEND.format(gate=found[0]["gate_deg_s"]) if found else "")
    )


def sentence(item: dict) -> str:
    """Up to when a curve comparison means anything on one condition."""
    if item["horizon_s"] is None:
        return (
            f"{item['condition']}: {verdict(item)}; curves can be compared to their end at "
            f"{1e3 * item['end_s']:.1f} ms"
        )
    return (
        f"{item['condition']}: {verdict(item)}; a curve comparison means something up to "
        f"{_horizon(item)} ms"
    )


def verdict(item: dict) -> str:
    """What 1 um makes of one condition."""
    if item["sensitive"] is None:
        return "a run did not settle"
    return (
        "chaotic"
        if item["chaotic"]
        else "sensitive, not chaotic"
        if item["sensitive"]
        else "stable"
    )


def _horizon(item: dict) -> str:
    return (
        "none"
        if item["horizon_s"] is None
        else f"{1e3 * item['horizon_s']:.1f} of {1e3 * item['end_s']:.1f}"
    )
