"""Conditions that are judged as distributions, on the page: quantiles of both models over neighbours
within 1 um, and the empirical distributions of one chaotic condition."""

from tipoff.mechanics.models import FINITE_ELEMENTS
from tipoff.studies.agreement.equivalence import AXES, CONFIDENCE, MARGIN_SHARE
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, NAVY, VERMILION
from tipoff.studies.render.table import Cells, Column, Table

_SHOWN = {"compliant": (VERMILION, 1.6, "-"), "calibrated": (AMBER, 1.6, "--")}
_CAPTION = (
    "Share of the neighbours of {condition} with a smaller settled rate: {count} runs of the reference, "
    "{further:,} of each surrogate. Calibrated springs are the control."
)


def parts(document: dict, name: str = "distributions") -> list[Part]:
    """Figure, called ``name``, and tables of a result file; nothing where every condition is judged as
    a curve."""
    found = document["distributions"]
    if not found:
        return []
    shown = most_spread(found)
    return [
        "Conditions judged as distributions over neighbours within "
        f"±{1e6 * document['clearance_change_m']:g} µm: {sentence(found)}.",
        Figure(picture(shown, name), _CAPTION.format(count=shown["neighbours"], **shown)),
        summary(found, name),
        Fold("Every quantile of every rate", [quantiles(found)]),
    ]


def most_spread(found: list[dict]) -> dict:
    """The condition with the widest distribution of a settled rate of the reference."""

    def width(item: dict) -> float:
        columns = zip(*item["reference_deg_s"])
        return max((max(column) - min(column) for column in columns), default=0.0)

    return max(found, key=width)


def sentence(found: list[dict], model: str = "compliant") -> str:
    """The verdicts on one ``model``, condition by condition."""
    return "; ".join(f"{item['condition']} {item['models'][model]['verdict']}" for item in found)


def picture(item: dict, name: str = "distributions") -> Chart:
    """Empirical distributions of the settled rates on one condition, a panel for each axis."""
    panels = []
    for place, axis in enumerate(AXES):
        values = sorted(row[place] for row in item["reference_deg_s"])
        steps = [value for value in values for _ in (0, 1)]
        shares = [(number + up) / len(values) for number in range(len(values)) for up in (0, 1)]
        lines = [Line(steps, shares, FINITE_ELEMENTS, NAVY, 3.0, "-", 0.6)]
        for model, look in _SHOWN.items():
            own = item["models"].get(model)
            if own and own["quantiles"]["rates_deg_s"]:
                curve = own["quantiles"]
                lines.append(
                    Line(curve["rates_deg_s"][place], curve["shares"], own["title"], *look)
                )
        panels.append(
            Panel(f"{item['condition']}, rate {axis}", "settled rate (deg/s)", "share", lines)
        )
    return Chart(name, panels, columns=3, height=280)


def summary(found: list[dict], name: str = "distributions") -> Table:
    """One row for each condition and model: the comparison that decides."""
    heads = (
        "condition",
        "model",
        "neighbours",
        "rate, quantile",
        Column("reference", "deg/s"),
        Column("difference", "deg/s", "+.2g"),
        Column("margin", "deg/s", ".2g"),
        Column("bound of the difference", "margins", ".2g"),
        Column("reference known within", "margins", ".2g"),
        "verdict",
    )
    rows, kinds = [], []
    for item in found:
        for own in item["models"].values():
            rows.append(
                (item["condition"], own["title"], item["neighbours"], *_worst(own), own["verdict"])
            )
            kinds.append(kind(own["judgement"]))
    note = (
        f"The quantile with the largest bound of its difference. Agreement: all {CONFIDENCE:.0%} "
        "bounds are below one margin. The margin is the larger of two values: the limit of "
        f"agreement, and {MARGIN_SHARE:.0%} of the distance between the 10 and 90 % quantiles of "
        "the reference. Both models run on the coarse mesh. docs/chaotic_conditions.md explains "
        "the test."
    )
    return Table(heads, rows, (note,), "", name, kinds, dense=True)


def verdicts_of(found: list[dict]) -> Table:
    """The same for the terminal: the largest bound of each model, and its verdict."""
    heads = ("condition", "model", "neighbours", Column("bound", "margins", ".2g"), "verdict")
    rows = [
        (item["condition"], own["title"], item["neighbours"], _worst(own)[4], own["verdict"])
        for item in found
        for own in item["models"].values()
    ]
    title = (
        "Conditions judged as distributions over neighbours. Both models run on the coarse mesh."
    )
    return Table(heads, rows, title=title)


def kind(judgement: str) -> str:
    """Look of a row with this word."""
    return {
        "agrees": "good",
        "agrees as distribution": "good",
        "misses": "bad",
    }.get(judgement, "doubt")


def _worst(own: dict) -> tuple:
    if not own["comparisons"]:
        return (None,) * 6
    item = max(own["comparisons"], key=_bound)
    return (
        f"{item['axis']}, {100.0 * item['share']:g} %",
        item["reference_deg_s"],
        item["difference_deg_s"],
        item["margin_deg_s"],
        _bound(item),
        item["width"],
    )


def _bound(item: dict) -> float:
    return max(abs(item["low"]), abs(item["high"]))


def quantiles(found: list[dict]) -> Table:
    """All quantiles of all models."""
    columns: Cells = (
        ("condition", "condition"),
        ("model", "title"),
        ("rate", "axis"),
        (Column("quantile", "%", "g", 100.0), "share"),
        (Column("reference", "deg/s"), "reference_deg_s"),
        (Column("surrogate", "deg/s"), "surrogate_deg_s"),
        (Column("difference, lower bound", "margins", "+.2g"), "low"),
        (Column("upper bound", "margins", "+.2g"), "high"),
        (Column("reference known within", "margins", ".2g"), "width"),
        (Column("weight of pairs", form=".2f"), "weight"),
    )
    rows = [
        {"condition": item["condition"], "title": own["title"], **one}
        for item in found
        for own in item["models"].values()
        for one in own["comparisons"]
    ]
    return Table.of(rows, columns, dense=True)
