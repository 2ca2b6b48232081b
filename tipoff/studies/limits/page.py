"""Certified tolerances on the page and for the terminal: a table beside the paper's advice, the
share of cases above a limit by tolerance, and a map of two tolerances."""

from collections.abc import Callable
from typing import Any

from tipoff.studies.limits import certificate_page
from tipoff.studies.limits.search import ALL, FOUND, LOST, NONE, SMALL
from tipoff.studies.limits.within import TOGETHER
from tipoff.studies.populations import exceedance, population
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table, estimate, span
from tipoff.workspace.words import counted

_CURVES = (
    "Share of {cases:,} cases above a limit against the tolerance, with the same draws at every "
    "tolerance. Dotted: its upper bound at {confidence:.0%} confidence; horizontal: the allowed "
    "share 1 - p. Vertical: the largest certified tolerance; dashed: the advice of the paper."
)
_MAP = (
    "Both errors vary; on an axis the other error is zero. Pairs between the line and the "
    "origin are certified. Square: the advice of the paper."
)
_TOLERANCE = (
    "A tolerance is three sigma of a normal distribution; larger values are drawn again. The "
    "direction of an error is random. One factor varies at a time, and the errors of the others "
    "are {others}. The last row scales a whole set."
)
_CERTIFIED = (
    "Certified: the upper bound of the probability that a rate is above its limit is at most "
    "{most:.4g} ({confidence:.0%} confidence; of {cases:,} cases {allowed:,} may be above)."
)
_ADVICE = (
    "The paper advises the tolerances at which rates stop growing with the error. It gives no "
    "limit and no probability."
)
_REASONS = {
    NONE: "none, a limit is exceeded even at zero",
    LOST: "none, the model error exceeds a limit",
}
_COLUMNS: tuple[tuple[str, Callable[[dict], Any]], ...] = (
    ("tolerance of", lambda row: row["words"] + _unit(row["unit"], " ({})")),
    ("largest certified", lambda row: value(row["nominal"])),
    ("the paper advises", lambda row: row["advised"] and row["advised"]["tolerance"]),
    ("limits kept there", lambda row: row["advised"] and _kept(row["advised"])),
    ("other constants", lambda row: row["constants"] and extent(row["constants"])),
    ("with model error", lambda row: row["model"] and value(row["model"])),
    ("worst constants, model error", lambda row: row["both"] and value(row["both"])),
)


def figures(found: dict) -> list[Figure]:
    """Each figure with its caption."""
    curves = Figure(_curves(found), _CURVES.format(**found))
    return [curves, Figure(_map(found), _MAP)] if found["map"] else [curves]


def draw(found: dict) -> list[Part]:
    """The section."""
    return [
        *terminal(found),
        *figures(found),
        *_beside(found),
        _ADVICE,
    ]


def terminal(found: dict) -> list[Part]:
    """The certified tolerances, also for the terminal."""
    limits = ", ".join(exceedance.Limit(**each).words for each in found["limits"])
    run = (
        f"limits: {limits}; to be kept together with probability {found['probability']:g} at "
        f"{found['confidence']:.0%} confidence; {found['cases']:,} cases"
    )
    odd = [f"{row['words']}: {line}" for row in found["rows"] for line in _odd(row)]
    lines = [run, population.model_line(found), *certificate_page.lines(found)]
    return [
        Bullets([*lines, *odd]),
        table_of(found),
        *certificate_page.tables(found["certificate"]),
    ]


def table_of(found: dict) -> Table:
    """One row for each factor, without the columns that are empty in all rows."""
    columns = [(head, [cell(row) for row in found["rows"]]) for head, cell in _COLUMNS]
    shown = [column for column in columns if any(cell is not None for cell in column[1])]
    heads, cells = zip(*shown)
    others = "as in the scene" if found["asked"]["others"] == "scene" else "zero"
    notes = (
        _TOLERANCE.format(others=others),
        _CERTIFIED.format(most=1.0 - found["probability"], **found),
        _uncertain(found),
    )
    return Table(heads, list(zip(*cells)), notes)


def _uncertain(found: dict) -> str:
    """The source of both uncertainties."""
    constants, margin = found["constants"], found["margin"]
    drawn = (
        f"the search is repeated for {counted(constants['draws'], 'draw')} of {', '.join(constants['drawn'])} "
        "from their 95 % intervals"
        if constants["draws"]
        else "not drawn, since none is fitted or has an interval"
    )
    sizes = ", ".join(f"{axis} {size:.2g}" for axis, size in (margin["deg_s"] or {}).items())
    error = f"{sizes} deg/s, " if sizes else ""
    return (
        f"Other constants: {drawn}. Model error, which reduces every limit: {error}"
        f"{margin['said']}."
    )


def _unit(unit: str, form: str = " {}") -> str:
    return "" if unit == "1" else form.format(unit)


