"""The flight: figures of paths, axes, clearance and scatter, and tables of conditions and cases."""

import math
from collections.abc import Callable, Sequence

from tipoff.scenes import halving
from tipoff.studies.flight.results import Condition, Curves, Flight, ManyFlights, Orbit
from tipoff.studies.flight.summary import BY_NAME
from tipoff.studies.populations import answers, population
from tipoff.studies.render.chart import Chart, Line, Panel, marks
from tipoff.studies.render.document import Caption, Figure, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Noted, Table, estimate, percent
from tipoff.workspace.words import counted

_LOOKS = (
    (NAVY, "-", "o"),
    (VERMILION, "--", "s"),
    (AMBER, "-.", "^"),
    (TEAL, ":", "D"),
    (GREY, "-", "v"),
)
_TARGET = (
    "miss_m",
    "tip_off_miss_m",
    "passes_s",
    "pointing_deg",
    "limit_s",
    "clearance_mm",
    "closest_ms",
)
_ROTATION = ("cone_least_deg", "cone_largest_deg", "coning_deg_s", "nutation_s")
_PATHS = (
    "Left and middle: path to the target in orbit axes; sideways is scene y, up is scene z. All "
    "paths have the curvature of the orbit. Right: path relative to the platform."
)
_AXES = (
    "Left: direction of the payload's x axis in inertial space during one round about the angular "
    "momentum; the distance from the origin is the angle to the launch axis, markers show the "
    "instant of passing the target. Right: the same angle over time until the target is passed."
)
_CLEARANCE = (
    "Smallest distance between the payload's box and the boxes of platform and rails after the "
    "exit. Negative values are overlap."
)
_SCATTER = (
    "Left: points where the cases pass the plane of the target. A shot without errors also misses, "
    "because the orbit curves its path. Right: share of cases with a larger miss distance, in "
    "total and by ejection errors alone, with bounds of the quantiles."
)
_EXITS = (
    "State at the exit: settled rates in payload body axes, velocity across the launch axis, and "
    "attitude as a rotation vector, to four digits."
)
_BOXES = (
    "Negative clearance is the depth of overlap of the rigid boxes of the scene. `flight.body` is "
    "the size of the payload without its pads."
)
_CONE = "The cone angle is that between the payload's x axis and its angular momentum."


def draw(found: Flight) -> list[Part]:
    """The flight of each condition and of the cases."""
    notes = [_BOXES] * (not found.flight.no_clearance) + remarks(
        found.flight, found.cases.limit_open
    )
    return [
        f"{_setup(found)} Agreement of the model: {found.agreement}.",
        *figures(found),
        table_of_conditions(found.conditions, [item.name for item in answers.ALL], [_EXITS], ".4g"),
        table_of_conditions(found.conditions, _TARGET, notes),
        table_of_conditions(found.conditions, _ROTATION, [_CONE]),
        _cases(found),
        Caption(f"Store {found.cases.store}, data {found.data}."),
    ]


def table_of_conditions(
    conditions: Sequence[Condition], shown: Sequence[str], notes: Sequence[str], form=".3g"
) -> Table:
    """The quantities ``shown`` of every condition, or its status if it has no flight."""
    rows = [
        (row.condition, *(row.flown[name] for name in shown))
        if row.flown
        else (Noted(row.condition, row.status), *[None] * len(shown))
        for row in conditions
    ]
    columns = [Column(BY_NAME[name].label, BY_NAME[name].unit, form) for name in shown]
    return Table(["condition", *columns], rows, notes=tuple(notes), dense=True)


def _cases(found: Flight) -> Table:
    many = found.cases
    shares = [row.share for row in next(iter(many.quantiles.values()), ())]
    counts, errors = many.counts, halving.with_sizes(found.errors, found.sizes)
    notes = (
        f"{counted(counts['asked'], 'case')} with errors of {errors}: {counts['ok']:,} ok, "
        f"{counts['refused']:,} refused, {counts['failed']:,} failed; {many.settled:,} flown.{_touching(many)}",
        "Each share of the cases is below the value of its column. In brackets: bounds at "
        f"{many.confidence:.0%} confidence ({many.bounds}).",
    )
    rows = [
        (
            f"{BY_NAME[name].label} ({BY_NAME[name].unit})",
            *("never" if row.value is None else estimate(row) for row in quantiles),
        )
        for name, quantiles in many.quantiles.items()
    ]
    heads = ["quantity", *(f"{percent(share, '.4g')} %" for share in shares)]
    return Table(heads, rows, notes=notes, dense=True)


def figures(found: Flight) -> list[Figure]:
    """Charts with their captions."""
    curves = found.curves
    drawn = [
        Figure(lambda: _paths(curves, found.flight), _PATHS),
        Figure(lambda: _axes(curves), _AXES),
    ]
    if near := [curve for curve in curves if curve.clearance_s]:
        drawn.append(Figure(lambda: _clearance(near), _CLEARANCE))
    if found.cases.points_m:
        drawn.append(Figure(lambda: _scatter(found.cases), _SCATTER))
    return drawn


_Axis = Callable[[Curves], Sequence[float]]


def _lines(curves: Sequence[Curves], x: _Axis, y: _Axis) -> list[Line]:
    return [
        Line(x(curve), y(curve), curve.condition, colour, 1.8, dash)
        for curve, (colour, dash, _) in zip(curves, _LOOKS)
    ]


