"""Random errors on the page: distributions, tails, convergence, what the reading of the table
changes, and both surrogates."""

from collections.abc import Callable
from html import escape

import numpy as np

from tipoff.studies.render.chart import (
    AMBER,
    GREY,
    NAVY,
    TEAL,
    VERMILION,
    Chart,
    Line,
    Panel,
    Picture,
)
from tipoff.studies.render.markup import Html, caption, fold, number, paragraph, table

_RATES = ("rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s")
_LOOKS = {0.5: (NAVY, "-", "o"), 0.95: (VERMILION, "--", "s"), 0.99: (TEAL, "-.", "^")}
_HISTOGRAMS = (
    "Densities of the settled rates. Broad pale: the first {paper_cases:,} cases, as many as the "
    "paper has in its "
    "Figure 9. Thin: all of them."
)
_CONVERGENCE = (
    "Left: quantiles of each rate from the first cases, with their 95 % bounds from order "
    "statistics (dotted). "
    "Right: half the width of these bounds; the grey lines fall with the root of the number of "
    "cases."
)
_MODELS = (
    "The same {cases:,} draws on calibrated springs and on compliant contact. On the grey line "
    "both agree; what lies off "
    "it is the uncertainty of the model."
)
_BOUNDS = (
    "Small: 95 % bounds from order statistics, which hold whatever the distribution is; a dash "
    "where the cases are too few "
    "for one. The second line of each is of the paper's number of cases."
)
_READINGS = (
    "{cases:,} cases each, deg/s, drawn apart from the study's own. Distance: the largest between "
    "the distribution "
    "functions of a rate here and in the study (Kolmogorov and Smirnov), with the chance of so "
    "large a one if there were "
    "no difference."
)
_PAPER = (
    "The paper prints no number of its Monte Carlo study, only histograms (Figure 9) and that "
    "three drop tests lie within "
    "them, so there is none to set beside these."
)


def charts(found: dict) -> list[tuple[Chart, str]]:
    """Each figure with its caption."""
    made = [
        (_histograms(found), _HISTOGRAMS.format(paper_cases=found["paper_cases"])),
        (_convergence(found), _CONVERGENCE),
    ]
    models = found["models"]
    if models and models["quantities"]:
        made.append((_models(models), _MODELS.format(cases=models["cases"])))
    return made


def draw(found: dict, figure: Callable[[Chart | Picture, str], Html]) -> Html:
    """What stands in the section."""
    said = "".join(f"<li>{escape(line[0].upper() + line[1:])}.</li>" for line in found["findings"])
    histograms, convergence, *models = [figure(chart, words) for chart, words in charts(found)]
    return Html(
        "".join(
            [
                f"<ul>{said}</ul>",
                histograms,
                _quantities(found),
                _tails(found),
                convergence,
                _readings(found),
                *models,
                _apart(found),
                paragraph(_PAPER),
            ]
        )
    )


def _histograms(found: dict) -> Chart:
    panels = []
    for item in found["quantities"]:
        if item["name"] not in (*_RATES, "rate_deg_s"):
            continue
        edges, bars = np.repeat(item["histogram"]["edges"], 2), item["histogram"]
        outline = {name: np.pad(np.repeat(bars[name], 2), 1) for name in ("first", "all")}
        lines = [
            Line(
                edges,
                outline["first"],
                f"first {found['paper_cases']:,} cases",
                AMBER,
                4.0,
                opacity=0.55,
            ),
            Line(edges, outline["all"], f"all {found['counts']['asked']:,} cases", NAVY, 1.4),
        ]
        panels.append(
            Panel(
                item["label"],
                f"{item['label']} ({item['unit']})",
                f"density (1/({item['unit']}))",
                lines,
            )
        )
    return Chart("montecarlo-histograms", panels, columns=2, height=280)


def _convergence(found: dict) -> Chart:
    labels = {item["name"]: item["label"] for item in found["quantities"]}
    panels = [
        panel
        for name in dict.fromkeys(row["name"] for row in found["convergence"])
        for panel in _converging(
            labels[name], [row for row in found["convergence"] if row["name"] == name]
        )
    ]
    return Chart("montecarlo-convergence", panels, columns=2, height=320)


def _converging(label: str, found: list[dict]) -> list[Panel]:
    """Quantiles of a rate over the number of cases, and half the widths of their bounds."""
    values, widths = [], []
    for share, (colour, dash, marker) in _LOOKS.items():
        rows = [row for row in found if row["share"] == share]
        cases = [row["cases"] for row in rows]
        values.append(
            Line(
                cases,
                [row["value"] for row in rows],
                f"{share:.0%} below",
                colour,
                1.8,
                dash,
                marker=marker,
                size=6.0,
            )
        )
        bounded = [row for row in rows if None not in (row["low"], row["high"])]
        counts = [row["cases"] for row in bounded]
        values += [
            Line(counts, [row[side] for row in bounded], "", colour, 1.0, ":", legend=False)
            for side in ("low", "high")
        ]
        halves = [0.5 * (row["high"] - row["low"]) for row in bounded]
        widths.append(
            Line(counts, halves, f"{share:.0%} below", colour, 1.8, dash, marker=marker, size=6.0)
        )
        if halves:
            ends = [counts[0], counts[-1]]
            widths.append(
                Line(
                    ends,
                    [halves[-1] * (counts[-1] / count) ** 0.5 for count in ends],
                    "falling as 1/√n",
                    GREY,
                    1.0,
                )
            )
    return [
        Panel(f"Quantiles of the {label}", "cases", f"{label} (deg/s)", values, log_x=True),
        Panel("Half the width of the bounds", "cases", "half width (deg/s)", widths, log=True),
    ]


