"""Which numbers the answer depends on, on the page: the paper's Table 2 beside ours, and Sobol'
indices of every quantity."""

from dataclasses import replace

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
from tipoff.studies.render.document import Bullets, Figure, Fold, Heading, Part
from tipoff.studies.render.table import Column, Table, span

_RATES = ("rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s", "rate_deg_s")
_STILL = 1e-6  # deg/s; the tables are of runs at a relative tolerance of 2e-7
_DRAWN = 8  # inputs with bars
# of inputs whose convergence is drawn
_LINES = ((NAVY, "-", "o"), (VERMILION, "--", "s"), (AMBER, "-.", "^"), (TEAL, ":", "D"))
_NAMES = {
    "contact.stiffness": "contact stiffness",
    "contact.exponent": "contact exponent",
    "contact.damping": "contact damping",
    "contact.damping_depth": "depth of full damping",
    "contact.penalty": "penalty of the walls",
    "contact.clearance": "clearance",
    "friction.dynamic": "friction",
    "thrust.peak": "thrust peak",
    "thrust_offset.misalignment": "misalignment",
    "thrust_offset.eccentricity": "thrust eccentricity",
    "mass_offset.eccentricity": "mass eccentricity",
    "payload.inertia": "inertia",
    "initial.position": "initial position",
}
_BARS = (
    "First-order index (pale, hatched): the share of the variance that would go if this input were "
    "known. Total index (dark): "
    "what would stay if all others were. The difference is what it does together with others. "
    "Whiskers: 95 %, bootstrap."
)
_MAP = (
    "Total indices of every quantity: a row of large numbers is an input worth a closer tolerance. "
    "Half widths of the 95 % "
    "intervals are in sensitivity.json."
)
_CONVERGENCE = (
    "Total indices of the four largest inputs from the first parts of the same points: what more "
    "points would still "
    "change."
)
_TABLE = (
    "A share says nothing of a rate that is nearly zero, here below a twentieth of the total, and "
    "is left out. The paper's "
    "shares are computed from its Table 2; its text gives 0.26 % as the largest about z, its table "
    "0.71 %. Its scene, and so "
    "its rates, are not ours."
)
_MOVED = (
    Column("rates x, y, z", "deg/s", ".3f"),
    Column("moved by", "deg/s", ".2g"),
    Column("moved by", "%", ".2g", 100.0),
)
_HEADS = ("condition", "changed", *_MOVED, replace(_MOVED[0], title="paper: rates"), *_MOVED[1:])


def name_of(key: str) -> str:
    """A dotted key in words."""
    head, _, last = key.rpartition(".")
    return _NAMES.get(key) or (f"{_NAMES[head]} {last}" if head in _NAMES else key)


def pictures(found: dict) -> list[tuple[Chart | Picture, str]]:
    """Every figure of the study and its caption."""
    sobol = found["sobol"]
    shown = [item for item in sobol["quantities"] if item["indices"]]
    rates = [item for item in shown if item["name"] in _RATES]
    if not rates:
        return []
    return [
        (_bars(sobol, rates), _BARS),
        (_map(sobol, shown), _MAP),
        (_convergence(sobol, rates), _CONVERGENCE),
    ]


def draw(found: dict) -> list[Part]:
    """The section: tables of contact constants, then indices."""
    # The map shows what a quantity depends on most; the summary would repeat it.
    lines = [line for line in found["summary"] if "total index" not in line]
    tables = [_beside_paper(item, found["paper"]) for item in found["tables"]]
    return [
        Bullets(lines),
        *([Heading("Contact constants, one at a time")] if tables else []),
        *tables,
        Heading("Everything at once"),
        *(Figure(*item) for item in pictures(found)),
        *_inputs(found["sobol"]),
    ]


def _beside_paper(item: dict, paper: dict) -> Table:
    """Rows of ours and, where the condition is one of the paper's, its own."""
    theirs = {(row["condition"], row["symbol"], row["raised"]): row for row in paper["rows"]}
    rows: list[tuple] = [
        (*_ours(row), *_theirs(theirs.get((row["condition"], row["symbol"], row["raised"]))))
        for row in item["rows"]
    ]
    constants = ", ".join(f"{key} {value:.4g}" for key, value in item["constants_si"].items())
    rows += [
        ("largest", "", "", *_moved(item["largest"]), "", *_moved(paper["largest"])),
        ("largest", "clearance", "", *_moved(item["largest_clearance"]), "", "", ""),
    ]
    symbols = dict.fromkeys(row["symbol"] for row in item["rows"] if row["raised"] is not None)
    idle = [
        symbol
        for symbol in symbols
        if all(_still(row) for row in item["rows"] if row["symbol"] == symbol)
    ]
    words = (
        f" Nothing moves with {' or '.join(idle)}: at these constants it has no effect."
        if idle
        else ""
    )
    title = f"{item['title'].capitalize()}: {item['law']}, SI: {constants}.{words}"
    return Table(_HEADS, rows, (_TABLE,), title, dense=True)


def _ours(row: dict) -> tuple:
    if row["raised"] is None:
        changed = "nothing"
    elif row["symbol"] == "clearance":
        changed = "clearance +1 µm"
    else:
        changed = f"{row['symbol']} {'+' if row['raised'] else '-'}{100.0 * row['share']:.3g} %"
    return row["condition"], changed, *_rates(row)


def _theirs(row: dict | None) -> tuple:
    return ("", "", "") if row is None else _rates(row)


