"""Ripple of a constant contact force."""

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Table
from validation.ripple.stage import Ripples, Slide

_NOTE = (
    "A payload under constant load slides along straight walls: largest amplitude of the force of "
    "a face at the facet frequency and its next two multiples, and half-way between them, relative "
    "to the mean force."
)


def draw(found: Ripples) -> list[Part]:
    """A row for each mesh; the first has few contact cells."""
    return [Table.of_records(found.rows, kind=Slide, notes=(_NOTE,))]


def sentences(found: Ripples) -> list[str]:
    """The ripple on the last mesh; empty without one."""
    return [
        f"ripple of a constant contact force at the facet frequency {row.frequency:.4g} Hz, "
        f"facets of {1e3 * row.element_size_m:.3g} mm: {100.0 * row.ripple:.2g} %"
        for row in found.rows[-1:]
    ]
