"""The reference's own error as the page shows it: settled rates over element size, and tables of
what was refined or changed."""

from typing import TYPE_CHECKING

from tipoff.studies.render.chart import AXIS_COLOURS, GREY, Chart, Line, Panel
from tipoff.studies.render.markup import Html, caption, fold, number, section, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

WORDS = (
    "Condition {condition}. Settled rates over element size; between the dotted lines lies what "
    "the three finest meshes still "
    "leave open at the finest."
)


def draw(page: "Page") -> Html:
    """The section. Nothing without its result, and no reminder either: it takes minutes to make."""
    found = page.documents.get("convergence")
    if not found:
        return Html("")
    chart = picture(found)
    drawn = page.figure(chart, WORDS.format(condition=found["condition"])) if chart.panels else ""
    return section("convergence", "Error of the reference itself", drawn, tables(found))


def picture(document: dict) -> Chart:
    """Settled rates over element size, one panel an axis, with the band of the finest mesh's
    uncertainty."""
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
    sizes, values, open_ = [1e3 * size for size in row["sizes"]], row["values"], row["uncertainty"]
    bounds = [
        Line([0.0, sizes[0]], [value, value], "uncertainty of the finest mesh", GREY, 1.1, ":")
        for value in (values[-1] - open_, values[-1] + open_)
    ]
    return Panel(
        row["quantity"],
        "element size (mm)",
        "rate (deg/s)",
        [*bounds, Line(sizes, values, "finite elements", colour, marker="o", legend=False)],
    )


def tables(document: dict) -> Html:
    """What each table says in words, then the orders and indices, the penalty and the
    quadrature."""
    heads = (
        "quantity",
        "unit",
        "values, coarsest first",
        "order",
        "± at the finest",
        "the same (%)",
        "± as other stages run",
        "by",
    )
    said = "".join(f"<li>{line[0].upper()}{line[1:]}.</li>" for line in document["summary"])
    parts = [Html(f"<ul>{said}</ul>")]
    for parameter, factor, unit in (("element size", 1e3, "mm"), ("time step", 1e9, "ns")):
        rows = [row for row in document["quantities"] if row["parameter"] == parameter]
        sizes = ", ".join(f"{factor * size:.4g}" for size in rows[0]["sizes"])
        parts += [
            Html(f"<h3>{parameter.capitalize()}: {sizes} {unit}</h3>"),
            table(heads, [_row(row) for row in rows], dense=True),
        ]
    parts.append(
        caption(
            "Order and index (GCI, safety factor 1.25) after Roache and ASME V&V 20. Where the "
            "values show no order, or none that the "
            f"method can have, the last column says what was done instead. {_meshes(document)}"
        )
    )
    return Html("".join([*parts, _changes(document)]))


def _row(row: dict) -> tuple:
    values = ", ".join("–" if value is None else f"{value:.5g}" for value in row["values"])
    return (
        row["quantity"],
        row["unit"],
        values,
        number(row["order"]),
        number(row["uncertainty"], 2),
        number(row["gci_percent"], 2),
        number(row["nominal_uncertainty"], 2),
        row["method"],
    )


def _meshes(document: dict) -> str:
    counts = ", ".join(f"{mesh['elements']:,}" for mesh in document["meshes"])
    return (
        f"Elements of the meshes: {counts}. A wall has one element through it at least, so "
        f"coarse meshes differ along it only."
    )


def _changes(document: dict) -> Html:
    heads = ("settled x, y, z (deg/s)", "largest change (deg/s)", "status")
    size = f"{1e3 * document['coarse_size_m']:g} mm"
    stiffness = [
        (f"{row['factor']:g}", number(row["penalty_n_m3"]), *_changed(row))
        for row in document["penalty"]
    ]
    points = [(str(row["points_per_edge"]), *_changed(row)) for row in document["quadrature"]]
    slides = [
        (
            f"{1e3 * row['element_size_m']:g}",
            str(row["points_per_edge"]),
            f"{row['frequency']:.4g}",
            str(row["facets"]),
            f"{100.0 * row['ripple']:.2g}",
            f"{100.0 * row['background']:.2g}",
        )
        for row in document["ripple"]
    ]
    if not stiffness:
        return Html("")
    return Html(
        "".join(
            [
                fold(
                    "ripple of a constant contact force where facets are crossed",
                    table(
                        (
                            "element size (mm)",
                            "Gauss points per facet edge",
                            "facets crossed at (Hz)",
                            "facets",
                            "ripple (%)",
                            "beside it (%)",
                        ),
                        slides,
                    )
                    + caption(
                        "A payload under constant load slides along straight walls: largest "
                        "amplitude of a face's force at that frequency and "
                        "its next two multiples, and half-way between them, over the mean force."
                    ),
                )
                if slides
                else "",
                fold(
                    f"penalty stiffness, {size} elements",
                    table(("times the scene's", "penalty (N/m³)", *heads), stiffness),
                ),
                fold(
                    f"contact quadrature, {size} elements",
                    table(("Gauss points per facet edge", *heads), points),
                ),
            ]
        )
    )


def _changed(row: dict) -> tuple:
    rates = ", ".join("–" if rate is None else f"{rate:.4g}" for rate in row["settled_rate_deg_s"])
    return rates, number(row["settled_rate_change_deg_s"], 2), row["status"]
