"""Certified tolerances on the page: a table beside the paper's advice, how often limits are missed
by tolerance, a map of two."""

from tipoff.studies.limits.search import ALL, FOUND, NONE, SMALL
from tipoff.studies.populations import exceedance, population
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
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.table import Column, Table, estimate, span

_CURVES = (
    "Share of {cases:,} cases above a limit over the tolerance, the same draws at every tolerance. "
    "Dotted: its upper bound "
    "at {confidence:.0%} confidence, which may not be above the horizontal line, 1 - p. Vertical: "
    "the largest certified "
    "tolerance; dashed, what the paper advises."
)
_MAP = (
    "Both errors vary, and on an axis the other one is zero: certified pairs lie on the side of "
    "the origin. The square is what "
    "the paper advises."
)
_TABLE = (
    "A tolerance is three sigma of a normal distribution, redrawn beyond it; errors point anywhere "
    "around the axis. One "
    "factor varies at a time, and the errors of the others are {others}; the last row scales a "
    "whole set. Certified: the "
    "upper bound of the probability that any rate is above its limit is at most {most:.4g} "
    "({confidence:.0%} confidence, "
    "{cases:,} cases, of which {allowed:,} may be above). {uncertain}"
)
_ADVICE = (
    "The paper advises its tolerances where rates stop rising with the error; it names no "
    "limit and no probability."
)


def charts(found: dict) -> list[tuple[Chart, str]]:
    """Each figure with its caption."""
    return [(_curves(found), _CURVES.format(**found))] + (
        [(_map(found), _MAP)] if found["map"] else []
    )


def draw(found: dict) -> list[Part]:
    """What stands in the section."""
    others = "as the scene has them" if found["asked"]["others"] == "scene" else "zero"
    words = _TABLE.format(
        others=others,
        most=1.0 - found["probability"],
        uncertain=_uncertain(found),
        **{name: found[name] for name in ("confidence", "cases", "allowed")},
    )
    odd = [f"{row['words']}: {line}" for row in found["rows"] for line in _odd(row, _unit(row))]
    return [
        Bullets([*found["summary"][:2], *odd]),
        _table(found, words),
        *(Figure(*each) for each in charts(found)),
        *_beside(found),
        _ADVICE,
    ]


def _uncertain(found: dict) -> str:
    """Where both uncertainties come from, in words."""
    count, names, margin = (
        found["constants"]["draws"],
        ", ".join(found["constants"]["drawn"]),
        found["margin"],
    )
    constants = (
        f"the search repeated for {count} draws of {names} from their 95 % intervals"
        if count
        else "none is fitted, or none has an interval"
    )
    sizes = ", ".join(f"{axis} {size:.2g}" for axis, size in (margin["deg_s"] or {}).items())
    off = f", {sizes} deg/s" if sizes else ""
    return (
        f"Constants: {constants}. Model: the settled error of the surrogate taken off every "
        f"limit{off} ({margin['said']})."
    )


def summary(found: dict) -> list[str]:
    """What the study says, one line each."""
    text = [
        f"limits: {', '.join(found['limits_said'])}; each case within all of them with probability "
        f"{found['probability']:g}, "
        f"shown at {found['confidence']:.0%} confidence by {found['cases']:,} cases"
    ]
    return [*text, population.model_line(found)] + [_line(row, _unit(row)) for row in found["rows"]]


def _unit(row: dict) -> str:
    return "" if row["unit"] == "1" else f" {row['unit']}"


def _line(row: dict, unit: str) -> str:
    parts = [f"{row['words']}: {value(row['nominal'], unit)}"]
    if row["constants"]:
        parts.append(f"with other constants {extent(row['constants'])}{unit}")
    for key, words in (("model", "with the model's error"), ("both", "with both")):
        parts += [f"{words} {value(row[key], unit)}"] if row[key] else []
    if advised := row["advised"]:
        parts.append(
            f"{advised['share']:.2%} above at the advised {advised['tolerance']:.3g}{unit}"
        )
    return "; ".join(parts + _odd(row, unit))


