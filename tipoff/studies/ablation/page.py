"""Runs without each effect, on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Column, Table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> list[Part]:
    """The table, or how to make the result."""
    return page.shown("ablation", lambda found: [ablation(found)], "ablation")


def ablation(document: dict) -> Table:
    """Time and settled rates of both fidelities without each effect."""
    columns = (
        "model",
        "variant",
        "status",
        Column("time", "s"),
        Column("time ratio", form=".2f"),
        Column("time per step", "ns", ",.0f"),
        Column("settled x, y, z", "deg/s"),
        Column("change x, y, z", "deg/s", "+.3g"),
        "effects in the compiled kernel",
    )
    rows = [
        (
            row["fidelity"],
            row["variant"],
            row["status"],
            row["time_s"],
            row["time_ratio"],
            row["ns_per_step"],
            row["settled_rate_deg_s"],
            row["settled_rate_change_deg_s"],
            ", ".join(row["compiled"]) or "none",
        )
        for row in document["rows"]
    ]
    note = (
        f"Condition {document['condition']}. The first line of each model has all effects; effects "
        "that the scene lacks have small values. Each further line lacks one effect; the last line of the "
        "reference also steps the rails that rest. Times exclude "
        "compilation: a whole run of the reference with elements of "
        f"{1e3 * document['element_size_m']:g} mm, the time loop alone of the surrogate on "
        "compliant contact."
    )
    return Table(columns, rows, (note,))


def terminal(document: dict) -> list[Part]:
    """What each effect changes and costs."""
    columns = (
        "model",
        "variant",
        "status",
        Column("time", "s"),
        Column("time ratio", form=".2f"),
        Column("change of the settled rates x, y, z", "deg/s", "+.3g"),
    )
    keys = (
        *("fidelity", "variant", "status", "time_s", "time_ratio"),
        "settled_rate_change_deg_s",
    )
    rows = [[row[key] for key in keys] for row in document["rows"]]
    return [Table(columns, rows, title=f"Without each effect, condition {document['condition']}:")]
