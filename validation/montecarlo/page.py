"""Random errors on the page and for the terminal: distributions, probabilities above limits,
convergence, the readings of the paper's Table 3, and both surrogates."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from tipoff.studies.populations import population
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Heading, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table, estimate, percent, span
from tipoff.uncertain import LEAST, number, uncertain
from validation.montecarlo.results import (
    Compared,
    Converging,
    Distribution,
    MonteCarlo,
    ReadingRow,
)

_RATES = ("rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s")
_LOOKS = {0.5: (NAVY, "-", "o"), 0.95: (VERMILION, "--", "s"), 0.99: (TEAL, "-.", "^")}
_HISTOGRAMS = (
    "Probability density of the settled rates. Wide pale line: the first {paper_cases:,} cases, "
    "the number of the paper's Figure 9. Thin line: all cases."
)
_CONVERGENCE = (
    "Left: quantiles of each rate against the number of cases, with 95 % bounds from order "
    "statistics (dotted). Right: half the width of these bounds; the grey lines fall as 1/√n."
)
_MODELS = (
    "Rates of the same {cases:,} cases with calibrated springs and with compliant contact. On the "
    "grey line both models give the same rate."
)
_BOUNDS = (
    "Each quantile is followed by its 95 % bounds from order statistics, which hold for any "
    "distribution. A dash: too few cases for a bound."
)
_READINGS = (
    "{cases:,} cases of each reading, deg/s, drawn with another seed than those of the study. "
    "Distance: the largest difference between the distribution functions of a rate in both samples "
    "(Kolmogorov and Smirnov). By chance: the probability of such a distance if both distributions "
    "are equal."
)
_PAPER = (
    "The paper gives no numbers of its Monte Carlo study. It shows histograms (Figure 9) and "
    "states that its three drop tests lie within them."
)
_DIFFERENT = 0.01  # probability by chance, below which two readings are called different


def figures(found: MonteCarlo) -> list[Figure]:
    """Each figure with its caption."""
    made = [
        Figure(lambda: _histograms(found), _HISTOGRAMS.format(paper_cases=found.paper_cases)),
        Figure(lambda: _convergence(found), _CONVERGENCE),
    ]
    models = found.models
    if models and models.quantities:
        made.append(Figure(lambda: _models(models), _MODELS.format(cases=models.cases)))
    return made


def draw(found: MonteCarlo) -> list[Part]:
    """The section."""
    histograms, convergence, *models = figures(found)
    return [
        Bullets(_run(found)),
        histograms,
        table_of_quantities(found),
        Fold("All quantiles, also of the paper's number of cases", [_quantiles(found)]),
        table_of_tails(found),
        convergence,
        *_readings(found),
        *models,
        *_apart(found),
        *([] if found.asked.vary else [_PAPER]),
    ]


def summary(found: MonteCarlo) -> list[Part]:
    """Quantiles and probabilities above limits, for the terminal."""
    lines = [
        *_run(found),
        *(_different(found.readings) if found.readings else []),
        *_model_error(found),
    ]
    return [Bullets(lines), table_of_quantities(found), table_of_tails(found)]


def _run(found: MonteCarlo) -> list[str]:
    """What was run."""
    counts = found.counts
    return [
        f"{counts['asked']:,} cases = {counts['ok']:,} ok + {counts['refused']:,} refused + "
        f"{counts['failed']:,} failed; {found.settled:,} settled; seed {found.asked.seed}",
        population.model_line(found),
        f"random errors: {found.reading}",
    ]


def _different(readings: Sequence[ReadingRow]) -> list[str]:
    """Readings with other rates than the study, and readings with too few cases to compare."""
    others = [row for row in readings if not row.same]
    few = [row.reading for row in others if row.distance is None]
    different = [
        f"{row.reading} (distance {row.distance:.3f})"
        for row in others
        if row.distance is not None and row.chance is not None and row.chance < _DIFFERENT
    ]
    lines = [f"readings with too few settled cases to compare: {'; '.join(few)}"] if few else []
    return [
        *lines,
        f"readings with other distributions of the rates: {'; '.join(different) or 'none'}",
    ]


def _model_error(found: MonteCarlo) -> list[str]:
    """The difference of the rates between springs and compliant contact, or why it is not known."""
    if not (models := found.models):
        return [f"springs against compliant contact: not compared, {found.models_missing}"]
    compliant = population.with_modes("compliant contact", models.modes, models.modes_why)
    what = f"springs against {compliant}, the same {models.cases:,} cases"
    if not models.quantities:
        return [f"{what}: no case settled in both models"]
    rates = ", ".join(
        f"{row.label} {row.root_mean_square:.3g} {row.unit}"
        for row in models.quantities
        if row.unit == "deg/s"
    )
    return [f"{what}: root mean square difference {rates}"]


def _histograms(found: MonteCarlo) -> Chart:
    panels = []
    for item in found.quantities:
        if item.name not in (*_RATES, "rate_deg_s"):
            continue
        edges = np.repeat(item.histogram.edges, 2)
        first, whole = (
            np.pad(np.repeat(bars, 2), 1) for bars in (item.histogram.first, item.histogram.all)
        )
        lines = [
            Line(
                edges,
                first,
                name=f"first {found.paper_cases:,} cases",
                colour=AMBER,
                width=4.0,
                opacity=0.55,
            ),
            Line(edges, whole, name=f"all {found.counts['asked']:,} cases", colour=NAVY, width=1.4),
        ]
        panels.append(
            Panel(item.label, item.title, y_label=f"density (1/({item.unit}))", lines=lines)
        )
    return Chart("montecarlo-histograms", panels, columns=2, height=280)


def _convergence(found: MonteCarlo) -> Chart:
    labels = {item.name: item.label for item in found.quantities}
    panels = [
        panel
        for name in dict.fromkeys(row.name for row in found.convergence)
        for panel in _converging(
            labels[name], [row for row in found.convergence if row.name == name]
        )
    ]
    return Chart("montecarlo-convergence", panels, columns=2, height=320)


def _converging(label: str, found: list[Converging]) -> list[Panel]:
    """Quantiles of a rate over the number of cases, and half the widths of their bounds."""
    values, widths = [], []
    for share, (colour, dash, marker) in _LOOKS.items():
        rows = [row for row in found if row.share == share]
        line = partial(
            Line,
            name=f"{share:.0%} below",
            colour=colour,
            width=1.8,
            dash=dash,
            marker=marker,
            size=6.0,
        )
        shown = np.array([row.value for row in rows], dtype=float)
        values.append(line([row.cases for row in rows], shown))
        bounded = [
            (row.cases, row.low, row.high)
            for row in rows
            if row.low is not None and row.high is not None
        ]
        counts = [count for count, _, _ in bounded]
        values += [
            Line(counts, ends, name="", colour=colour, width=1.0, dash=":", legend=False)
            for ends in ([low for _, low, _ in bounded], [high for _, _, high in bounded])
        ]
        halves = [0.5 * (high - low) for _, low, high in bounded]
        widths.append(line(counts, halves))
        if halves:
            ends = [counts[0], counts[-1]]
            falling = [halves[-1] * (counts[-1] / count) ** 0.5 for count in ends]
            widths.append(Line(ends, falling, name="falling as 1/√n", colour=GREY, width=1.0))
    return [
        Panel(
            f"Quantiles of the {label}",
            "cases",
            y_label=f"{label} (deg/s)",
            lines=values,
            log_x=True,
        ),
        Panel(
            "Half the width of the bounds",
            "cases",
            y_label="half width (deg/s)",
            lines=widths,
            log=True,
        ),
    ]


def _models(models: Compared) -> Chart:
    panels = []
    for name in _RATES:
        pair = models.pairs[name]
        label = next(row.label for row in models.quantities if row.name == name)
        low, high = min(map(min, pair.values())), max(map(max, pair.values()))
        both = pair["springs"], pair["compliant"]
        lines = [
            Line([low, high], [low, high], name="both agree", colour=GREY, width=1.2),
            Line(*both, name="a case", colour=NAVY, dash="", marker="o", size=3.5, opacity=0.45),
        ]
        panels.append(Panel(label, "springs (deg/s)", y_label="compliant (deg/s)", lines=lines))
    return Chart("montecarlo-models", panels, columns=3, height=300)


def table_of_quantities(found: MonteCarlo) -> Table:
    """Standard deviation and quantiles of each quantity."""
    rows = []
    for item in found.quantities:
        quantiles = {row.share: row for row in item.quantiles}
        shown = [estimate(quantiles[share]) for share in _LOOKS]
        rows.append((*_name_and_sd(item), *shown))
    below = [f"{percent(share, 'g')} % below" for share in _LOOKS]
    return Table(["quantity", "sd", *below], rows, notes=(_BOUNDS,))


def _name_and_sd(item: Distribution) -> tuple[str, str]:
    return item.title, uncertain(item.sd, item.sd_error)


def _quantiles(found: MonteCarlo) -> Table:
    """A row of all cases, and a row of the paper's number of cases."""
    shares = [row.share for row in found.quantities[0].quantiles[1:]]
    rows = []
    for item in found.quantities:
        first = (
            map(estimate, item.first[1:])
            if item.first
            else ["none settled", *[""] * (len(shares) - 1)]
        )
        name, sd = _name_and_sd(item)
        rows += [
            (name, found.counts["asked"], sd, *map(estimate, item.quantiles[1:])),
            ("", found.paper_cases, "", *first),
        ]
    below = [f"{percent(share, 'g')} % below" for share in shares]
    return Table(["quantity", "cases", "sd", *below], rows, notes=(_BOUNDS,), dense=True)


