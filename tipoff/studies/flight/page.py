"""The flight as the page shows it: paths, axes, clearance and the scatter about the target, then
tables of conditions and cases."""

import math
from collections.abc import Callable, Iterable

from tipoff.studies.flight.summary import WORDS, doubts
from tipoff.studies.populations import answers
from tipoff.studies.render.chart import (
    AMBER,
    GREY,
    NAVY,
    TEAL,
    VERMILION,
    Chart,
    Line,
    Panel,
)
from tipoff.studies.render.document import Figure, Part
from tipoff.studies.render.table import Column, Table, estimate, percent, span

_LOOKS = (
    (NAVY, "-", "o"),
    (VERMILION, "--", "s"),
    (AMBER, "-.", "^"),
    (TEAL, ":", "D"),
    (GREY, "-", "v"),
)
_SHOWN = (
    "miss_m",
    "tip_off_miss_m",
    "passes_s",
    "pointing_deg",
    "limit_s",
    "coning_deg_s",
    "nutation_s",
    "clearance_mm",
    "closest_ms",
)
_PATHS = (
    "Left and middle: the way to the target in orbit axes, sideways and up being the scene's y and "
    "z. The bend that all "
    "shots have in common is the orbit's. Right: relative to the platform; at this scale the "
    "conditions can hardly be told "
    "apart."
)
_AXES = (
    "Left: the cone of the payload's x axis in inertial space, one round about its angular "
    "momentum, free rotation of the "
    "whole inertia tensor; distance from the middle is the angle from the launch axis, the marker "
    "the instant of passing the "
    "target. Right: that angle until the target is passed."
)
_CLEARANCE = (
    "Least distance between the payload's box and the boxes of platform and rails after "
    "exit; below zero they overlap."
)
_SCATTER = (
    "Left: where cases pass the plane through the target. A shot without errors misses too, by "
    "what the orbit bends its "
    "way. Right: share of cases that miss by more, in all and by their errors alone, with bounds "
    "of the quantiles."
)
_EXITS = (
    "What every condition leaves its rail with and the flight begins from: settled rates in "
    "payload body axes and velocity "
    "across the launch axis, attitude as a rotation vector."
)
_BOXES = (
    "Clearance below zero is depth of overlap: the boxes are the scene's, rigid and undeformed. A "
    "body that stood back "
    "from its pads by as much would pass clear; flight.body says how large it is without them."
)


def draw(found: dict) -> list[Part]:
    """The section."""
    return [
        _words(found),
        *(Figure(*item) for item in charts(found)),
        _exits(found["conditions"]),
        _conditions(found),
        _cases(found["cases"]),
    ]


def _exits(conditions: list[dict]) -> Table:
    """What every condition leaves its rail with, to four digits: rates of a thousandth of a degree
    are compared here."""
    return Table(
        ["condition", *(Column(WORDS[item.name], form=".4g") for item in answers.ALL)],
        [_of(row, [item.name for item in answers.ALL]) for row in conditions],
        (_EXITS,),
        dense=True,
    )


def _conditions(found: dict) -> Table:
    rows = [
        (*_of(row, _SHOWN), _cone(row["flown"]) if row["flown"] else None)
        for row in found["conditions"]
    ]
    notes = [_BOXES] * (not found["flight"]["no_clearance"]) + [doubts(found)]
    return Table(
        ["condition", *(WORDS[name] for name in _SHOWN), "x axis from angular momentum (deg)"],
        rows,
        tuple(note for note in notes if note),
        dense=True,
    )


def _of(row: dict, names: Iterable[str]) -> tuple:
    return row["condition"], *(row["flown"][name] if row["flown"] else None for name in names)


def _cone(flown: dict) -> str:
    return span(flown["cone_least_deg"], flown["cone_largest_deg"])


def _cases(many: dict) -> Table:
    judged = many["quantiles"]
    shares = [row["share"] for row in next(iter(judged.values()), [])]
    note = (
        f"{many['counts']['asked']:,} cases, {many['settled']:,} of them flown. Share of cases "
        f"below the value; small: its bounds at {many['confidence']:.0%} confidence "
        f"({many['bounds']}). {_touching(many)}"
    )
    rows = [
        (WORDS[name], *("never" if row["value"] is None else estimate(row) for row in quantiles))
        for name, quantiles in judged.items()
    ]
    heads = ["quantity", *(f"{percent(share, '.4g')} %" for share in shares)]
    return Table(heads, rows, (note,), dense=True)


def charts(found: dict) -> list[tuple[Chart, str]]:
    """Charts with their captions."""
    curves, flight = found["curves"], found["flight"]
    drawn = [(_paths(curves, flight), _PATHS), (_axes(curves), _AXES)]
    if any(curve.get("clearance_s") for curve in curves):
        drawn.append((_clearance(curves), _CLEARANCE))
    if found["cases"]["points_m"]:
        drawn.append((_scatter(found), _SCATTER))
    return drawn


def _lines(curves: list[dict], x: Callable[[dict], list], y: Callable[[dict], list]) -> list[Line]:
    return [
        Line(x(curve), y(curve), curve["condition"], colour, 1.8, dash)
        for curve, (colour, dash, _) in zip(curves, _LOOKS)
    ]


