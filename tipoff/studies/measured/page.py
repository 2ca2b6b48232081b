"""Measured logs: of drop tests the filtered rates, their change with uncertainty, and the tests among the
simulated cases; of launches what ``launch.page`` shows."""

from collections.abc import Callable, Sequence

import numpy as np

from tipoff.scenes import halving
from tipoff.studies.measured import judgement, power
from tipoff.studies.measured.judgement import MAGNITUDES
from tipoff.studies.measured.launch import page as launches
from tipoff.studies.measured.results import (
    Compared,
    JudgedTest,
    Launch,
    Measurements,
    SimulatedCases,
)
from tipoff.studies.populations import answers, population, spread
from tipoff.studies.render.chart import Chart, Line, Panel, marks
from tipoff.studies.render.document import Bullets, Figure, Fold, Notice, Part
from tipoff.studies.render.palette import AMBER, AXIS_COLOURS, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Noted, Table, estimate, percent
from tipoff.workspace.words import counted

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
_POWER = (
    "Probability that this number of tests is inside the range of this number of cases, and "
    "probability that a two-sided 5 % test of their spread rejects the model. Row 1 is a "
    "correct model and exact. The other rows are for a normal distribution (Monte Carlo). "
    "This cloud: the truth is the simulated cloud, scaled about its mean."
)


def draw(found: Measurements) -> list[Part]:
    """The tests, and their comparison with the simulated cases."""
    parts = _heads(found)
    if found.tests:
        rates, cloud = _of_tests(found)
        parts += [rates, _changes(found.tests), cloud, *table_of_comparison(found)]
        parts.append(_budgets(found.tests))
    if found.launches:
        parts += [launches.figure(found), *launches.tables(found)]
        parts.append(launches.budgets(found.launches))
    return [*parts, *_notes(found)]


def _heads(found: Measurements) -> list[Part]:
    """What was compared with what, and a warning on logs that are simulated."""
    request, cases = found.request, found.cases
    condition = f" of condition {request.condition}" if request.condition else ""
    given = f"errors of {halving.with_sizes(found.errors, found.sizes)}, seed {found.varied.seed}"
    parts: list[Part] = []
    if cases is not None:
        parts.append(
            f"{counted(len(found.tests), 'drop test')}, {cases.settled:,} settled of {cases.asked:,} "
            f"simulated cases{condition}; {given}."
        )
    if found.launches:
        parts.append(
            f"{counted(len(found.launches), 'launch', 'launches')}, {found.launches[0].cases:,} predicted "
            f"ones{condition}; {given}."
        )
    parts.append(Bullets([population.model_line(found)]))
    return [*parts, *([Notice(_SIMULATED)] if any(row.simulated for row in _all(found)) else [])]


def _all(found: Measurements) -> list[JudgedTest | Launch]:
    return [*found.tests, *found.launches]


def table_of_comparison(found: Compared) -> list[Part]:
    """Tables that compare the tests with the simulated cases."""
    assert found.cases is not None  # there are tests
    power_of = Table.of_records(found.power, notes=(_POWER,))
    return [_standing(found), _together(found), _cases(found.cases), power_of]


def figures(found: Measurements) -> tuple[Figure, ...]:
    """Filtered rates of every drop test and the tests in the simulated cloud; rates of every launch."""
    of_launches = (launches.figure(found),) if found.launches else ()
    return (*_of_tests(found), *of_launches) if found.tests else of_launches


def _of_tests(found: Measurements) -> tuple[Figure, Figure]:
    assert found.cases is not None  # there are tests
    panels = [panel for row in found.tests for panel in _rates(row)]
    shown, settled = len(found.cases.shown_deg_s), found.cases.settled
    words = _CLOUD.format(
        share=100.0 * found.regions[0].share,
        shown="" if shown == settled else f", the first {shown:,} of {settled:,},",
        vary=found.errors,
    )
    return (
        Figure(lambda: Chart("measured-rates", panels, columns=2, height=250), _RATES),
        Figure(lambda: Chart("measured-cloud", _clouds(found), columns=2, height=380), words),
    )


