"""Certified tolerances on the page: a table beside the paper's advice, how often limits are missed by tolerance, and a map of two."""

from html import escape

from studies import exceedance
from studies.report.chart import AMBER, GREY, NAVY, TEAL, VERMILION, Chart, Line, Panel
from studies.report.markup import Html, caption, fold, number, paragraph, table
from studies.report.montecarlo import bounded
from studies.tolerance_search import ALL, FOUND, NONE, SMALL


def charts(found: dict) -> list[tuple[Chart, str]]:
    """Each figure with its caption."""
    made = [(_curves(found), f"Share of {found['cases']:,} cases above a limit over the tolerance, the same draws at every tolerance. Dotted: "
             f"its upper bound at {found['confidence']:.0%} confidence, which the horizontal line, 1 - p, must not be below. Vertical: the largest "
             "certified tolerance; dashed, what the paper advises.")]
    if found["map"]:
        made.append((_map(found), "Certified pairs lie on the side of the origin. The square is what the paper advises."))
    return made


def draw(found: dict, figure) -> Html:
    """What stands in the section."""
    drawn = [figure(chart, words) for chart, words in charts(found)]
    said = "".join(f"<li>{escape(line[0].upper() + line[1:])}.</li>" for line in found["summary"])
    others = "as the scene has them" if found["asked"]["others"] == "scene" else "zero"
    return Html("".join([
        Html(f"<ul>{said}</ul>"), _table(found), caption(
            f"A tolerance is three sigma of a normal distribution, redrawn beyond it; errors point anywhere around the axis. One factor varies at a "
            f"time, and the errors of the others are {others}; the last row scales a whole set. Certified: the upper bound of the probability that "
            f"any rate is above its limit is at most {1.0 - found['probability']:.4g} ({found['confidence']:.0%} confidence, {found['cases']:,} cases, "
            f"of which {found['allowed']:,} may be above). {_uncertain(found)}"),
        *drawn, _beside(found), paragraph("The paper advises its tolerances where rates stop rising with the error; it names no limit and no probability.")]))


def _uncertain(found: dict) -> str:
    """Where both uncertainties come from, in words."""
    count, names = found["constants"]["draws"], ", ".join(found["constants"]["drawn"])
    constants = f"Constants: the search repeated for {count} draws of {names} from their 95 % intervals." if count else (
        "Constants: none is fitted, or none has an interval.")
    margin = found["margin"]
    off = "" if margin["deg_s"] is None else " " + ", ".join(f"{axis} {value:.2g}" for axis, value in margin["deg_s"].items()) + " deg/s"
    return f"{constants} Model: the settled error of the surrogate taken off every limit,{off} ({margin['said']})."


def summary(found: dict) -> list[str]:
    """What the study says, one line each."""
    said = [f"limits: {', '.join(found['limits_said'])}; each case within all of them with probability {found['probability']:g}, shown at "
            f"{found['confidence']:.0%} confidence by {found['cases']:,} cases on {found['surrogate']}"]
    for row in found["rows"]:
        unit = "" if row["unit"] == "1" else f" {row['unit']}"
        line = f"{row['words']}: {value(row['nominal'], row['most'], unit)}"
        if row["constants"]:
            line += f"; with other constants {spread(row['constants'], row['most'])}{unit}"
        if row["model"]:
            line += f"; with the model's error {value(row['model'], row['most'], unit)}"
        if row["both"]:
            line += f"; with both {value(row['both'], row['most'], unit)}"
        if advised := row["advised"]:
            line += f". At {advised['tolerance']:.3g}{unit}: {advised['share']:.2%} above"
        if again := row["nominal"]["again"]:
            line += f". Certified again beyond a failure, which is not used: {', '.join(f'{size:.3g}' for size in again)}{unit}"
        said.append(line)
    return said


def value(answer: dict, most: float, unit: str = "") -> str:
    """An answer in words."""
    return {FOUND: lambda: f"{answer['tolerance']:.3g}{unit}", ALL: lambda: f"every one searched, up to {answer['tolerance']:.3g}{unit}",
            SMALL: lambda: f"none of {answer['fails']:.2g}{unit} or more",
            NONE: lambda: "no tolerance is small enough, for what is not varied is above a limit"}[answer["state"]]()


