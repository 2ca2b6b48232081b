"""Every effect off, on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, joined, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    return page.section(
        "ablation", "ablation", "Only what the scene calls for", ablation, "ablation"
    )


def ablation(document: dict) -> Html:
    """Every effect off, both fidelities: what it costs and what it changes."""
    heads = (
        "model",
        "variant",
        "status",
        "time (s)",
        "time ratio",
        "ns per step",
        "settled x, y, z (deg/s)",
        "change x, y, z (deg/s)",
        "effects in the compiled kernel",
    )
    rows = [
        (
            row["fidelity"],
            row["variant"],
            row["status"],
            f"{row['time_s']:.3g}",
            f"{row['time_ratio']:.2f}",
            f"{row['ns_per_step']:,.0f}",
            _three(row["settled_rate_deg_s"], ""),
            _three(row["settled_rate_change_deg_s"], "+"),
            ", ".join(row["compiled"]) or "none",
        )
        for row in document["rows"]
    ]
    return joined(
        table(heads, rows),
        caption(
            f"Condition {document['condition']}; reference on {1e3 * document['element_size_m']:g} "
            f"mm elements, surrogate on compliant "
            "contact. Times, without compilation: of a whole run of the reference, of the time "
            "loop of the surrogate. The first "
            "line of each model has every effect on, those the scene lacks with small values; each "
            "further line takes one away."
        ),
    )


def _three(values: list[float] | None, sign: str) -> str:
    return (
        "–"
        if values is None
        else ", ".join(f"{value:{sign}.3g}" if value else "0" for value in values)
    )
