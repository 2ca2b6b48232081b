"""Runs without each effect."""

from tipoff.studies.ablation.stage import Ablation
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Table


def draw(found: Ablation) -> list[Part]:
    """Time and settled rates of both fidelities without each effect."""
    note = (
        "The first row of each model has all effects; "
        "effects that are absent in the scene have small values. Each further row lacks one "
        "effect. The last row of the reference also steps the rails at rest. Times exclude "
        "compilation. For the reference they are those of a complete run with elements of "
        f"{1e3 * found.element_size_m:g} mm, for the surrogate (compliant contact) those "
        "of the time loop."
    )
    title = f"All effects of condition {found.condition}, and each left out in turn:"
    return [Table.of_records(found.rows, title=title, notes=(note,))]
