"""Error over wall time."""

from collections.abc import Callable
from operator import attrgetter, itemgetter
from typing import Any

from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.studies.agreement import verdicts
from tipoff.studies.cost import choice
from tipoff.studies.cost.results import BY_MODES, Cost, Match, Point
from tipoff.studies.render.chart import Chart, Line, Panel, marks
from tipoff.studies.render.column import Column, of_record
from tipoff.studies.render.document import Figure, Fold, Notice, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Table

_ERRORS = (
    "Condition {condition}. Errors are relative to the finest finite-element mesh. The band is "
    "the uncertainty of this mesh; in the Pareto front smaller errors count as the band. Below: "
    "the part of the error that a smaller tolerance removes. Labels: model, element size, "
    "number of modes. The cross is the recommended model: the fastest surrogate with an error of at "
    "most 0.1 deg/s."
)

# colour, marker and dash of each model, in the order of the points
_LOOKS = (
    (NAVY, "s", "-"),
    (GREY, "^", ":"),
    (AMBER, "o", "--"),
    (TEAL, "v", "-."),
    (VERMILION, "D", "-"),
    (NAVY, "o", ":"),
    (NAVY, "x", ""),
    (VERMILION, "P", ":"),
)


def draw(found: Cost) -> list[Part]:
    """Errors over wall time, the points of the Pareto front, of which each is the fastest with its
    accuracy, and for each surrogate the mesh with the same error."""
    best = sorted((point for point in found.points if point.pareto), key=lambda item: item.wall_s)
    title = (
        f"The fastest model of each accuracy, condition {found.condition}, "
        f"{len(best)} of {len(found.points)} measured points:"
    )
    matched = "Each surrogate, and the fastest finite-element mesh whose error is not larger:"
    kinds = ["best" if point.pareto else "" for point in found.points]
    notes = ("Bold: points of the Pareto front.",)
    columns = (*_POINTS, "integration_error_deg_s")
    return [
        *_unranked(found),
        Figure(lambda: picture(found), _ERRORS.format(condition=found.condition)),
        Table.of_records(best, *_POINTS, title=title, kind=Point),
        Table.of_records(found.matched, *_MATCHES, title=matched, kind=Match),
        Fold(
            "All measured points",
            [Table.of_records(found.points, *columns, kinds=kinds, notes=notes)],
        ),
    ]


def _unranked(found: Cost) -> list[Part]:
    unsure = choice.unranked(found.condition, found.band_deg_s)
    return [Notice(f"{unsure}.")] if unsure else []


def _of_point(name: str) -> tuple[Column, Callable[[Point], Any]]:
    """The column of an error; the cell of the reference is "reference"."""
    return POINT[name], lambda point: "reference" if point.reference else getattr(point, name)


def _of_mesh(match: Match) -> Any:
    return "reference" if match.mesh_is_reference else match.mesh_error_deg_s


POINT = of_record(Point)
_POINTS = ("model", "numerics", "wall_s", _of_point("error_deg_s"), _of_point("curve_error"))
_MATCHES = (
    *("model", "numerics", "wall_s", "error_deg_s", "mesh", "mesh_wall_s"),
    (POINT["error_deg_s"], _of_mesh),
    "ratio",
)


def picture(cost: Cost) -> Chart:
    """Errors of the settled rates and of the curves over wall time, one line per model, with the
    uncertainty of the finest mesh and the Pareto front; and the surrogate's error of time
    integration."""
    looks = dict(zip(dict.fromkeys(point.model for point in cost.points), _LOOKS))
    shade = cost.band_deg_s
    band = (shade, "uncertainty of the finest mesh") if shade else None

    def settled(point: Point) -> float | None:
        return shade if point.reference else point.error_deg_s

    def curve(point: Point) -> float | None:
        return point.curve_error and 100.0 * point.curve_error

    integration = attrgetter("integration_error_deg_s")
    rates = "error of the settled rates (deg/s)"
    panels = []
    for title, error, label, shaded in (
        ("settled rates, against the finest mesh", settled, rates, band),
        ("curves of the rates, against the finest mesh", curve, "rate L2 (%)", None),
        ("settled rates, error of time integration", integration, rates, None),
    ):
        lines = [
            _cost_line(
                [p for p in cost.points if p.model == model and (error(p) or 0.0) > 0.0],
                error,
                model,
                look,
                beside=("bottom right", "top right")[place % 2],
            )
            for place, (model, look) in enumerate(looks.items(), 1)
        ]
        front = [_front(cost), *_recommended(cost)] if shaded else []
        shown = [line for line in front + lines if len(line.x)]
        axes = "wall time of one run (s)", label
        panels.append(Panel(title, *axes, shown, log=True, band=shaded))
    return Chart("cost", [panel for panel in panels if panel.lines], columns=2, height=420)


def recommended(cost: Cost) -> Point | None:
    """The fastest surrogate within the limit of agreement, or the most accurate one if none is. None where
    errors do not rank the models, or the uncertainty of the finest mesh is not known."""
    if cost.band_deg_s is None or choice.unranked(cost.condition, cost.band_deg_s):
        return None
    points = [
        (point.error_deg_s, point)
        for point in cost.points
        if point.error_deg_s is not None and point.model != FINITE_ELEMENTS
    ]
    good = [point for error, point in points if error <= verdicts.CONVERGED_DEG_S]
    if good:
        return min(good, key=lambda point: point.wall_s)
    return min(points, key=itemgetter(0))[1] if points else None


def _recommended(cost: Cost) -> list[Line]:
    point = recommended(cost)
    if point is None or not point.error_deg_s:
        return []
    name = f"recommended: {point.model}, {point.numerics}"
    return [marks([point.wall_s], [point.error_deg_s], name, marker="x", size=16.0)]


def _front(cost: Cost) -> Line:
    """The Pareto front as a step line; errors below the band count as the band."""
    front = sorted(
        (point.wall_s, bound)
        for point, bound in choice.trusted(cost.points, cost.band_deg_s)
        if point.pareto
    )
    walls = [wall for wall, _ in front for _ in range(2)]
    errors = [error for _, error in front for _ in range(2)]
    across = [*walls[1:], *[max(point.wall_s for point in cost.points)] * bool(walls)]
    return Line(across, errors, "Pareto front", "#000000", 3.0, opacity=0.25)


def _cost_line(
    points: list[Point],
    error: Callable[[Point], Any],
    model: str,
    look: tuple[str, str, str],
    beside: str,
) -> Line:
    """One model, with its name at its slowest point; meshes and numbers of modes have labels of
    their own."""
    colour, marker, dash = look
    varied = any(point.modes is not None for point in points)
    by_modes = model == BY_MODES
    labels = [str(point.modes) if by_modes else point.numerics.split(",")[0] for point in points]
    if model != FINITE_ELEMENTS and not varied:
        # to the right of the slowest point there is no other surrogate
        named = max(points, key=lambda point: point.wall_s, default=None)
        labels = [model.split(" of ")[0] if point is named else "" for point in points]
    return Line(
        [point.wall_s for point in points],
        [error(point) for point in points],
        model,
        colour,
        dash=dash,
        marker=marker,
        labels=tuple(labels),
        beside="top center" if varied or model == FINITE_ELEMENTS else beside,
    )
