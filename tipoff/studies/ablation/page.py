"""Runs without each effect, on the page."""

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Cells, Column, Table

_COLUMNS: Cells = (
    ("model", "fidelity"),
    ("variant", "variant"),
    ("status", "status"),
    (Column("time", "s"), "time_s"),
    (Column("time ratio", form=".2f"), "time_ratio"),
)
_CHANGE = "settled_rate_change_deg_s"


def draw(document: dict) -> list[Part]:
    """Time and settled rates of both fidelities without each effect."""
    columns: Cells = (
        *_COLUMNS,
        (Column("time per step", "ns", ",.0f"), "ns_per_step"),
        (Column("settled x, y, z", "deg/s"), "settled_rate_deg_s"),
        (Column("change x, y, z", "deg/s", "+.3g"), _CHANGE),
        ("effects in the compiled kernel", lambda row: ", ".join(row["compiled"]) or "none"),
    )
    note = (
        f"Condition {document['condition']}. The first row of each model has all effects; "
        "effects that are absent in the scene have small values. Each further row lacks one "
        "effect. The last row of the reference also steps the rails at rest. Times exclude "
        "compilation. For the reference they are those of a complete run with elements of "
        f"{1e3 * document['element_size_m']:g} mm, for the surrogate (compliant contact) those "
        "of the time loop."
    )
    return [Table.of(document["rows"], columns, notes=(note,))]


def terminal(document: dict) -> list[Part]:
    """What each effect changes and costs."""
    columns: Cells = (
        *_COLUMNS,
        (Column("change of the settled rates x, y, z", "deg/s", "+.3g"), _CHANGE),
    )
    title = f"Without each effect, condition {document['condition']}:"
    return [Table.of(document["rows"], columns, title=title)]
