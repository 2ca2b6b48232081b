"""Conditions that are judged as distributions, on the page: quantiles of both models over neighbours
within 1 um, and the empirical distributions of one chaotic condition."""

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.distributions import Distribution, Verdict
from tipoff.studies.agreement.equivalence import AXES, CONFIDENCE, MARGIN_SHARE, Comparison
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.column import of_record
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, VERMILION
from tipoff.studies.render.table import Cells, Column, Table

Shown = tuple[Distribution, Verdict]
_SHOWN = {"compliant": (VERMILION, "-"), "calibrated": (AMBER, "--")}  # colour, dash
_CAPTION = (
    "Share of the neighbours of {condition} with a smaller settled rate: {count} runs of the reference, "
    "{further:,} of each surrogate. Calibrated springs are the control."
)


def parts(
    found: Sequence[Distribution], distance: float, name: str = "distributions"
) -> list[Part]:
    """Figure, called ``name``, and tables of distributions over neighbours within ``distance`` (m);
    nothing where every condition is judged as a curve."""
    if not found:
        return []
    shown = most_spread(found)
    caption = _CAPTION.format(
        condition=shown.condition, count=shown.neighbours, further=shown.further
    )
    return [
        "Conditions judged as distributions over neighbours within "
        f"±{1e6 * distance:g} µm: {sentence(found)}.",
        Figure(lambda: picture(shown, name), caption),
        summary(found, name),
        Fold("Every quantile of every rate", [quantiles(found)]),
    ]


def most_spread(found: Sequence[Distribution]) -> Distribution:
    """The condition with the widest distribution of a settled rate of the reference."""

    def width(item: Distribution) -> float:
        columns = zip(*item.settled_deg_s)
        return max((max(column) - min(column) for column in columns), default=0.0)

    return max(found, key=width)


def sentence(found: Sequence[Distribution], model: str = "compliant") -> str:
    """The verdicts on one ``model``, condition by condition."""
    return "; ".join(f"{item.condition} {item.models[model].verdict}" for item in found)


def picture(item: Distribution, name: str = "distributions") -> Chart:
    """Empirical distributions of the settled rates on one condition, a panel for each axis."""
    panels = []
    for place, axis in enumerate(AXES):
        values = sorted(rates[place] for rates in item.settled_deg_s)
        steps = [value for value in values for _ in (0, 1)]
        up_to = [(number + up) / len(values) for number in range(len(values)) for up in (0, 1)]
        lines = [Line(steps, up_to, FINITE_ELEMENTS, width=3.0, opacity=0.6)]
        for model, (colour, dash) in _SHOWN.items():
            own = item.models.get(model)
            if own and (rates := own.quantiles.rates_deg_s):
                shares = own.quantiles.shares
                lines.append(Line(rates[place], shares, own.title, colour, dash=dash))
        title = f"{item.condition}, rate {axis}"
        panels.append(Panel(title, "settled rate (deg/s)", "share", lines))
    return Chart(name, panels, columns=3, height=280)


def summary(found: Sequence[Distribution], name: str = "distributions") -> Table:
    """One row for each condition and model: the comparison with the largest bound."""
    columns: Cells = (
        ("condition", lambda shown: shown[0].condition),
        ("model", lambda shown: shown[1].title),
        ("neighbours", lambda shown: shown[0].neighbours),
        (
            Column("rate, quantile", detail=True),
            _of_worst(lambda item: f"{item.axis}, {100.0 * item.share:g} %"),
        ),
        (Column("reference", "deg/s", detail=True), _of_worst(attrgetter("reference_deg_s"))),
        (
            Column("difference", "deg/s", "+.2g", detail=True),
            _of_worst(attrgetter("difference_deg_s")),
        ),
        (Column("margin", "deg/s", ".2g", detail=True), _of_worst(attrgetter("margin_deg_s"))),
        (Column("bound", "margins", ".2g"), _of_worst(attrgetter("bound"))),
        (
            Column("reference known within", "margins", ".2g", detail=True),
            _of_worst(attrgetter("width")),
        ),
        ("verdict", lambda shown: shown[1].verdict),
    )
    note = (
        f"The quantile with the largest bound of its difference. Agreement: all {CONFIDENCE:.0%} "
        "bounds are below one margin. The margin is the larger of two values: the limit of "
        f"agreement, and {MARGIN_SHARE:.0%} of the distance between the 10 and 90 % quantiles of "
        "the reference. Both models run on the coarse mesh. docs/chaotic_conditions.md explains "
        "the test."
    )
    rows = _pairs(found)
    kinds = [kind(own.judgement) for _, own in rows]
    return Table.of(rows, columns, notes=(note,), name=name, kinds=kinds, dense=True)


def kind(judgement: str) -> str:
    """Look of a row with this word."""
    good = (verdicts.AGREES, verdicts.AS_DISTRIBUTION)
    return "good" if judgement in good else "bad" if judgement == verdicts.MISSES else "doubt"


def _pairs(found: Sequence[Distribution]) -> list[Shown]:
    return [(item, own) for item in found for own in item.models.values()]


def _of_worst(cell: Callable[[Comparison], Any]) -> Callable[[Shown], Any]:
    """A cell of the comparison with the largest bound; None without one."""
    return lambda shown: shown[1].worst and cell(shown[1].worst)


def quantiles(found: Sequence[Distribution]) -> Table:
    """All quantiles of all models."""
    rows = [(item, own, one) for item, own in _pairs(found) for one in own.comparisons]
    columns: list[tuple[Column | str, Callable[[Any], Any]]] = [
        ("condition", lambda row: row[0].condition),
        ("model", lambda row: row[1].title),
        *(
            (column, lambda row, name=name: getattr(row[2], name))
            for name, column in of_record(Comparison).items()
        ),
    ]
    return Table.of(rows, columns, dense=True)