def _paths(curves: Sequence[Curves], flight: Orbit) -> Chart:
    def path(index: int) -> _Axis:
        return lambda curve: [row[index] for row in curve.to_target_m]

    def apart(index: int) -> _Axis:
        return lambda curve: [1e-3 * row[index] for row in curve.orbit_m]

    target = marks([flight.range_m], [0.0], "target", marker="D")
    platform = marks([0.0], [0.0], "platform", marker="s")
    along, orbit = "along the launch axis (m)", ("along the orbit (km)", "radially outwards (km)")
    sideways, up = (_lines(curves, path(0), path(place)) for place in (1, 2))
    away = [*_lines(curves, apart(1), apart(0)), platform]
    panels = [
        Panel("to the target, sideways", along, "y (m)", [*sideways, target]),
        Panel("to the target, up", along, "z (m)", [*up, target]),
        Panel(f"{flight.duration_s / 60.0:.3g} min, from the platform", *orbit, away),
    ]
    return Chart("flight-path", panels, columns=3, height=320)


def _axes(curves: Sequence[Curves]) -> Chart:
    passed = [
        marks([y], [z], curve.condition, colour, marker)
        for curve, (colour, _, marker) in zip(curves, _LOOKS)
        for y, z in [curve.axis_at_target_deg]
    ]
    around = _lines(
        curves,
        lambda curve: [y for y, _ in curve.axis_deg],
        lambda curve: [z for _, z in curve.axis_deg],
    )
    angle = _lines(curves, lambda curve: curve.time_s, lambda curve: curve.pointing_deg)
    towards = "towards y (deg)", "towards z (deg)"
    panels = [
        Panel("cone of the x axis", *towards, [*around, *passed]),
        Panel("pointing error", "time after exit (s)", "angle (deg)", angle),
    ]
    return Chart("flight-axis", panels, columns=2, height=360)


def _clearance(curves: Sequence[Curves]) -> Chart:
    lines = _lines(
        curves,
        lambda curve: [1e3 * time for time in curve.clearance_s],
        lambda curve: [1e3 * gap for gap in curve.clearance_m],
    )
    ends = (min(line.x[0] for line in lines), max(line.x[-1] for line in lines))
    lines.append(Line(ends, (0.0, 0.0), "touch", "#000000", 1.0, ":"))
    panel = Panel("", "time after exit (ms)", "clearance (mm)", lines)
    return Chart("flight-clearance", [panel], height=300)


def _scatter(many: ManyFlights) -> Chart:
    y, z, orbital_y, orbital_z = zip(*many.points_m)
    errors = [math.hypot(a - c, b - d) for a, b, c, d in many.points_m]
    shares = [
        *_exceeded(many, "miss_m", list(map(math.hypot, y, z)), "total", NAVY, "-"),
        *_exceeded(many, "tip_off_miss_m", errors, "ejection errors alone", AMBER, "--"),
    ]
    points = [
        marks(y, z, "case", NAVY, opacity=0.35, size=3.0),
        marks(orbital_y[:1], orbital_z[:1], "without errors", VERMILION),
        marks([0.0], [0.0], "target", marker="D"),
    ]
    title = f"{len(y):,} of {many.settled:,} cases in the plane of the target"
    larger = "cases with a larger miss distance", "miss distance (m)", "share (%)"
    panels = [Panel(title, "y (m)", "z (m)", points), Panel(*larger, shares)]
    return Chart("flight-miss", panels, columns=2, height=360)


def _exceeded(
    many: ManyFlights, name: str, values: list[float], words: str, colour: str, dash: str
) -> list[Line]:
    """Share of cases above each value, and bounds of the quantiles."""
    above = [100.0 * (1.0 - (index + 1) / len(values)) for index in range(len(values))]
    bounds = []
    for row in many.quantiles.get(name, ()):
        if row.low is not None and row.high is not None:
            ends, share = [row.low, row.high], [100.0 * (1.0 - row.share)] * 2
            bounds.append(Line(ends, share, "bounds", VERMILION, 2.5, marker="D", size=5.0))
    return [Line(sorted(values), above, words, colour, 2.0, dash), *bounds]


def _setup(found: Flight) -> str:
    flight, limit = found.flight, found.flight.pointing_limit_deg
    return (
        f"Target {flight.range_m:g} m along the launch axis, at rest relative to a circular "
        f"orbit of {flight.period_s / 60.0:.4g} min; model {population.model_words(found)}. Gravity alone acts "
        f"after the exit.{'' if limit is None else f' The pointing limit is {limit:g} deg.'}"
    )


def remarks(flight: Orbit, limit_open: int) -> list[str]:
    """Limitations of the result, one sentence each."""
    lines = {
        f"No clearance is computed: {flight.no_clearance}.": flight.no_clearance,
        "The rails come from a file: the clearance includes only those that `flight.envelope` "
        "lists.": flight.rails_listed,
        f"{counted(limit_open, 'case')} {'does' if limit_open == 1 else 'do'} not show whether the "
        "pointing limit is reached; not counted.": limit_open,
    }
    return [line for line, holds in lines.items() if holds]


def _touching(many: ManyFlights) -> str:
    share = many.touch
    if share is None:
        return ""
    ends = "" if share.low is None else f" ({percent(share.low)} to {percent(share.high)} %)"
    return f" {share.count:,} of {share.of:,} touch the platform again{ends}."