def _rates(row: dict) -> tuple:
    return row["rate_deg_s"], *(_moved(row) if row["raised"] is not None else ("", ""))


def _still(row: dict) -> bool:
    """Whether nothing moved by more than errors of integration."""
    return row["absolute_deg_s"] is not None and max(map(abs, row["absolute_deg_s"])) < _STILL


def _moved(row: dict) -> tuple:
    if None not in (row["absolute_deg_s"] or [None]) and _still(row):
        return "0", "0"
    return row["absolute_deg_s"], row["relative"]


def _inputs(sobol: dict) -> list[Part]:
    """What varied, how far, and by which provenance; what did not."""
    rows = [
        (
            name_of(item["key"]),
            item["distribution"] + (" factor" if item["factor"] else ""),
            item["nominal"],
            span(item["low"], item["high"], ".4g"),
            item["unit"] or "SI",
            item["provenance"],
        )
        for item in sobol["inputs"]
    ]
    left = [f"{name_of(key)}: {why}" for key, why in sobol["left_out"].items()]
    spread = [
        (
            item["label"],
            item["mean"],
            item["sd"],
            item["unit"],
            item["indices"] and sum(item["indices"]["first"]),
        )
        for item in sobol["quantities"]
    ]
    heads = (
        "quantity",
        "mean",
        "sd",
        "unit",
        Column("sum of first-order indices", "%", scale=100.0),
    )
    varied = Table(
        (
            "input",
            "distribution",
            Column("nominal", form=".4g"),
            "95 % within",
            "unit",
            "provenance",
        ),
        rows,
        dense=True,
    )
    return [
        "A base point with a case that does not settle is left out with all of its cases, so the "
        f"indices hold for launches that leave the rail: {sobol['used']:,} of "
        f"{sobol['base_points']:,} were used.",
        Table(
            heads,
            spread,
            (
                "The sum is what goes by knowing each input alone; below zero it is error of "
                "sampling (see the whiskers).",
            ),
        ),
        Fold("what varied", [varied, "Left out:" if left else "", Bullets(left)]),
    ]


def _bars(sobol: dict, rates: list[dict]) -> Picture:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 7.4), dpi=130, layout="constrained")
    for axes, item in zip(figure.subplots(2, 2).flat, rates):
        values = {name: np.array(values) for name, values in item["indices"].items()}
        order = np.argsort(values["total"])[::-1][:_DRAWN][::-1]
        place = np.arange(len(order))
        axes.barh(
            place + 0.2,
            values["total"][order],
            0.38,
            xerr=values["total_half_width"][order],
            color=NAVY,
            label="total",
            ecolor=GREY,
            capsize=2,
        )
        axes.barh(
            place - 0.2,
            values["first"][order],
            0.38,
            xerr=values["first_half_width"][order],
            color="#d5dae0",
            hatch="//",
            edgecolor=GREY,
            linewidth=0.5,
            label="first order",
            ecolor=GREY,
            capsize=2,
        )
        axes.set_yticks(place, [name_of(sobol["inputs"][n]["key"]) for n in order], fontsize=8.5)
        axes.set_title(f"{item['label']}, sd {item['sd']:.3g} {item['unit']}", fontsize=10.5)
        axes.set_xlabel("Sobol' index", fontsize=9.5)
        axes.set_xlim(
            1.08 * min(0.0, float((values["first"] - values["first_half_width"])[order].min())),
            None,
        )
        axes.grid(axis="x", color="#e3e6ea")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    figure.legend(
        *axes.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=2,
        frameon=False,
        fontsize=9,
    )
    return Picture("sensitivity-indices", figure)


def _map(sobol: dict, shown: list[dict]) -> Picture:
    from matplotlib.figure import Figure

    totals = np.array([item["indices"]["total"] for item in shown]).T
    order = np.argsort(-totals.max(axis=1))
    figure = Figure(figsize=(9.6, 0.33 * len(order) + 2.0), dpi=130, layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(totals[order], cmap="Greys", vmin=0.0, vmax=1.0, aspect="auto")
    for (row, column), value in np.ndenumerate(totals[order]):
        axes.text(
            column,
            row,
            f"{value:.2f}",
            ha="center",
            va="center",
            fontsize=8,
            color="white" if value > 0.55 else "black",
        )
    axes.set_yticks(
        range(len(order)), [name_of(sobol["inputs"][n]["key"]) for n in order], fontsize=8.5
    )
    axes.set_xticks(
        range(len(shown)), [item["label"] for item in shown], rotation=30, ha="right", fontsize=8.5
    )
    figure.colorbar(image, label="total Sobol' index", pad=0.02)
    return Picture("sensitivity-map", figure)


def _convergence(sobol: dict, rates: list[dict]) -> Chart:
    """The same inputs in every panel: those with the largest indices over all of them."""
    most = np.argsort(np.mean([item["indices"]["total"] for item in rates], axis=0))[::-1][
        : len(_LINES)
    ]
    panels = []
    for item in rates:
        steps = [step for step in item["convergence"] if "total" in step]
        lines = [
            Line(
                [step["base_points"] for step in steps],
                [step["total"][n] for step in steps],
                name_of(sobol["inputs"][n]["key"]),
                colour,
                1.6,
                dash,
                marker=marker,
            )
            for n, (colour, dash, marker) in zip(most, _LINES)
        ]
        panels.append(Panel(item["label"], "base points", "total Sobol' index", lines))
    return Chart("sensitivity-convergence", panels, columns=2, height=280)
