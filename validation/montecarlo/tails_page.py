"""The random errors checked by the reference, on the page and for the terminal."""

from collections.abc import Sequence
from operator import attrgetter

from tipoff.highfi.rail.step_cost import in_words
from tipoff.studies.populations import population
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table, bounded, estimate, number, percent, span
from validation.montecarlo import ladder_page
from validation.montecarlo.results import Tails

_NAMES = ("rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s")
_Rate = tuple[str, dict[str, tuple[float, ...]], tuple[int, ...]]  # name, rates by model, contacts
_TOTAL, _MEDIAN = "rate_deg_s", 0.5
# draws with these numbers of contacts: name, colour, marker
_GROUPS = (
    (range(3), "up to 2 contacts", NAVY, "o"),
    (range(3, 4), "3 contacts", AMBER, "s"),
    (range(4, 1000), "4 or more contacts", VERMILION, "^"),
)
_CAPTION = (
    "Above: settled rates of {paired} draws in the reference and in the surrogate, by the number of "
    "contacts. Below: quantiles of the same draws. On the grey line both are equal."
)
_CONTACTS = (
    "A contact is a time interval in which some pad of the surrogate has a force; intervals "
    "less than 1 ms apart count as one. Error: the largest of the three axes, both models on "
    "the same mesh."
)
_ERRORS = (
    "Same mesh: the surrogate with the rail compliance of the mesh of the reference. Population: the "
    "cases of the population, with the rail compliance and the step of that study. Finer mesh: the "
    "reference on elements of {fine:g} mm, {count} draws, against the reference on {coarse:g} mm and "
    "against the population."
)
_INTERVALS = (
    "{confidence:.0%} intervals. The reference alone: its {paired} draws without correction. "
    "Equivalent runs: runs of the reference alone with an interval of the same width. A dash: "
    "too few draws for a bound. Intervals of quantiles and probabilities allow for rare "
    "differences that no draw has shown. Intervals of a mean do not, so the correction narrows "
    "them more."
)
_TAILS = (
    "A case that did not settle counts as above. Missed: draws above the limit in the reference and "
    "not in the surrogate; false: the other way round."
)


def figures(found: Tails) -> list[Figure]:
    """Draws of both models, case by case and as quantiles; error over time where the settings
    matter."""
    return [figure(found), *ladder_page.figures(found)]


def figure(found: Tails) -> Figure:
    """Draws of both models, case by case and as quantiles."""
    panels = [*map(_scatter, _rates(found)), *map(_quantiles, _rates(found))]
    return Figure(
        lambda: Chart("tails", panels, columns=3, height=300), _CAPTION.format(**vars(found))
    )


def draw(found: Tails) -> list[Part]:
    """The section."""
    lines, *tables = summary(found)
    differences = [_errors(found)]
    fold = Fold("Differences of every quantity, and the finer mesh", differences)
    return [lines, figure(found), *tables, *ladder_page.figures(found), fold]


def summary(found: Tails) -> list[Part]:
    """The same for the terminal."""
    return [
        Bullets([*sentences(found), *_run(found)]),
        by_contacts(found),
        *ladder_page.table(found),
        statistics(found),
        _tails(found),
    ]


def document(found: Tails) -> list[Part]:
    """A page of its own."""
    return [
        Bullets(sentences(found)),
        "![Settled rates of both models, and their quantiles](tails.png)",
        by_contacts(found),
        *(["![Error of the surrogate over its time](ladder.png)"] if found.ladder else []),
        *ladder_page.table(found),
        Bullets(_run(found)),
    ]


def sentences(found: Tails) -> list[str]:
    """Agreement, corrected rates, cost."""
    agreement = ". ".join([_agreement(found), *ladder_page.best(found)])
    return [agreement, _corrected(found), _cost(found)]


def brief(found: Tails) -> list[str]:
    """Agreement and corrected rates."""
    return [_agreement(found), _corrected(found)]