def table_of_tails(found: MonteCarlo) -> Table:
    """Probability above each limit, with bounds."""
    note = "The magnitude of a rate is compared. A case that did not settle counts as above."
    return Table.of_records(
        found.tails,
        "limit",
        ("cases above", lambda row: f"{row.above:,} of {row.cases:,}"),
        "share",
        ("95 % bounds (Clopper and Pearson)", lambda row: span(row.low, row.high)),
        notes=(note,),
    )


def _readings(found: MonteCarlo) -> list[Part]:
    """The rates of each reading; nothing with a file of errors."""
    if not found.readings:
        return []
    return [Heading("Effect of the reading of the paper's Table 3"), table_of_readings(found)]


def table_of_readings(found: MonteCarlo) -> Table:
    shares = (0.5, 0.95, 0.99, 0.9973)
    rows: list[tuple] = []
    for item in found.readings:
        name = item.reading + (" (reading of the study, drawn again)" if item.same else "")
        if item.rates is None:
            settled = f"{item.settled or 'none'} settled"
            rows.append((name, settled, *[""] * (4 + len(shares))))
            continue
        *axes, total = item.rates
        quantiles = {row.share: row for row in total.quantiles}
        rows.append(
            (
                name,
                *(rate.sd for rate in axes),
                *(estimate(quantiles[share]) for share in shares),
                item.distance,
                number(item.chance, ".2g", LEAST),
            )
        )
    heads: tuple[Column | str, ...] = (
        "reading of the paper's Table 3",
        *(f"sd about {axis}" for axis in "xyz"),
        *(f"total, {percent(share, 'g')} % below" for share in shares),
        "distance",
        "by chance",
    )
    note = _READINGS.format(cases=found.readings[0].cases)
    return Table(heads, rows, notes=(note,), dense=True)


def _apart(found: MonteCarlo) -> list[Part]:
    if not (models := found.models):
        return [f"Springs and compliant contact are not compared: {found.models_missing}."]
    if not models.quantities:
        return [f"No case of {models.cases:,} settled in both models."]
    heads: tuple[Column | str, ...] = (
        "quantity",
        "difference, root mean square",
        "50 % of cases below",
        "95 %",
        "99 %",
        "largest",
        "95 % below, springs",
        "compliant",
        "99 % below, springs",
        "compliant",
    )
    rows = [
        (
            row.title,
            row.root_mean_square,
            *map(estimate, row.quantiles),
            row.most,
            *(estimate(each[place]) for place in (1, 2) for each in (row.springs, row.compliant)),
        )
        for row in models.quantities
    ]
    return [Fold("Both surrogates on the same cases", [Table(heads, rows, dense=True)])]