def _rates(row: JudgedTest) -> list[Panel]:
    ignition = row.ignition_s
    time, rate = np.array(row.curve.time_s), np.array(row.curve.rate_deg_s)
    windows = [(begin - ignition, end - ignition) for begin, end in row.windows_s.values()]
    title = f"{row.test}{', SIMULATED' if row.simulated else ''}; grey: rest, reference, settled"
    panels = []
    for words, factor, unit, begin, end in (
        (title, 1.0, "s", time[0], time[-1]),
        (f"{row.test}, around ignition", 1e3, "ms", -0.1, 0.16),
    ):
        near = (time >= begin) & (time <= end)
        low, high = rate[near].min(), rate[near].max()
        curves = zip(rate[near].T, AXIS_COLOURS, AXIS_COLOURS.values(), _DASHES.values())
        lines = [
            Line(factor * time[near], values, f"rate about {axis.upper()}", colour, 1.4, dash)
            for values, axis, colour, dash in curves
        ]
        lines += [
            Line([factor * at] * 2, [low, high], "release, ignition", GREY, dash=":")
            for at in (row.release_s - ignition, 0.0)
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


def _clouds(found: Compared) -> list[Panel]:
    assert found.cases is not None  # there are tests
    cases = np.array(found.cases.shown_deg_s)
    panels = []
    for region in found.regions:
        pair = ["xyz".index(axis) for axis in region.components]
        lines = [_dots(cases[:, pair])]
        if region.squared_radius is not None:
            words = f"{100.0 * region.share:g} % prediction region"
            edge = judgement.outline(region)
            lines.append(Line(edge[:, 0], edge[:, 1], words, width=1.8))
        lines += _tests(
            found,
            [
                (np.array(row.change_deg_s)[pair], np.array(row.expanded_uncertainty_deg_s)[pair])
                for row in found.tests
            ],
        )
        first, second = (f"rate about {axis.upper()} (deg/s)" for axis in region.components)
        panels.append(Panel("", first, second, lines))
    sizes = judgement.magnitudes(cases)[:, :2]
    tests = _tests(
        found,
        [
            ([row.magnitudes[name].value_deg_s for name in MAGNITUDES[:2]], (0.0, 0.0))
            for row in found.tests
        ],
    )
    axes = "|rate about X| (deg/s)", "rate across X (deg/s)"
    return [*panels, Panel("", *axes, [_dots(sizes), *tests])]


def _dots(points: np.ndarray) -> Line:
    return marks(points[:, 0], points[:, 1], "simulated cases", GREY, size=3.0, opacity=0.45)


def _tests(found: Compared, places: Sequence[tuple]) -> list[Line]:
    """A symbol with bars for each test: its place (2,) and half the length of its bars (2,)."""
    lines = []
    for number_, (row, ((x, y), (dx, dy))) in enumerate(zip(found.tests, places)):
        colour, marker = _LOOKS[number_ % len(_LOOKS)]
        lines += [
            Line(*bar, "", colour, legend=False)
            for bar in (([x - dx, x + dx], [y, y]), ([x, x], [y - dy, y + dy]))
        ]
        name = f"{row.test}{' (SIMULATED)' if row.simulated else ''}"
        lines.append(marks([x], [y], name, colour, marker, size=10.0))
    return lines


def _changes(tests: Sequence[JudgedTest]) -> Table:
    def change(place: int) -> Callable[[JudgedTest], str]:
        return lambda row: (
            f"{row.change_deg_s[place]:+.3f} ± {row.expanded_uncertainty_deg_s[place]:.3f}"
        )

    return Table.of_records(
        tests,
        ("test", lambda row: Noted(row.test, "SIMULATED") if row.simulated else row.test),
        "release_s",
        "ignition_s",
        "channel_class",
        ("largest rate at rest (deg/s)", _rest),
        *((Column(f"change {axis}", "deg/s"), change(place)) for place, axis in enumerate("xyz")),
        notes=(
            "Change: settled rate minus the rate before ignition, with expanded uncertainty (95 %).",
        ),
    )


def _rest(row: JudgedTest) -> str:
    return f"{row.rest_deg_s:.2g}, {'limit' if row.rest_kept else 'ABOVE'} {row.rest_limit_deg_s:g}"


def _standing(found: Compared) -> Table:
    assert found.together is not None  # there are tests
    heads: tuple[Column | str, ...] = (
        "test",
        *(f"{name}, percentile (p)" for name in "xyz"),
        Column("distance of x, y, z (p)", form=".3f"),
        *(f"{name}, percentile (p)" for name in MAGNITUDES),
    )
    rows = [
        (
            row.test,
            *map(_place, row.percentile, row.p),
            row.p_distance,
            *(_place(item.percentile, item.p) for item in row.magnitudes.values()),
        )
        for row in found.tests
    ]
    note = (
        "Percentile of each test among the simulated cases with the same measurement errors. p is "
        f"from ranks, (r + 1)/(N + 1), at least {found.together.smallest_p:.2g}; two-sided "
        "except for the Mahalanobis distance of x, y and z. Roll, transverse and total are "
        "magnitudes."
    )
    return Table(heads, rows, notes=(note,))


def _together(found: Compared) -> Table:
    together = found.together
    assert together is not None  # there are tests
    verdict = "do not contradict" if together.p > power.LEVEL else "contradict"
    rows = [
        ("distance from the mean (Fisher)", together.p_distance),
        ("spread, two-sided", together.p_spread),
        ("both, twice the smaller p", together.p),
    ]
    note = (
        f"The tests {verdict} the simulated distribution at the {percent(power.LEVEL)} % level. "
        f"{'All tests are' if together.inside_range else 'Not all tests are'} inside the "
        "range of the cases. This alone is no validation."
    )
    return Table(["all tests together", Column("p", form=".3f")], rows, notes=(note,))


def _place(share: float, p: float) -> str:
    return f"{100.0 * share:.1f} ({p:.3f})"


def _cases(cases: SimulatedCases) -> Table:
    shares = [row.share for row in cases.quantiles[answers.TOTAL_RATE.name]]
    rows = [
        (f"{item.label} ({item.unit})", *map(estimate, cases.quantiles[item.name]))
        for item in answers.ALL
    ]
    note = (
        f"Exit state of {cases.settled:,} simulated cases. Each share of the cases is below "
        f"the value of its column. In brackets: bounds at {spread.CONFIDENCE:.0%} confidence, "
        "where the cases are independent and enough."
    )
    heads = ["simulated cases", *(f"{percent(share, '.4g')} %" for share in shares)]
    return Table(heads, rows, notes=(note,), dense=True)


def _budgets(tests: Sequence[JudgedTest]) -> Fold:
    rows = [
        (
            row.test,
            axis,
            *(part[place] for part in row.budget_deg_s.values()),
            row.standard_uncertainty_deg_s[place],
            row.coverage_factor[place],
        )
        for row in tests
        for place, axis in enumerate("xyz")
    ]
    parts = [Column(name, form=".2g") for name in (*tests[0].budget_deg_s, "combined")]
    table = Table(["test", "axis", *parts, Column("k", form=".2f")], rows, dense=True)
    return Fold("Uncertainty budget: standard uncertainties in deg/s", [table])


def _notes(found: Measurements) -> list[Part]:
    rows = [(row.test, words) for row in _all(found) for words in row.notes]
    return [Table(["test", "repairs, omissions and doubts"], rows)] if rows else []
