"""Drop tests on the page and in the terminal: filtered rates, their change with uncertainty, and
the tests among the simulated cases."""

from collections.abc import Callable

import numpy as np

from tipoff.studies.droptest import judgement, power
from tipoff.studies.droptest.results import MAGNITUDES, PAIRS
from tipoff.studies.populations import answers, population, spread
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Fold, Notice, Part
from tipoff.studies.render.palette import AMBER, AXIS_COLOURS, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Noted, Table, estimate, percent

_DASHES = {"x": "-", "y": "--", "z": "-."}
_LOOKS = ((VERMILION, "s"), (TEAL, "^"), (AMBER, "D"), (NAVY, "v"))
_RATES = (
    "Rates in payload body axes after the filter of the channel frequency class. Shaded: window at "
    "rest, reference window in free fall, settled window after the exit; dotted: release and "
    "ignition. Right: the same around ignition."
)
_CLOUD = (
    "Change of rate by the ejection. Dots: simulated cases{shown} with errors of {vary}; curve: "
    "region that contains the next case with {share:g} % probability; symbols: tests with 95 % "
    "bars. Last panel: magnitudes, which do not depend on the angle about X."
)
_SIMULATED = (
    "SIMULATED logs from a sensor model: they demonstrate the reduction and are no evidence for "
    "a launcher."
)


def draw(found: dict) -> list[Part]:
    """Everything in the section."""
    rates, cloud = figures(found)
    return [
        *_warning(found),
        rates,
        _changes(found["tests"]),
        cloud,
        *table_of_comparison(found),
        _budgets(found["tests"]),
        *_notes(found["tests"]),
    ]


def terminal(found: dict) -> list[Part]:
    """The tables of the tests and of their comparison with the simulated cases."""
    request, cases = found["request"], found["cases"]
    condition = f" of condition {request['condition']}" if request["condition"] else ""
    return [
        f"{found['scene']}: {len(found['tests'])} drop tests, {cases['settled']:,} settled of "
        f"{cases['asked']:,} simulated cases{condition}; errors of {request['vary']}, seed "
        f"{found['varied']['seed']}",
        population.model_line(found),
        *_warning(found),
        _changes(found["tests"]),
        *table_of_comparison(found),
        *_notes(found["tests"]),
    ]


def _warning(found: dict) -> list[Part]:
    return [Notice(_SIMULATED)] if any(row["simulated"] for row in found["tests"]) else []


def table_of_comparison(found: dict) -> list[Part]:
    """Tables that compare the tests with the simulated cases."""
    return [_standing(found), _together(found), _cases(found["cases"]), _power(found["power"])]


def figures(found: dict) -> tuple[Figure, Figure]:
    """Filtered rates of every test; the simulated cloud with the tests in it."""
    panels = [panel for row in found["tests"] for panel in _rates(row)]
    shown, settled = len(found["cases"]["shown_deg_s"]), found["cases"]["settled"]
    words = _CLOUD.format(
        share=100.0 * found["regions"][0]["share"],
        shown="" if shown == settled else f", the first {shown:,} of {settled:,},",
        vary=found["request"]["vary"],
    )
    return (
        Figure(Chart("droptest-rates", panels, columns=2, height=250), _RATES),
        Figure(Chart("droptest-cloud", _clouds(found), columns=2, height=380), words),
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
        Column("CFC", "Hz", "g"),
        "largest rate at rest (deg/s)",
        *(Column(f"change {axis}", "deg/s") for axis in "xyz"),
    )
    rows = [
        (
            Noted(row["test"], "SIMULATED") if row["simulated"] else row["test"],
            row["release_s"],
            row["ignition_s"],
            row["channel_class"],
            f"{row['rest_deg_s']:.2g}, {'limit' if row['rest_kept'] else 'ABOVE'} "
            f"{row['rest_limit_deg_s']:g}",
            *(
                f"{value:+.3f} ± {uncertainty:.3f}"
                for value, uncertainty in zip(
                    row["change_deg_s"], row["expanded_uncertainty_deg_s"]
                )
            ),
        )
        for row in tests
    ]
    note = "Change: settled rate minus the rate before ignition, with expanded uncertainty (95 %)."
    return Table(heads, rows, (note,))


def _standing(found: dict) -> Table:
    heads: tuple[Column | str, ...] = (
        "test",
        *(f"{name}, percentile (p)" for name in "xyz"),
        Column("distance of x, y, z (p)", form=".3f"),
        *(f"{name}, percentile (p)" for name in MAGNITUDES),
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
        "Percentile of each test among the simulated cases with the same measurement errors. p is "
        f"from ranks, (r + 1)/(N + 1), at least {found['together']['smallest_p']:.2g}; two-sided "
        "except for the Mahalanobis distance of x, y and z. Roll, transverse and total are "
        "magnitudes."
    )
    return Table(heads, rows, (note,))


def _together(found: dict) -> Table:
    together = found["together"]
    verdict = "do not contradict" if together["p"] > power.LEVEL else "contradict"
    rows = [
        ("distance from the mean (Fisher)", together["p_distance"]),
        ("spread, two-sided", together["p_spread"]),
        ("both, twice the smaller p", together["p"]),
    ]
    note = (
        f"The tests {verdict} the simulated distribution at the {percent(power.LEVEL)} % level. "
        f"{'All tests are' if together['inside_range'] else 'Not all tests are'} inside the "
        "range of the cases. This alone is no validation."
    )
    return Table(["all tests together", Column("p", form=".3f")], rows, (note,))


def _place(share: float, p: float) -> str:
    return f"{100.0 * share:.1f} ({p:.3f})"


def _cases(cases: dict) -> Table:
    shares = [row["share"] for row in cases["quantiles"][answers.TOTAL_RATE.name]]
    rows = [
        (f"{item.label} ({item.unit})", *map(estimate, cases["quantiles"][item.name]))
        for item in answers.ALL
    ]
    note = (
        f"Exit state of {cases['settled']:,} simulated cases. Each share of the cases is below "
        f"the value of its column. In brackets: bounds at {spread.CONFIDENCE:.0%} confidence, "
        "where the cases are independent and enough."
    )
    heads = ["simulated cases", *(f"{percent(share, '.4g')} %" for share in shares)]
    return Table(heads, rows, (note,), dense=True)


def _power(table: list[dict]) -> Table:
    columns = {
        "passes_one_axis": "inside the range, one axis",
        "passes_three_axes": "inside the range, three axes",
        "passes_in_cloud": "inside the range, this cloud",
        "flagged_by_spread": "rejected by the spread",
        "flagged_in_cloud": "rejected by the spread, this cloud",
    }
    heads: tuple[Column | str, ...] = (
        Column("spread of the model over the truth", form=".3g"),
        *(Column(title, "%", ".2f", 100.0) for title in columns.values()),
    )
    rows = [(row["factor"], *(row[name] for name in columns)) for row in table]
    note = (
        "Probability that this number of tests is inside the range of this number of cases, and "
        "probability that a two-sided 5 % test of their spread rejects the model. Row 1 is a "
        "correct model and exact. The other rows are for a normal distribution (Monte Carlo). "
        "This cloud: the truth is the simulated cloud, scaled about its mean."
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
    return Fold("Uncertainty budget: standard uncertainties in deg/s", [table])


def _notes(tests: list[dict]) -> list[Part]:
    rows = [(row["test"], words) for row in tests for words in row["notes"]]
    return [Table(["test", "repairs, omissions and doubts"], rows)] if rows else []