def _agreement(found: Tails) -> str:
    *_, everything = found.contacts
    gate, worst = found.gate_deg_s, number(everything.most, ".2g")
    few = [row.most for row in found.contacts[:3] if row.most is not None]
    limit = (
        f". With at most 2 contacts the largest is {number(max(few), '.2g')} deg/s" if few else ""
    )
    return (
        f"the settled rates of both models, on the same mesh, differ by at most {gate:g} deg/s in "
        f"{percent(everything.within_gate, '.0f')} % of {everything.settled} draws. The median "
        f"difference is {number(everything.median, '.2g')} deg/s, the largest {worst} deg/s{limit}"
    )


def _corrected(found: Tails) -> str:
    """The highest quantile of the total rate that has both bounds."""
    *_, row = [
        row
        for row in found.statistics
        if row.name == _TOTAL
        and row.share
        and (None not in (row.low, row.high) or row.share == _MEDIAN)
    ]
    return (
        f"the {percent(row.share)} % quantile of the total rate, corrected by the reference, is "
        f"{number(row.value)} deg/s ({percent(found.confidence, '.0f')} % interval "
        f"{span(row.low, row.high)}). The surrogate alone gives {number(row.surrogate)} deg/s"
    )


def _cost(found: Tails) -> str:
    cost = found.cost
    row = next(row for row in found.statistics if (row.name, row.statistic) == (_TOTAL, "mean"))
    took = found.draws * cost.reference_cpu_s + found.cases * cost.surrogate_cpu_s
    alone = row.equivalent_runs
    if alone is None:
        return "the mean total rate has no interval to compare"
    return (
        f"both models together give the mean total rate in {in_words(took)} of one core. For an "
        f"interval as narrow, the reference alone needs {alone:,.0f} runs, "
        f"{in_words(alone * cost.reference_cpu_s)}"
    )


def _run(found: Tails) -> list[str]:
    counts, cost = found.counts, found.cost
    best = next(row for row in cost.optimal if row.name == _TOTAL)
    cases = best.cases_per_run
    lost = "; ".join(f"{row.words}" for row in found.lost)
    return [
        f"{counts['asked']} draws on elements of {1e3 * found.element_size_m:g} mm = "
        f"{counts['ok']} ok + {counts['refused']} refused + {counts['failed']} failed; "
        f"{found.paired} settled in both models; {found.fine} draws also on "
        f"{1e3 * found.fine_element_size_m:g} mm",
        *([f"not settled in the reference: {lost}"] if lost else []),
        population.model_line(found),
        *ladder_page.sentences(found),
        f"random errors: {found.reading}; {found.cases:,} cases",
        *_mesh(found),
        f"a run of the reference takes {cost.reference_cpu_s:.3g} s of one core, on the finer mesh "
        f"{cost.fine_cpu_s:.3g} s, a case of the surrogate {1e3 * cost.surrogate_cpu_s:.2g} ms",
        f"optimal for the mean total rate: "
        f"{'no case too many' if cases is None else f'{cases:,.0f} cases'} of the surrogate per run "
        f"of the reference, {number(best.variance_ratio, '.2g')} of the variance of the reference "
        "alone at the same cost",
    ]


def _mesh(found: Tails) -> list[str]:
    """The change by a finer mesh, and the difference of the surrogate from that."""
    rows = [row for row in found.errors if row.name in (*_NAMES, _TOTAL)]
    changes = [row.mesh for row in rows if row.mesh]
    if not changes:
        return []
    sizes = (
        max(size)
        for part in (changes, [row.finer for row in rows if row.finer])
        for size in ([each.median for each in part], [each.most for each in part])
    )
    change, worst, difference, largest = (number(size, ".2g") for size in sizes)
    return [
        f"on {found.fine} draws the finer mesh changes a rate of the reference by {change} deg/s "
        f"(median of the axis that changes most) and at most {worst} deg/s; the population differs "
        f"from the finer mesh by {difference} and at most {largest} deg/s"
    ]