def _paths(curves: list[dict], flight: dict) -> Chart:
    def column(key: str, index: int, scale: float = 1.0) -> Callable[[dict], list]:
        return lambda curve: [scale * row[index] for row in curve[key]]

    target = Line([flight["range_m"]], [0.0], "target", "#000000", 1.0, "", marker="D")
    platform = Line([0.0], [0.0], "platform", "#000000", 1.0, "", marker="s")
    along = "along the launch axis (m)"
    return Chart(
        "flight-path",
        [
            Panel(
                "to the target, sideways",
                along,
                "y (m)",
                [*_lines(curves, column("to_target_m", 0), column("to_target_m", 1)), target],
            ),
            Panel(
                "to the target, up",
                along,
                "z (m)",
                [*_lines(curves, column("to_target_m", 0), column("to_target_m", 2)), target],
            ),
            Panel(
                f"{flight['duration_s'] / 60.0:.3g} min, from the platform",
                "along the orbit (km)",
                "radially outwards (km)",
                [*_lines(curves, column("orbit_m", 1, 1e-3), column("orbit_m", 0, 1e-3)), platform],
            ),
        ],
        columns=3,
        height=320,
    )


def _axes(curves: list[dict]) -> Chart:
    ends = [curve["axis_at_target_deg"] for curve in curves]
    passed = [
        Line([end[0]], [end[1]], curve["condition"], colour, 1.0, "", marker=marker, legend=False)
        for curve, end, (colour, _, marker) in zip(curves, ends, _LOOKS)
    ]
    around = _lines(
        curves,
        lambda curve: [end[0] for end in curve["axis_deg"]],
        lambda curve: [end[1] for end in curve["axis_deg"]],
    )
    angle = _lines(curves, lambda curve: curve["time_s"], lambda curve: curve["pointing_deg"])
    return Chart(
        "flight-axis",
        [
            Panel("cone of the x axis", "towards y (deg)", "towards z (deg)", [*around, *passed]),
            Panel("pointing error", "time after exit (s)", "angle (deg)", angle),
        ],
        columns=2,
        height=360,
    )


def _clearance(curves: list[dict]) -> Chart:
    lines = _lines(
        [curve for curve in curves if curve.get("clearance_s")],
        lambda c: [1e3 * time for time in c["clearance_s"]],
        lambda c: [1e3 * gap for gap in c["clearance_m"]],
    )
    ends = (min(line.x[0] for line in lines), max(line.x[-1] for line in lines))
    return Chart(
        "flight-clearance",
        [
            Panel(
                "",
                "time after exit (ms)",
                "clearance (mm)",
                [*lines, Line(ends, (0.0, 0.0), "touch", "#000000", 1.0, ":")],
            )
        ],
        height=300,
    )


def _scatter(found: dict) -> Chart:
    many = found["cases"]
    y, z, orbital_y, orbital_z = zip(*many["points_m"])
    errors = [math.hypot(a - c, b - d) for a, b, c, d in many["points_m"]]
    shares = [
        *_exceeded(many, "miss_m", list(map(math.hypot, y, z)), "in all", NAVY, "-"),
        *_exceeded(many, "tip_off_miss_m", errors, "by errors alone", AMBER, "--"),
    ]
    marks = [
        Line(y, z, "case", NAVY, 1.0, "", 0.35, marker="o", size=3.0),
        Line(orbital_y[:1], orbital_z[:1], "without errors", VERMILION, 1.0, "", marker="o"),
        Line([0.0], [0.0], "target", "#000000", 1.0, "", marker="D"),
    ]
    return Chart(
        "flight-miss",
        [
            Panel(
                f"{len(y):,} of {many['settled']:,} cases in the plane of the target",
                "y (m)",
                "z (m)",
                marks,
            ),
            Panel("cases that miss by more", "miss (m)", "share (%)", shares),
        ],
        columns=2,
        height=360,
    )


def _exceeded(
    many: dict, name: str, values: list[float], words: str, colour: str, dash: str
) -> list[Line]:
    """Share of cases above each value, and bounds of the quantiles."""
    above = [100.0 * (1.0 - (index + 1) / len(values)) for index in range(len(values))]
    rows = [row for row in many["quantiles"].get(name, []) if None not in (row["low"], row["high"])]
    bounds = [
        Line(
            [row["low"], row["high"]],
            [100.0 * (1.0 - row["share"])] * 2,
            "bounds",
            VERMILION,
            2.5,
            "-",
            marker="D",
            size=5.0,
        )
        for row in rows
    ]
    return [Line(sorted(values), above, words, colour, 2.0, dash), *bounds]


def _words(found: dict) -> str:
    flight = found["flight"]
    limit = (
        ""
        if flight["pointing_limit_deg"] is None
        else f" The pointing limit is {flight['pointing_limit_deg']:g} deg."
    )
    return (
        f"A target {flight['range_m']:g} m along the launch axis, at rest beside a circular orbit "
        f"of "
        f"{flight['period_s'] / 60.0:.4g} min; model {found['model']}. Nothing acts after the exit "
        f"but gravity.{limit}"
    )


def _touching(many: dict) -> str:
    share = many["touch"]
    if share is None:
        return ""
    ends = (
        ""
        if share["low"] is None
        else f" ({100.0 * share['low']:.3g} to {100.0 * share['high']:.3g} %)"
    )
    return f"{share['count']:,} of {share['of']:,} touch the platform again{ends}."