def _odd(row: dict, unit: str) -> list[str]:
    """Where the count of cases above does not grow with the tolerance, in words."""
    again, falls = row["nominal"]["again"], row["nominal"]["falls"]
    sizes = ", ".join(f"{size:.3g}" for size in again)
    text = [f"certified again beyond a failure, which is not used: {sizes}{unit}"] if again else []
    ends = " and from ".join(f"{one:.3g} to {two:.3g}" for one, two in falls)
    return text + ([f"fewer cases above, not more, from {ends}{unit}"] if falls else [])


def value(answer: dict, unit: str = "") -> str:
    """An answer in words."""
    if answer["state"] == FOUND:
        return f"{answer['tolerance']:.3g}{unit}"
    if answer["state"] == ALL:
        return f"every one searched, up to {answer['tolerance']:.3g}{unit}"
    if answer["state"] == SMALL:
        return f"none of {answer['fails']:.2g}{unit} or more"
    why = (
        "what is not varied is above a limit"
        if answer["state"] == NONE
        else "the model's error leaves nothing of a limit"
    )
    return f"no tolerance is small enough, for {why}"


def extent(answers: list[dict]) -> str:
    """Smallest and largest of several answers."""
    known = [answer["tolerance"] for answer in answers if answer["tolerance"] is not None]
    lost = (
        f", none in {len(answers) - len(known)} of {len(answers)}"
        if len(known) < len(answers)
        else ""
    )
    return (f"{min(known):.3g} to {max(known):.3g}" if known else "none") + lost


def _table(found: dict, words: str) -> Table:
    heads = (
        "tolerance of",
        "unit",
        "the paper advises",
        "there limits are kept in",
        "largest certified",
        "with other constants",
        "with the model's error",
        "with the worst constants and the error",
    )
    rows = []
    for row in found["rows"]:
        advised, kept = row["advised"], ""
        if advised:
            kept = span(100.0 * (1.0 - advised["high"]), 100.0 * (1.0 - advised["low"]), ".4g")
        rows.append(
            (
                row["words"],
                "" if row["unit"] == "1" else row["unit"],
                advised["tolerance"] if advised else "",
                f"{kept} %" if kept else "",
                value(row["nominal"]),
                extent(row["constants"]) if row["constants"] else "",
                *(value(row[key]) if row[key] else "" for key in ("model", "both")),
            )
        )
    return Table(heads, rows, (words,))


def _beside(found: dict) -> list[Part]:
    """Every quantity at the certified tolerances."""
    rows = [row for row in found["rows"] if row["beside"]]
    if not rows:
        return []
    quantities = [Column(item["label"], item["unit"]) for item in rows[0]["beside"]]
    body = [(row["words"], *map(estimate, row["beside"])) for row in rows]
    note = (
        f"What each stays below in magnitude in {found['probability']:.4%} of the cases; small: "
        "95 % bounds."
    )
    table = Table(["at the certified tolerance of", *quantities], body, (note,), dense=True)
    return [Fold("every quantity at the certified tolerances", [table])]


def _curves(found: dict) -> Chart:
    return Chart(
        "limits-curves", [_panel(row, found) for row in found["rows"]], columns=3, height=260
    )


def _panel(row: dict, found: dict) -> Panel:
    """Share above a limit over the tolerance; none above has no place on a logarithmic axis, but
    its bound has."""
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
    title, _, more = row["words"].partition(",")
    unit = (
        row["unit"] if row["unit"] != "1" else "of the set" if more == " times" else "dimensionless"
    )
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
    across, upwards = (
        f"tolerance of {words} ({unit})" for words, unit in zip(shown["words"], shown["units"])
    )
    return Chart("limits-map", [Panel("", across, upwards, lines)], height=380)
