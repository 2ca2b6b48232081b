"""Runs without each effect, on the page."""

from tipoff.studies.ablation.stage import Ablation
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Table


def draw(found: Ablation) -> list[Part]:
    """Time and settled rates of both fidelities without each effect."""
    note = (
        f"Condition {found.condition}. The first row of each model has all effects; "
        "effects that are absent in the scene have small values. Each further row lacks one "
        "effect. The last row of the reference also steps the rails at rest. Times exclude "
        "compilation. For the reference they are those of a complete run with elements of "
        f"{1e3 * found.element_size_m:g} mm, for the surrogate (compliant contact) those "
        "of the time loop."
    )
    return [Table.of_records(found.rows, notes=(note,))]


def terminal(found: Ablation) -> list[Part]:
    """The change and the cost of each effect."""
    names = ("fidelity", "variant", "status", "time_s", "time_ratio", "settled_rate_change_deg_s")
    title = f"Without each effect, condition {found.condition}:"
    return [Table.of_records(found.rows, *names, title=title)]
