"""Error of the reference on the page and in the terminal: settled rates over element size, and
tables of the refinements and changes."""

from typing import TYPE_CHECKING

from tipoff.studies.convergence import summary
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AXIS_COLOURS, GREY
from tipoff.studies.render.table import Cells, Column, Table
from tipoff.studies.render.uncertain import Measured

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_RATES = (
    "Condition {condition}. Settled rates over element size; dotted: uncertainty of the finest "
    "mesh, from the three finest meshes."
)
_METHOD = (
    "Order and GCI according to Roache and ASME V&V 20, safety factor 1.25. If the observed "
    "order is not between 0.5 and 2, the factor is 3. If the changes do not decrease, the "
    "quantity is not converged, and its uncertainty is three times the range of the values."
)
_RIPPLE = (
    "A payload under constant load slides along straight walls: largest amplitude of the force of "
    "a face at the facet frequency and its next two multiples, and half-way between them, relative "
    "to the mean force."
)


def draw(page: "Page") -> list[Part]:
    """The section; empty without a result, which takes minutes to make."""
    found = page.documents.get("convergence")
    if not found:
        return []
    chart = picture(found)
    figure = [Figure(chart, _RATES.format(condition=found["condition"]))] if chart.panels else []
    return [*figure, Bullets(summary.lines(found)), *tables(found), *_changes(found)]


def terminal(found: dict) -> list[Part]:
    """The sentences and the tables of the refinements."""
    return [Bullets(summary.lines(found)), *tables(found)]


def picture(document: dict) -> Chart:
    """Settled rates over element size, one panel an axis, with the uncertainty of the finest
    mesh."""
    rows = [
        row
        for row in document["quantities"]
        if row["parameter"] == "element size" and row["unit"] == "deg/s"
    ]
    panels = [
        _panel(row, colour)
        for row, colour in zip(rows, AXIS_COLOURS.values())
        if None not in row["values"]
    ]
    return Chart("convergence", panels, columns=3, height=300)


def _panel(row: dict, colour: str) -> Panel:
    sizes, values = [1e3 * size for size in row["sizes"]], row["values"]
    bounds = (
        [
            Line([0.0, sizes[0]], [value, value], "uncertainty of the finest mesh", GREY, 1.1, ":")
            for value in (values[-1] - row["uncertainty"], values[-1] + row["uncertainty"])
        ]
        if row["uncertainty"] is not None
        else []
    )
    return Panel(
        row["quantity"],
        "element size (mm)",
        "rate (deg/s)",
        [*bounds, Line(sizes, values, "finite elements", colour, marker="o", legend=False)],
    )


def tables(document: dict) -> list[Part]:
    """One table of orders and uncertainties for each refined parameter."""
    found: list[Part] = []
    for parameter, factor, unit in (("element size", 1e3, "mm"), ("time step", 1e9, "ns")):
        rows = [row for row in document["quantities"] if row["parameter"] == parameter]
        sizes = [f"{factor * size:.4g} {unit}" for size in rows[0]["sizes"]]
        heads: tuple[Column | str, ...] = (
            f"{parameter}: quantity",
            "unit",
            *(Column(size, form=".5g") for size in sizes),
            Column("order", form=".2g"),
            f"± at {sizes[-1]}",
            Column("GCI", "%", ".2g"),
            f"± at {factor * rows[0]['nominal_size']:.4g} {unit}",
            "method",
        )
        shown = [
            (
                row["quantity"],
                row["unit"],
                *(_rounded(row, value) for value in row["values"]),
                row["order"],
                _rounded(row, row["uncertainty"]),
                row["gci_percent"],
                _rounded(row, row["nominal_uncertainty"], row["nominal_uncertainty"]),
                row["method"],
            )
            for row in rows
        ]
        notes = (_meshes(document),) if parameter == "element size" else (_METHOD,)
        found.append(Table(heads, shown, notes, dense=True))
    return found


def _rounded(row: dict, value: float | None, uncertainty: float | None = None) -> Measured:
    """A value of a quantity, by default with the digits that the finest size gives it."""
    own = row["uncertainty"] if uncertainty is None else uncertainty
    return Measured(value, own, apart=True, unit=row["unit"])


def _meshes(document: dict) -> str:
    counts = ", ".join(f"{mesh['elements']:,}" for mesh in document["meshes"])
    return (
        f"Elements of the meshes: {counts}. A wall has at least one element through its thickness, "
        "so coarse meshes differ along the wall only."
    )


def _changes(document: dict) -> list[Part]:
    """Ripple, interface stiffness and contact cells; nothing without contact."""
    if not document["interface_stiffness"]:
        return []
    cells = ("contact cells along each edge of a pad", "cells_per_edge")
    slides: Cells = (
        (Column("element size", "mm", "g", 1e3), "element_size_m"),
        cells,
        (Column("facet frequency", "Hz", ".4g"), "frequency"),
        ("facets", "facets"),
        (Column("ripple", "%", ".2g", 100.0), "ripple"),
        (Column("between multiples", "%", ".2g", 100.0), "background"),
    )
    settled: Cells = (
        (Column("settled x, y, z", "deg/s", ".3f"), "settled_rate_deg_s"),
        (Column("largest change", "deg/s", ".2g"), "settled_rate_change_deg_s"),
        ("status", "status"),
    )
    stiffness: Cells = (
        (Column("factor", form="g"), "factor"),
        (Column("interface stiffness", "N/m³"), "interface_stiffness_n_m3"),
        *settled,
    )
    size = f"{1e3 * document['coarse_size_m']:g} mm"

    def fold(title: str, columns: Cells, rows: list[dict], *notes: str) -> list[Part]:
        return [Fold(title, [Table.of(rows, columns, notes=notes)])] if rows else []

    return [
        *fold("Ripple of a constant contact force", slides, document["ripple"], _RIPPLE),
        *fold(f"Interface stiffness, {size} elements", stiffness, document["interface_stiffness"]),
        *fold(f"Contact cells, {size} elements", (cells, *settled), document["contact_cells"]),
    ]
