"""What accuracy costs, on the page."""

from typing import TYPE_CHECKING

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS
from tipoff.studies.cost import choice, scaling_page
from tipoff.studies.render.chart import AMBER, GREY, NAVY, TEAL, VERMILION, Chart, Line, Panel
from tipoff.studies.render.markup import Html, joined, number, paragraph, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""

    def body(found: dict) -> Html:
        return joined(
            page.figure(
                picture(found),
                f"Condition {found['condition']}. Error against the finest finite-element mesh, "
                f"whose own "
                "uncertainty is the band: an error inside it cannot be told from zero, and counts "
                "as the band where the front of the "
                "best is drawn; the finest mesh stands at it. Right: what a tighter tolerance can "
                "still buy. Labels: element size, "
                "tolerance.",
            ),
            tables(found),
            Html("<h3>How cost grows</h3>"),
            page.figure(
                scaling_page.picture(found["scaling"]),
                scaling_page.WORDS.format(condition=found["condition"]),
            ),
            scaling_page.tables(found["scaling"]),
        )

    return page.section("cost_study", "cost", "What accuracy costs", body, "cost")


def tables(document: dict) -> Html:
    """Error against wall time, as numbers."""
    rows = [
        (
            p["model"],
            p["numerics"],
            f"{p['wall_s']:.3g}",
            "the yardstick" if p["error_deg_s"] is None else number(p["error_deg_s"]),
            "the yardstick" if p["curve_error"] is None else number(100.0 * p["curve_error"]),
            number(p["integration_error_deg_s"]),
            "best at its price" if p["pareto"] else "",
        )
        for p in document["points"]
    ]
    same = [
        (
            m["model"],
            f"{m['numerics']}, {1e3 * m['wall_s']:.3g} ms",
            number(m["error_deg_s"]),
            f"{m['mesh']}, {m['mesh_wall_s']:.3g} s",
            "the yardstick" if m["mesh_error_deg_s"] is None else number(m["mesh_error_deg_s"]),
            f"{m['ratio']:,.0f}",
        )
        for m in document["matched"]
    ]
    return Html(
        table(
            (
                "model",
                "numerics",
                "wall time (s)",
                "error (deg/s)",
                "rate L2 (%)",
                "of which time integration (deg/s)",
                "",
            ),
            rows,
        )
        + paragraph(
            "What the same accuracy costs with finite elements: "
            "the coarsest mesh that is no less exact than each surrogate."
        )
        + table(
            (
                "surrogate",
                "as fast as it is so exact",
                "error (deg/s)",
                "mesh",
                "error (deg/s)",
                "times as long",
            ),
            same,
        )
    )


def picture(cost: dict) -> Chart:
    """Errors of the settled rates and of the curves against wall time, one line per model, with the
    band of the reference's own uncertainty and the front of the best; and the part of the
    surrogate's error that a tighter tolerance can buy off."""
    looks = (("s", "-"), ("^", ":"), ("o", "--"), ("v", "-."), ("D", "-"), ("o", ":"), ("x", ""))
    models = dict.fromkeys(point["model"] for point in cost["points"])
    look = {
        model: (colour, *rest)
        for model, colour, rest in zip(
            models, (NAVY, GREY, AMBER, TEAL, VERMILION, NAVY, NAVY), looks
        )
    }
    band = (cost["band_deg_s"], "the reference's own uncertainty") if cost["band_deg_s"] else None
    settled = [
        point
        | {
            "error_deg_s": cost["band_deg_s"]
            if point["error_deg_s"] is None
            else point["error_deg_s"]
        }
        for point in cost["points"]
    ]
    curves = [
        point | {"curve_error": point["curve_error"] and 100.0 * point["curve_error"]}
        for point in cost["points"]
    ]
    panels = []
    for title, points, error, label, shaded in (
        (
            "settled rates, against the finest mesh",
            settled,
            "error_deg_s",
            "error of the settled rates (deg/s)",
            band,
        ),
        (
            "curves of the rates, against the finest mesh",
            curves,
            "curve_error",
            "rate L2 (%)",
            None,
        ),
        (
            "settled rates, of which time integration",
            cost["points"],
            "integration_error_deg_s",
            "error of the settled rates (deg/s)",
            None,
        ),
    ):
        lines = [
            _cost_line(
                [p for p in points if p["model"] == model and (p[error] or 0.0) > 0.0],
                error,
                model,
                *style,
            )
            for model, style in look.items()
        ]
        front = [_front(cost)] if shaded else []
        shown = [line for line in front + lines if len(line.x)]
        panels.append(Panel(title, "wall time of one run (s)", label, shown, True, shaded))
    return Chart("cost", [panel for panel in panels if panel.lines], columns=3, height=380)


def _front(cost: dict) -> Line:
    """Steps from each of the best to the next: errors below the band count as the band."""
    best = sorted(
        (p["wall_s"], p["trusted_deg_s"])
        for p in choice.trusted(cost["points"], cost["band_deg_s"])
        if p["pareto"]
    )
    walls, errors = [wall for wall, _ in best], [error for _, error in best]
    return Line(
        [
            wall
            for pair in zip(walls, [*walls[1:], max(p["wall_s"] for p in cost["points"])])
            for wall in pair
        ],
        [error for error in errors for _ in range(2)],
        "front of the best",
        "#000000",
        3.0,
        "-",
        opacity=0.25,
    )


def _cost_line(
    points: list[dict], error: str, model: str, colour: str, marker: str, dash: str
) -> Line:
    """One model; tolerances are labelled only where they matter, in the panel of the time
    integration, and once for all models, numbers of modes wherever they are varied."""
    varied = any(point["modes"] for point in points)
    labels = [
        str(point["modes"])
        if varied
        else point["numerics"].split(",")[0].removeprefix("tolerance ")
        for point in points
    ]
    if (
        model != FINITE_ELEMENTS
        and not varied
        and (error != "integration_error_deg_s" or model != COMPLIANT)
    ):
        labels = [""] * len(labels)
    return Line(
        [p["wall_s"] for p in points],
        [p[error] for p in points],
        model,
        colour,
        1.6,
        dash,
        marker=marker,
        labels=tuple(labels),
    )
