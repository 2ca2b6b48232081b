"""Drop tests on the page: filtered rates with what was found in them, the budget, and the tests in
the simulated cloud."""

from collections.abc import Callable

import numpy as np

from tipoff.studies.droptest import judgement
from tipoff.studies.droptest.results import MAGNITUDES, PAIRS
from tipoff.studies.populations import answers, spread
from tipoff.studies.render.chart import (
    AMBER,
    AXIS_COLOURS,
    GREY,
    NAVY,
    TEAL,
    VERMILION,
    Chart,
    Line,
    Panel,
)
from tipoff.studies.render.document import Figure, Fold, Notice, Part
from tipoff.studies.render.table import Column, Table, estimate, percent

_DASHES = {"x": "-", "y": "--", "z": "-."}
_LOOKS = ((VERMILION, "s"), (TEAL, "^"), (AMBER, "D"), (NAVY, "v"))
_RATES = (
    "Rates in payload body axes, filtered forward and backward with the channel frequency class of "
    "each log. Shaded: the "
    "window at rest before release, the reference window in free fall and the settled window after "
    "exit; dotted uprights: "
    "release and ignition. Right: the same around ignition."
)
_CLOUD = (
    "Change of rate by ejection. Dots: simulated cases{shown}, which start at rest, with errors of "
    "{vary}. Closed curve: the "
    "region that holds the next case with {share:g} % probability, an ellipse whose size comes "
    "from ranks and whose shape "
    "need not be that of the cloud. Symbols: the tests, with bars of 95 % where these are wider "
    "than the symbol. Last: "
    "magnitudes, which need no angle about X."
)
_SIMULATED = (
    "SIMULATED logs, made by a sensor model: they show that the reduction works, and say nothing "
    "of a launcher."
)


def draw(found: dict) -> list[Part]:
    """Everything in the section."""
    rates, cloud = charts(found)
    verdict = [line.split(None, 1)[1] for line in found["summary"][-3:]]
    shown, settled = len(found["cases"]["shown_deg_s"]), found["cases"]["settled"]
    words = _CLOUD.format(
        share=100.0 * found["regions"][0]["share"],
        shown="" if shown == settled else f", the first {shown:,} of {settled:,}",
        vary=found["request"]["vary"],
    )
    simulated = any(row["simulated"] for row in found["tests"])
    return [
        *([Notice(_SIMULATED)] if simulated else []),
        Figure(rates, _RATES),
        _changes(found["tests"]),
        Figure(cloud, words),
        *(f"{line[0].upper()}{line[1:]}." for line in verdict),
        _standing(found),
        _cases(found["cases"]),
        _power(found["power"]),
        _budgets(found["tests"]),
        *_notes(found["tests"]),
    ]


def charts(found: dict) -> tuple[Chart, Chart]:
    """Filtered rates of every test; the simulated cloud with the tests in it."""
    panels = [panel for row in found["tests"] for panel in _rates(row)]
    return Chart("droptest-rates", panels, columns=2, height=250), Chart(
        "droptest-cloud", _clouds(found), columns=2, height=380
    )


def _rates(row: dict) -> list[Panel]:
    ignition = row["ignition_s"]
    time, rate = np.array(row["curve"]["time_s"]), np.array(row["curve"]["rate_deg_s"])
    windows = [(begin - ignition, end - ignition) for begin, end in row["windows_s"].values()]
    title = (
        f"{row['test']}{', SIMULATED' if row['simulated'] else ''}; grey: rest, reference, settled"
    )
    panels = []
    for words, factor, unit, begin, end in (
        (title, 1.0, "s", time[0], time[-1]),
        (f"{row['test']}, around ignition", 1e3, "ms", -0.1, 0.16),
    ):
        near = (time >= begin) & (time <= end)
        low, high = rate[near].min(), rate[near].max()
        lines = [
            Line(
                factor * time[near],
                rate[near, place],
                f"rate about {axis.upper()}",
                colour,
                1.4,
                _DASHES[axis],
            )
            for place, (axis, colour) in enumerate(AXIS_COLOURS.items())
        ]
        lines += [
            Line([factor * at] * 2, [low, high], "release, ignition", GREY, 1.6, ":")
            for at in (row["release_s"] - ignition, 0.0)
            if begin <= at <= end
        ]
        spans = tuple(
            (factor * max(a, begin), factor * min(b, end))
            for a, b in windows
            if b > begin and a < end
        )
        panels.append(
            Panel(words, f"time after ignition ({unit})", "rate (deg/s)", lines, spans=spans)
        )
    return panels


def _clouds(found: dict) -> list[Panel]:
    cases = np.array(found["cases"]["shown_deg_s"])
    panels = []
    for pair, region in zip(PAIRS, found["regions"]):
        first, second = (f"rate about {axis.upper()} (deg/s)" for axis in region["components"])
        lines = [_dots(cases[:, pair])]
        if region["squared_radius"] is not None:
            edge = judgement.outline(
                np.array(region["centre_deg_s"]),
                np.array(region["covariance"]),
                region["squared_radius"],
            )
            words = f"{100.0 * region['share']:g} % prediction region"
            lines.append(Line(edge[:, 0], edge[:, 1], words, NAVY, 1.8))
        panels.append(
            Panel(
                "",
                first,
                second,
                lines
                + _tests(
                    found,
                    lambda row, pair=pair: (
                        np.array(row["change_deg_s"])[list(pair)],
                        np.array(row["expanded_uncertainty_deg_s"])[list(pair)],
                    ),
                ),
            )
        )
    sizes = judgement.magnitudes(cases)[:, :2]
    marks = _tests(
        found,
        lambda row: (
            np.array([row["magnitudes"][name]["value_deg_s"] for name in MAGNITUDES[:2]]),
            np.zeros(2),
        ),
    )
    return [
        *panels,
        Panel("", "|rate about X| (deg/s)", "rate across X (deg/s)", [_dots(sizes), *marks]),
    ]


