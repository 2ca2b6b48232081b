"""Hard cases on the page."""

from html import escape
from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, joined, number, paragraph, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    return page.section("stability", "stability", "Hard cases", stability, "stability")


def stability(document: dict) -> Html:
    """Hard cases, held or not, each beside a method that fails."""
    heads = (
        "case",
        "model",
        "measured",
        "limit",
        "largest step (µs)",
        "critical step (µs)",
        "energy drift",
        "simpler method",
        "its figure",
        "verdict",
    )
    rows = [
        (
            _case(c),
            c["fidelity"],
            _figure(c["figure"]),
            number(c["limit"]),
            _micro(c["largest_step_s"]),
            _micro(c["critical_step_s"]),
            number(c["energy_drift"], 2),
            c["control"],
            _figure(c["control_figure"]),
            _held(c),
        )
        for c in document["cases"]
    ]
    kinds = ["good" if c["held"] and c["control_failed"] else "bad" for c in document["cases"]]
    return joined(
        paragraph("Each case stands beside a simpler method that must fail on it."),
        table(heads, rows, kinds=kinds, dense=True),
        caption(
            "Largest step: of the surrogate the proven limit at its smallest, which no step "
            "passed; of the reference the step it took. "
            "Critical step: 2 / ω of the case made linear at its stiffest, beyond which central "
            "differences grow, "
            "or 2 / rate where friction damps faster. Energy drift: largest residual of the total "
            "energy ledger over its scale. A "
            "dash: nothing touches or vibrates, or no figure applies."
        ),
    )


def _case(case: dict) -> Html:
    """Name, what is measured and a remark in one cell, so that the table keeps to the page."""
    remark = f"; {case['note']}" if case["note"] else ""
    return Html(
        f'{escape(case["name"])}<br><span class="small">{escape(case["measure"] + remark)}</span>'
    )


def _micro(seconds: float | None) -> str:
    return "–" if seconds is None else number(1e6 * seconds)


def _figure(value: float | None) -> str:
    return "infinite" if value is None else number(value)


def _held(case: dict) -> str:
    if not case["held"]:
        return "not held"
    return (
        "held; the simpler one fails"
        if case["control_failed"]
        else "held, but the simpler one holds too"
    )
