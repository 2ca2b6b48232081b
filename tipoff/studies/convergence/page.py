"""Error of the reference: settled rates over element size, and tables of the refinements and changes."""

from collections.abc import Sequence
from operator import attrgetter, itemgetter
from typing import Any

from tipoff.comparison.extrapolation import NOT_CONVERGED
from tipoff.highfi.numerics import Numerics
from tipoff.studies.agreement import verdicts
from tipoff.studies.convergence.quantities import RATE
from tipoff.studies.convergence.stage import Change, Convergence, Refined
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AXIS_COLOURS, GREY
from tipoff.studies.render.table import Column, Table
from tipoff.uncertain import LEAST, Measured, number

_RATES = (
    "Condition {condition}. Settled rates over element size; dotted: uncertainty of the finest "
    "mesh, from the three finest meshes."
)
_METHOD = (
    "Order and GCI according to Roache and ASME V&V 20, safety factor 1.25. If the observed "
    "order is not between 0.5 and 2, the factor is 3. If the changes do not decrease, the "
    "quantity is not converged, and its uncertainty is three times the range of the values."
)


def draw(found: Convergence) -> list[Part]:
    """The figure, the sentences, and the tables."""
    chart = picture(found)
    figure = (
        [Figure(lambda: chart, _RATES.format(condition=found.condition))] if chart.panels else []
    )
    return [*figure, Bullets(sentences(found)), *tables(found), *_changed(found)]


def sentences(found: Convergence) -> list[str]:
    """One sentence for each of meshes, steps, interface stiffness, contact cells and equal accuracy
    that the result ``found`` has."""
    step = (
        f", {Numerics().safety:g} of the step limit on elements of {1e3 * found.coarse_size_m:g} mm"
    )
    stiffness = [(row.factor, row) for row in found.interface_stiffness]
    cells = [(row.cells_per_edge, row) for row in found.contact_cells]
    return [
        _refinement(found, "element size", "mm", 1e3, ""),
        _refinement(found, "time step", "ns", 1e9, step),
        *_largest_change("interface stiffness, times", stiffness),
        *_largest_change("contact cells along each edge of a pad,", cells),
        *([found.equal_accuracy.sentence()] if found.equal_accuracy else []),
    ]


def _refinement(found: Convergence, parameter: str, unit: str, factor: float, default: str) -> str:
    """Uncertainty of the settled rates by one ``parameter``, whose sizes are shown in ``unit``,
    times ``factor``; ``default`` is a remark on the default size."""
    rows = found.refined(parameter, RATE)
    known = [
        (row.nominal_uncertainty, row.uncertainty, row)
        for row in rows
        if row.nominal_uncertainty is not None and row.uncertainty is not None
    ]
    if len(known) < len(rows):
        last = [row for row in rows if None in (row.nominal_uncertainty, row.uncertainty)][-1]
        return f"{parameter} on {found.condition}: uncertainty unknown, {last.method}"
    at_nominal, _, worst = sorted(known, key=itemgetter(0))[-1]
    return (
        f"{parameter} on {found.condition}: uncertainty of the settled rates "
        f"{number(at_nominal, '.2g', LEAST)} deg/s at the default "
        f"{factor * worst.nominal_size:.3g} {unit}{default}, "
        f"{number(max(finest for _, finest, _ in known), '.2g', LEAST)} deg/s at "
        f"{factor * worst.sizes[-1]:.3g} {unit}"
        f"{f'; {NOT_CONVERGED}' if worst.method == NOT_CONVERGED else ''}"
    )


def _largest_change(title: str, rows: Sequence[tuple[float, Change]]) -> list[str]:
    """Largest change of a settled rate over the ``rows``; empty without rows."""
    if not rows:
        return []
    change = verdicts.largest(row.settled_rate_change_deg_s for _, row in rows)
    odd = "".join(
        f"; {value:g} {row.status}" for value, row in rows if row.settled_rate_change_deg_s is None
    )
    found = (
        "no run settled"
        if change is None
        else f"a settled rate changes by up to {number(change, '.2g', LEAST)} deg/s"
    )
    return [f"{title} {rows[0][0]:g} to {rows[-1][0]:g}: {found}{odd}"]


def picture(found: Convergence) -> Chart:
    """Settled rates over element size, one panel an axis, with the uncertainty of the finest
    mesh."""
    panels = []
    for row, colour in zip(found.refined("element size", RATE), AXIS_COLOURS.values()):
        sizes = [1e3 * size for size in row.sizes]
        values = [value for value in row.values if value is not None]
        if len(values) < len(sizes):
            continue
        lines = [Line(sizes, values, "finite elements", colour, marker="o", legend=False)]
        for end in (-1.0, 1.0) if row.uncertainty is not None else ():
            bound = [values[-1] + end * (row.uncertainty or 0.0)] * 2
            lines.append(
                Line([0.0, sizes[0]], bound, "uncertainty of the finest mesh", GREY, 1.1, ":")
            )
        panels.append(Panel(row.quantity, "element size (mm)", "rate (deg/s)", lines))
    return Chart("convergence", panels, columns=3, height=300)


def tables(found: Convergence) -> list[Part]:
    """One table of orders and uncertainties for each refined parameter."""
    counts = ", ".join(f"{mesh.elements:,}" for mesh in found.meshes)
    meshes = (
        f"Elements of the meshes: {counts}. A wall has at least one element through its thickness, "
        "so coarse meshes differ along the wall only."
    )
    shown: list[Part] = []
    for parameter, factor, unit, note in (
        ("element size", 1e3, "mm", meshes),
        ("time step", 1e9, "ns", _METHOD),
    ):
        rows = found.refined(parameter)
        sizes = [f"{factor * size:.4g} {unit}" for size in rows[0].sizes]
        columns: list[Any] = [
            (f"{parameter}: quantity", attrgetter("quantity")),
            ("unit", attrgetter("unit")),
            *(
                (Column(size, form=".5g"), lambda row, at=at: _rounded(row, row.values[at]))
                for at, size in enumerate(sizes)
            ),
            (Column("order", form=".2g"), attrgetter("order")),
            (f"± at {sizes[-1]}", lambda row: _rounded(row, row.uncertainty)),
            (Column("GCI", "%", ".2g"), attrgetter("gci_percent")),
            (
                f"± at {factor * rows[0].nominal_size:.4g} {unit}",
                lambda row: _rounded(row, row.nominal_uncertainty, row.nominal_uncertainty),
            ),
            ("method", attrgetter("method")),
        ]
        shown.append(Table.of_records(rows, *columns, notes=(note,), dense=True))
    return shown


def _rounded(row: Refined, value: float | None, uncertainty: float | None = None) -> Measured:
    """A value of a quantity, by default rounded to its uncertainty at the finest size."""
    own = row.uncertainty if uncertainty is None else uncertainty
    return Measured(value, own, apart=True, unit=row.unit)


def _changed(found: Convergence) -> list[Part]:
    """Interface stiffness and contact cells; empty without contact."""
    if not found.interface_stiffness:
        return []
    settled = ("settled_rate_deg_s", "settled_rate_change_deg_s", "status")
    size = f"{1e3 * found.coarse_size_m:g} mm"
    stiffness = Table.of_records(
        found.interface_stiffness, "factor", "interface_stiffness_n_m3", *settled
    )
    cells = Table.of_records(found.contact_cells, "cells_per_edge", *settled)
    return [
        Fold(f"Interface stiffness, {size} elements", [stiffness]),
        Fold(f"Contact cells, {size} elements", [cells]),
    ]