def _dots(points: np.ndarray) -> Line:
    return Line(
        points[:, 0],
        points[:, 1],
        "simulated cases",
        GREY,
        dash="",
        marker="o",
        size=3.0,
        opacity=0.45,
    )


def _tests(found: dict, of: Callable) -> list[Line]:
    lines = []
    for number_, row in enumerate(found["tests"]):
        colour, marker = _LOOKS[number_ % len(_LOOKS)]
        (x, y), (dx, dy) = of(row)
        lines += [
            Line(*bar, "", colour, 1.6, legend=False)
            for bar in (([x - dx, x + dx], [y, y]), ([x, x], [y - dy, y + dy]))
        ]
        name = f"{row['test']}{' (SIMULATED)' if row['simulated'] else ''}"
        lines.append(Line([x], [y], name, colour, dash="", marker=marker, size=10.0))
    return lines


def _changes(tests: list[dict]) -> Table:
    heads: tuple[Column | str, ...] = (
        "test",
        Column("release", "s", ".4f"),
        Column("ignition", "s", ".4f"),
        Column("rest, largest", "deg/s", ".2g"),
        "settling rule",
        *(Column(f"change {axis}", "deg/s") for axis in "xyz"),
    )
    rows = [
        (
            row["test"],
            row["release_s"],
            row["ignition_s"],
            row["rest_deg_s"],
            f"{'kept' if row['rest_kept'] else 'broken'} ({row['rest_limit_deg_s']:g} deg/s)",
            *(
                f"{value:+.3f} ± {uncertainty:.3f}"
                for value, uncertainty in zip(
                    row["change_deg_s"], row["expanded_uncertainty_deg_s"]
                )
            ),
        )
        for row in tests
    ]
    note = "Settled rate less the rate before ignition, with expanded uncertainties (95 %)."
    return Table(heads, rows, (note,))


def _standing(found: dict) -> Table:
    heads: tuple[Column | str, ...] = (
        "test",
        "x, percentile (p)",
        "y",
        "z",
        Column("distance of all three, p", form=".3f"),
        *MAGNITUDES,
    )
    rows = [
        (
            row["test"],
            *map(_place, row["percentile"], row["p"]),
            row["p_distance"],
            *(_place(item["percentile"], item["p"]) for item in row["magnitudes"].values()),
        )
        for row in found["tests"]
    ]
    note = (
        "Percentiles among simulated cases that carry the same errors of measurement, and p by "
        f"rank, (r + 1)/(N + 1): no smaller than {found['together']['smallest_p']:.2g}. Two-sided "
        "but for the Mahalanobis distance."
    )
    return Table(heads, rows, (note,))


def _place(share: float, p: float) -> str:
    return f"{100.0 * share:.1f} ({p:.3f})"


def _cases(cases: dict) -> Table:
    shares = [row["share"] for row in cases["quantiles"][answers.TOTAL_RATE.name]]
    rows = [
        (f"{item.label} ({item.unit})", *map(estimate, cases["quantiles"][item.name]))
        for item in answers.ALL
    ]
    note = (
        f"What {cases['settled']:,} simulated cases leave their rail with, beside the rates that a "
        "log tells: share of cases below the value; small: its bounds at "
        f"{spread.CONFIDENCE:.0%} confidence where the cases are independent and enough."
    )
    heads = ["simulated cases", *(f"{percent(share, '.4g')} %" for share in shares)]
    return Table(heads, rows, (note,), dense=True)


def _power(power: list[dict]) -> Table:
    columns = {
        "passes_one_axis": "tests inside the range, one axis",
        "passes_three_axes": "three axes",
        "passes_in_cloud": "in this cloud",
        "flagged_by_spread": "flagged by the spread",
        "flagged_in_cloud": "in this cloud",
    }
    heads: tuple[Column | str, ...] = (
        "model's spread over the truth's",
        *(Column(title, "%", ".2f", 100.0) for title in columns.values()),
    )
    rows = [(row["factor"], *(row[name] for name in columns)) for row in power]
    note = (
        "How often so many tests pass if asked to lie inside the range of so many cases, and how "
        "often a two-sided 5 % test of their spread objects. The row of 1 is exact for any "
        "distribution, the others are for a normal one (Monte Carlo over the range); in this "
        "cloud: for a truth that is the simulated cloud, shrunk or blown up about its mean."
    )
    return Table(heads, rows, (note,))


def _budgets(tests: list[dict]) -> Fold:
    names = list(tests[0]["budget_deg_s"])
    rows = [
        (
            row["test"],
            axis,
            *(row["budget_deg_s"][name][place] for name in names),
            row["standard_uncertainty_deg_s"][place],
            row["coverage_factor"][place],
        )
        for row in tests
        for place, axis in enumerate("xyz")
    ]
    parts = [Column(name, form=".2g") for name in (*names, "combined")]
    table = Table(["test", "axis", *parts, Column("k", form=".2f")], rows, dense=True)
    return Fold("budget of uncertainty, standard uncertainties in deg/s", [table])


def _notes(tests: list[dict]) -> list[Part]:
    rows = [(row["test"], words) for row in tests for words in row["notes"]]
    return [Table(["test", "what was repaired, left out or doubtful"], rows)] if rows else []