def _kept(advised: dict) -> str:
    """Bounds of the share of cases within the limits."""
    return span(100.0 * (1.0 - advised["high"]), 100.0 * (1.0 - advised["low"]), ".4g") + " %"


def _odd(row: dict) -> list[str]:
    """Where the number of cases above a limit does not grow with the tolerance."""
    again, falls, unit = row["nominal"]["again"], row["nominal"]["falls"], _unit(row["unit"])
    sizes = ", ".join(f"{size:.3g}" for size in again)
    lines = [f"also certified beyond the first failure, not used: {sizes}{unit}"] if again else []
    ends = ", ".join(f"{one:.3g} to {two:.3g}" for one, two in falls)
    return lines + (
        [f"the number of cases above a limit falls with the tolerance from {ends}{unit}"]
        if falls
        else []
    )


def value(found: dict) -> float | str:
    """The largest certified tolerance, or the reason why there is none."""
    if found["state"] == FOUND:
        return found["tolerance"]
    if found["state"] == ALL:
        return f"all searched, up to {found['tolerance']:.3g}"
    if found["state"] == SMALL:
        return f"less than {found['fails']:.2g}"
    return _REASONS[found["state"]]


def extent(searches: list[dict]) -> str:
    """Smallest and largest of several tolerances, and how many searches found none."""
    sizes = [each["tolerance"] for each in searches if each["tolerance"] is not None]
    missing = len(searches) - len(sizes)
    none = f", none in {missing} of {len(searches)}" if missing else ""
    return (span(min(sizes), max(sizes)) if sizes else "none") + none


def _beside(found: dict) -> list[Part]:
    """Every quantity at the certified tolerances."""
    rows = [row for row in found["rows"] if row["beside"]]
    if not rows:
        return []
    quantities = [Column(item["label"], item["unit"]) for item in rows[0]["beside"]]
    body = [(row["words"], *map(estimate, row["beside"])) for row in rows]
    note = (
        f"The magnitude that {found['probability']:.4%} of the cases stay below, with its 95 % "
        "bounds."
    )
    table = Table(["at the certified tolerance of", *quantities], body, (note,), dense=True)
    return [Fold("Every quantity at the certified tolerances", [table])]


def _curves(found: dict) -> Chart:
    return Chart(
        "limits-curves", [_panel(row, found) for row in found["rows"]], columns=3, height=260
    )


def _panel(row: dict, found: dict) -> Panel:
    """Share above a limit over the tolerance. A share of zero is not drawn, since the axis is
    logarithmic; its upper bound is."""
    trials = [(size, count) for size, count in row["nominal"]["trials"] if size > 0.0]
    sizes, seen = (
        [size for size, _ in trials],
        [(size, count / found["cases"]) for size, count in trials if count > 0],
    )
    upper = [exceedance.at_most(count, found["cases"], found["confidence"]) for _, count in trials]
    ends = [min(upper + [share for _, share in seen]), 1.0]
    lines = [
        Line(
            [size for size, _ in seen],
            [share for _, share in seen],
            "share of cases above",
            NAVY,
            marker="o",
            size=5.0,
        ),
        Line(sizes, upper, "its upper bound", TEAL, dash=":"),
        Line([sizes[0], sizes[-1]], [1.0 - found["probability"]] * 2, "1 - p", GREY, 1.2, "-."),
    ]
    if row["nominal"]["tolerance"] is not None:
        lines.append(
            Line([row["nominal"]["tolerance"]] * 2, ends, "largest certified", VERMILION, 1.8)
        )
    if row["advised"] and sizes[0] <= row["advised"]["tolerance"] <= sizes[-1]:
        lines.append(
            Line([row["advised"]["tolerance"]] * 2, ends, "advised by the paper", AMBER, 1.8, "--")
        )
    title = row["words"].partition(",")[0]
    unit = "times the set" if row["name"] == TOGETHER else row["unit"].replace("1", "dimensionless")
    return Panel(title, f"tolerance ({unit})", "share above a limit", lines, log=True)


def _map(found: dict) -> Chart:
    shown = found["map"]
    x, y = zip(*(point["tolerances"] for point in shown["points"]))
    lines = [
        Line(
            x,
            y,
            f"largest certified pairs, p = {found['probability']:g}",
            NAVY,
            1.8,
            marker="o",
            size=7.0,
        ),
        Line(
            [shown["advised"][0]],
            [shown["advised"][1]],
            "advised by the paper",
            VERMILION,
            dash="",
            marker="s",
            size=10.0,
        ),
    ]
    x_label, y_label = (
        f"tolerance of {name} ({unit})" for name, unit in zip(shown["words"], shown["units"])
    )
    return Chart("limits-map", [Panel("", x_label, y_label, lines)], height=380)