def spread(answers: list[dict], most: float) -> str:
    """Smallest and largest of several answers."""
    known = [answer["tolerance"] for answer in answers if answer["tolerance"] is not None]
    lost = f", none in {len(answers) - len(known)} of {len(answers)}" if len(known) < len(answers) else ""
    return (f"{min(known):.3g} to {max(known):.3g}" if known else "none") + lost


def _table(found: dict) -> Html:
    rows = []
    for row in found["rows"]:
        advised = row["advised"]
        kept = advised and f"{100.0 * (1.0 - advised['high']):.4g} to {100.0 * (1.0 - advised['low']):.4g} %"
        rows.append((row["words"], "" if row["unit"] == "1" else row["unit"], number(advised["tolerance"]) if advised else "", kept or "",
                     value(row["nominal"], row["most"]), spread(row["constants"], row["most"]) if row["constants"] else "",
                     value(row["model"], row["most"]) if row["model"] else "", value(row["both"], row["most"]) if row["both"] else ""))
    return table(("tolerance of", "unit", "the paper advises", "there limits are kept in", "largest certified", "with other constants",
                  "with the model's error", "with the worst constants and the error"), rows)


def _beside(found: dict) -> Html:
    """Every quantity at the certified tolerances."""
    rows = [row for row in found["rows"] if row["beside"]]
    if not rows:
        return Html("")
    heads = ("at the certified tolerance of", *(f"{item['label']} ({item['unit']})" for item in rows[0]["beside"]), "outside the calibration")
    body = [(row["words"], *(bounded(item) for item in row["beside"]), f"{row['outside']:,} cases") for row in rows]
    return fold("every quantity at the certified tolerances", table(heads, body, dense=True) + caption(
        f"What each stays below in magnitude in {100.0 * found['probability']:g} % of the cases; small: 95 % bounds."))


def _curves(found: dict) -> Chart:
    panels = []
    for row in found["rows"]:
        unit = row["unit"] if row["unit"] != "1" else "of the set" if row["name"] == "together" else "dimensionless"
        trials = [(size, count) for size, count in row["nominal"]["trials"] if size > 0.0]
        sizes, shares = [size for size, _ in trials], [count / found["cases"] for _, count in trials]
        upper = [exceedance.at_most(count, found["cases"], found["confidence"]) for _, count in trials]
        seen = [(size, share) for size, share in zip(sizes, shares) if share > 0.0]  # none above has no place on a logarithmic axis
        lines = [Line([size for size, _ in seen], [share for _, share in seen], "share of cases above", NAVY, 1.6, marker="o", size=5.0),
                 Line(sizes, upper, "its upper bound", TEAL, 1.6, ":"),
                 Line([sizes[0], sizes[-1]], [1.0 - found["probability"]] * 2, "1 - p", GREY, 1.2, "-.")]
        ends = [min(upper + [share for _, share in seen]), 1.0]
        if row["nominal"]["tolerance"] is not None:
            lines.append(Line([row["nominal"]["tolerance"]] * 2, ends, "largest certified", VERMILION, 1.8))
        if row["advised"] and sizes[0] <= row["advised"]["tolerance"] <= sizes[-1]:
            lines.append(Line([row["advised"]["tolerance"]] * 2, ends, "advised by the paper", AMBER, 1.8, "--"))
        panels.append(Panel(row["words"].partition(",")[0], f"tolerance ({unit})", "share above a limit", lines, log=True))
    return Chart("limits-curves", panels, columns=3, height=260)


def _map(found: dict) -> Chart:
    shown = found["map"]
    x, y = zip(*(point["scale"] for point in shown["points"]))
    lines = [Line(x, y, f"largest certified pairs, p = {found['probability']:g}", NAVY, 1.8, marker="o", size=7.0),
             Line([shown["advised"][0]], [shown["advised"][1]], "advised by the paper", VERMILION, dash="", marker="s", size=10.0)]
    labels = [f"tolerance of {words} ({unit})" for words, unit in zip(shown["words"], shown["units"])]
    return Chart("limits-map", [Panel("", *labels, lines)], height=380)