def _rates(found: Tails) -> list[_Rate]:
    return [(name, found.pairs.rates[name], found.pairs.contacts) for name in _NAMES]


def _scatter(rate: _Rate) -> Panel:
    name, pair, contacts = rate
    lines = [_diagonal(pair["surrogate"], pair["reference"])]
    for numbers, words, colour, marker in _GROUPS:
        inside = [place for place, count in enumerate(contacts) if count in numbers]
        x, y = ([pair[side][place] for place in inside] for side in ("surrogate", "reference"))
        if inside:
            lines.append(
                Line(x, y, name=words, colour=colour, dash="", marker=marker, size=5.0, opacity=0.7)
            )
    axis = name[5]
    return Panel(
        f"Rate about {axis}", "surrogate (deg/s)", y_label="reference (deg/s)", lines=lines
    )


def _quantiles(rate: _Rate) -> Panel:
    name, pair, _ = rate
    x, y = sorted(pair["surrogate"]), sorted(pair["reference"])
    lines = [
        _diagonal(x, y),
        Line(x, y, name="quantiles", colour=TEAL, dash="", marker="D", size=4.0, opacity=0.8),
    ]
    return Panel(
        f"Quantiles about {name[5]}", "surrogate (deg/s)", y_label="reference (deg/s)", lines=lines
    )


def _diagonal(x: Sequence[float], y: Sequence[float]) -> Line:
    ends = [min(*x, *y), max(*x, *y)]
    return Line(ends, ends, name="equal", colour=GREY, width=1.2)


def by_contacts(found: Tails) -> Table:
    """Errors by the number of contacts."""
    return Table.of_records(
        found.contacts,
        "contacts",
        "draws",
        "median",
        "most",
        (f"within {found.gate_deg_s:g} deg/s (%)", lambda row: percent(row.within_gate, ".0f")),
        ("95 % bounds", lambda row: _percents(row.low, row.high)),
        notes=(_CONTACTS,),
    )


def _percents(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else span(100.0 * low, 100.0 * high, ".0f")


def statistics(found: Tails) -> Table:
    """Statistics of the population, corrected, beside those of each model alone."""
    return Table.of_records(
        found.statistics,
        ("quantity", lambda row: f"{row.label} ({row.unit}), {row.statistic}"),
        *_ESTIMATES,
        ("equivalent runs", lambda row: number(row.equivalent_runs, ",.0f")),
        notes=(_INTERVALS.format(**vars(found)),),
    )


def _tails(found: Tails) -> Table:
    title = "Probability above each limit"
    names = ("limit", *_ESTIMATES, "missed", "false")
    return Table.of_records(found.tails, *names, notes=(_TAILS,), title=title)


_ESTIMATES = (
    ("surrogate", attrgetter("surrogate")),
    ("corrected", estimate),
    ("reference alone", lambda row: bounded(row.plain, row.plain_low, row.plain_high)),
)


def _errors(found: Tails) -> Table:
    rows = []
    for row in found.errors:
        cells: list = [row.title]
        for item in (row.same_mesh, row.population):
            cells += [item.median, item.most_95, item.most] if item else [None] * 3
            cells.append(number(item.correlation if item else None, ".5f"))
        for item in (row.mesh, row.finer):
            cells += [item.median, item.most] if item else [None] * 2
        rows.append(cells)
    heads: list[Column | str] = ["quantity"]
    for words in ("same mesh", "population"):
        heads += [f"{words}, median", "95 %", "largest", "correlation"]
    for words in ("finer mesh, reference", "population"):
        heads += [f"{words}, median", "largest"]
    note = _ERRORS.format(
        fine=1e3 * found.fine_element_size_m, coarse=1e3 * found.element_size_m, count=found.fine
    )
    return Table(heads, rows, notes=(note,), dense=True)