def _models(models: dict) -> Chart:
    panels = []
    for name in _RATES:
        pair, label = (
            models["pairs"][name],
            next(row["label"] for row in models["quantities"] if row["name"] == name),
        )
        low, high = min(map(min, pair.values())), max(map(max, pair.values()))
        cases = Line(
            pair["springs"],
            pair["compliant"],
            "a case",
            NAVY,
            dash="",
            marker="o",
            size=3.5,
            opacity=0.45,
        )
        panels.append(
            Panel(
                label,
                "springs (deg/s)",
                "compliant (deg/s)",
                [Line([low, high], [low, high], "both agree", GREY, 1.2), cases],
            )
        )
    return Chart("montecarlo-models", panels, columns=3, height=300)


def bounded(row: dict, digits: int = 3) -> str:
    """A quantile with its bounds, small."""
    ends = ("–" if row[side] is None else f"{row[side]:.{digits}g}" for side in ("low", "high"))
    return Html(f'{row["value"]:.{digits}g} <span class="small">{" to ".join(ends)}</span>')


def _quantities(found: dict) -> Html:
    shares = [row["share"] for row in found["quantities"][0]["quantiles"][1:]]
    rows = []
    for item in found["quantities"]:
        spread = f"{item['sd']:.4g} ± {item['sd_error']:.1g}"
        rows.append(
            (
                f"{item['label']} ({item['unit']})",
                f"{found['counts']['asked']:,}",
                spread,
                *map(bounded, item["quantiles"][1:]),
            )
        )
        first = (
            map(bounded, item["first"][1:])
            if item["first"]
            else ["none settled", *[""] * (len(shares) - 1)]
        )
        rows.append(("", f"{found['paper_cases']:,}", "", *first))
    heads = ("quantity", "cases", "sd", *(f"{100.0 * share:g} % below" for share in shares))
    return Html(table(heads, rows, dense=True) + caption(_BOUNDS))


def _tails(found: dict) -> Html:
    rows = [
        (
            row["limit"],
            f"{row['above']:,} of {row['cases']:,}",
            number(row["share"]),
            f"{row['low']:.3g} to {row['high']:.3g}",
        )
        for row in found["tails"]
    ]
    heads = (
        "limit",
        "cases above",
        "probability of being above",
        "95 % bounds (Clopper and Pearson)",
    )
    return Html(
        table(heads, rows)
        + caption(
            "A rate about an axis counts by its magnitude. A case that did not settle counts as "
            "above every limit."
        )
    )


def _readings(found: dict) -> Html:
    shares, rows = (0.5, 0.95, 0.99, 0.9973), []
    for item in found["readings"]:
        name = item["reading"] + (" (the same, drawn again)" if item["same"] else "")
        if item["rates"] is None:
            rows.append((name, f"{item['settled'] or 'none'} settled", *[""] * (4 + len(shares))))
            continue
        *axes, total = item["rates"]
        quantiles = {row["share"]: row for row in total["quantiles"]}
        rows.append(
            (
                name,
                *(number(rate["sd"]) for rate in axes),
                *(bounded(quantiles[share]) for share in shares),
                number(item["distance"]),
                number(item["chance"], 2),
            )
        )
    heads = (
        "reading of the paper's Table 3",
        *(f"sd about {axis}" for axis in "xyz"),
        *(f"total, {100.0 * share:g} % below" for share in shares),
        "distance",
        "by chance",
    )
    words = _READINGS.format(cases=found["readings"][0]["cases"])
    return Html(
        "<h3>Does the reading matter?</h3>" + table(heads, rows, dense=True) + caption(words)
    )


def _apart(found: dict) -> Html:
    if not found["models"]:
        return Html("")
    if not found["models"]["quantities"]:
        return paragraph(f"No case of {found['models']['cases']:,} settled in both models.")
    heads = (
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
    rows = []
    for row in found["models"]["quantities"]:
        sides = [bounded(row[name][place]) for place in (1, 2) for name in ("springs", "compliant")]
        rows.append(
            (
                f"{row['label']} ({row['unit']})",
                number(row["root_mean_square"]),
                *map(bounded, row["quantiles"]),
                number(row["most"]),
                *sides,
            )
        )
    return fold("both surrogates on the same draws", table(heads, rows, dense=True))
