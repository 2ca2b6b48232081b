"""The sensitivity of the result: contact constants, and Sobol' indices of every quantity."""

import math
from itertools import chain
from operator import attrgetter
from typing import Any

import numpy as np

from tipoff.scenes import halving
from tipoff.studies.populations import answers, population
from tipoff.studies.render.chart import Chart, Line, Panel, Picture
from tipoff.studies.render.document import Bullets, Figure, Fold, Heading, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table
from tipoff.studies.sensitivity.contact_table import Axes, PerturbedRun
from tipoff.studies.sensitivity.indices import Indices
from tipoff.studies.sensitivity.results import Constants, Sensitivity, Shares, Sobol
from tipoff.uncertain import Measured, number, uncertain
from tipoff.workspace.words import counted

_Indexed = list[tuple[Shares, Indices]]

_RATES = ("rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s", "rate_deg_s")
_STILL = 1e-6  # deg/s, the error of integration at the relative tolerance of the tables, 2e-7
_DRAWN = 8  # inputs in each bar chart
# lines of the inputs whose convergence is drawn
_LINES = ((NAVY, "-", "o"), (VERMILION, "--", "s"), (AMBER, "-.", "^"), (TEAL, ":", "D"))
_NAMES = {
    "contact.stiffness": "contact stiffness",
    "contact.exponent": "contact exponent",
    "contact.damping": "contact damping",
    "contact.damping_depth": "depth of full damping",
    "contact.interface_stiffness": "interface stiffness of the walls",
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
    "First-order index (pale, hatched): the share of the variance that this input causes alone. "
    "Total index (dark): its share with all interactions. Whiskers: 95 % intervals, bootstrap."
)
_MAP = (
    "Total Sobol' index of each input (row) for each quantity (column); ? where it is not above the half "
    "width of its 95 % interval, which is in sensitivity.json."
)
_CONVERGENCE = (
    "Total indices of the four largest inputs against the number of base points. A flat line shows "
    "that more points would change little."
)
_TABLE = "No percentage is given for a rate below a twentieth of the total rate."
_LARGEST = (
    "Largest change over all conditions when one contact constant changes, and when the clearance "
    "is 1 µm larger. Percentages leave out rates below a twentieth of the total rate."
)
_INDICES = (
    "Mean, standard deviation, sum of the first-order indices, and the three inputs with the "
    "largest total index, each with the half width of its 95 % interval. A sum below 100 % shows "
    "interactions. A value that is not above its half width is not resolved: its half width shrinks "
    "with the square root of --points."
)
_UNRESOLVED = "not resolved"
_MOVED = (
    Column("rates x, y, z", "deg/s", ".3f"),
    Column("change", "deg/s", ".2g"),
    Column("change", "%", ".2g", 100.0),
)
_SHOWN = 3  # inputs in the table of indices
_BAR_LOOKS: tuple[tuple[float, str, str, dict[str, Any]], ...] = (
    (0.2, "total", "total", {"color": NAVY}),
    (
        -0.2,
        "first",
        "first order",
        {"color": "#d5dae0", "hatch": "//", "edgecolor": GREY, "linewidth": 0.5},
    ),
)


def name_of(key: str) -> str:
    """The name of a dotted key for a reader."""
    head, _, last = key.rpartition(".")
    return _NAMES.get(key) or (f"{_NAMES[head]} {last}" if head in _NAMES else key)


def figures(found: Sensitivity) -> list[Figure]:
    """Every figure of the study and its caption."""
    sobol = found.sobol
    shown = [(item, item.indices) for item in sobol.quantities if item.indices]
    rates = [(item, own) for item, own in shown if item.name in _RATES]
    if not rates:
        return []
    return [
        Figure(lambda: _bars(sobol, rates), _BARS),
        Figure(lambda: _map(sobol, shown), _MAP),
        Figure(lambda: _convergence(sobol, rates), _CONVERGENCE),
    ]


def draw(found: Sensitivity) -> list[Part]:
    """The section: tables of contact constants, then indices."""
    changes = [_each_change(item) for item in found.tables]
    return [
        Bullets([population.model_line(found)]),
        *([Heading("One contact constant at a time")] if found.tables else []),
        *(table_of_largest(item) for item in found.tables),
        *([Fold("Each change", changes)] if changes else []),
        Heading("All inputs together"),
        _used(found.sobol),
        table_of_indices(found.sobol),
        *figures(found),
        *_inputs(found.sobol),
    ]


def table_of_largest(item: Constants) -> Table:
    """The largest change of each quantity by a contact constant, and by the clearance."""
    sources = (item.largest, item.largest_clearance)
    nothing: Axes = (None, None, None)
    rows: list[tuple] = []
    for place, quantity in enumerate(answers.ALL):
        name = quantity.title
        if place >= len(answers.RATES):
            rows.append((name, item.most_moved.get(quantity.name), *[""] * 3))
            continue
        changes = [
            (_change((found.absolute_deg_s or nothing)[place]), (found.relative or nothing)[place])
            for found in sources
        ]
        rows.append((name, *chain.from_iterable(changes)))
    heads = ("contact constants", "clearance")
    columns = [(Column(head), Column("%", "", ".2g", 100.0)) for head in heads]
    title = f"Largest change of each quantity, {item.title}"
    return Table(["quantity", *chain.from_iterable(columns)], rows, notes=(_LARGEST,), title=title)


def _change(value: float | None) -> float | str | None:
    """A change of a rate, deg/s, without errors of integration."""
    return "0" if value is not None and abs(value) < _STILL else value


def _used(sobol: Sobol) -> str:
    """The number of cases of the indices."""
    return (
        f"{sobol.cases['asked']:,} cases of {counted(len(sobol.inputs), 'input')}, "
        f"{sobol.not_settled:,} did not settle; {sobol.used:,} of {sobol.base_points:,} "
        "base points used. A base point is left out if one of its cases did not settle."
    )


def table_of_indices(sobol: Sobol) -> Table:
    """Spread, sum of the first-order indices and largest total indices of each quantity."""

    def mean(item: Shares) -> Any:
        error = item.sd / math.sqrt(sobol.used)
        return Measured(item.mean, error, apart=True) if item.sd else item.mean

    def most(item: Shares) -> str | None:
        if item.indices is None:
            return None
        totals, errors = item.indices.total, item.indices.total_half_width
        order = np.argsort(totals)[::-1][:_SHOWN]
        named = [
            f"{name_of(sobol.inputs[n].key)} {uncertain(totals[n], errors[n], 0.01)}"
            for n in order
            if totals[n] > errors[n]
        ]
        return ", ".join(named) or _UNRESOLVED

    def first(item: Shares) -> Any:
        error = item.first_sum_half_width
        if item.indices is None or error is None:
            return None
        total = sum(item.indices.first)
        if total <= error:
            return f"{_UNRESOLVED} (± {number(100.0 * error, '.2g')})"
        return Measured(total, error)

    return Table.of_records(
        sobol.quantities,
        ("quantity", lambda item: item.title),
        ("mean", mean),
        ("sd", attrgetter("sd")),
        (Column("first order", "%", scale=100.0), first),
        ("largest total indices", most),
        notes=(_INDICES,),
    )


def _each_change(item: Constants) -> Table:
    """One row for each change."""
    rows = [(row.condition, _changed(row), *_moved(row)) for row in item.rows]
    constants = ", ".join(f"{key} {value:.4g}" for key, value in item.constants_si.items())
    symbols = dict.fromkeys(row.symbol for row in item.rows if row.raised is not None)
    idle = [
        symbol
        for symbol in symbols
        if all(_still(row) for row in item.rows if row.symbol == symbol)
    ]
    without = f" No rate changes with {' or '.join(idle)}." if idle else ""
    title = f"{item.title.capitalize()}: {item.law}, SI: {constants}.{without}"
    heads = ("condition", "changed", *_MOVED)
    return Table(heads, rows, notes=(_TABLE,), title=title, dense=True)


def _changed(row: PerturbedRun) -> str:
    if row.raised is None or row.share is None:
        return "nothing"
    if row.symbol == "clearance":
        return "clearance +1 µm"
    return f"{row.symbol} {'+' if row.raised else '-'}{100.0 * row.share:.3g} %"


def _moved(row: PerturbedRun) -> tuple:
    """Rates and their changes; none for the baseline."""
    if row.raised is None:
        return row.rate_deg_s, "", ""
    return row.rate_deg_s, *(("0", "0") if _still(row) else (row.absolute_deg_s, row.relative))


def _still(row: PerturbedRun) -> bool:
    """Whether no rate changed by more than errors of integration."""
    return row.absolute_deg_s is not None and all(
        abs(each or 0.0) < _STILL for each in row.absolute_deg_s
    )


def _inputs(sobol: Sobol) -> list[Part]:
    """The inputs that vary with their sizes, distributions and provenance, and those that do not."""
    left = [f"{name_of(key)}: {reason}" for key, reason in sobol.left_out.items()]
    table = Table.of_records(
        sobol.inputs,
        ("input", lambda item: name_of(item.key)),
        ("distribution", lambda item: item.distribution + (" factor" if item.factor else "")),
        ("95 % of its values", lambda item: halving.shown(item.low, item.high, item.unit)),
        "provenance",
        dense=True,
    )
    return [table, "Left out:", Bullets(left)] if left else [table]


def _bars(sobol: Sobol, rates: _Indexed) -> Picture:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 7.4), dpi=130, layout="constrained")
    for axes, (item, own) in zip(figure.subplots(2, 2).flat, rates):
        values = {name: np.array(values) for name, values in vars(own).items()}
        order = np.argsort(values["total"])[::-1][:_DRAWN][::-1]
        place = np.arange(len(order))
        for shift, name, label, look in _BAR_LOOKS:
            axes.barh(
                place + shift,
                values[name][order],
                0.38,
                xerr=values[f"{name}_half_width"][order],
                label=label,
                **(look | {"ecolor": GREY, "capsize": 2}),
            )
        axes.set_yticks(place, [name_of(sobol.inputs[n].key) for n in order], fontsize=8.5)
        axes.set_title(f"{item.label}, sd {item.sd:.3g} {item.unit}", fontsize=10.5)
        axes.set_xlabel("Sobol' index", fontsize=9.5)
        least = float((values["first"] - values["first_half_width"])[order].min())
        axes.set_xlim(1.08 * min(0.0, least), None)
        axes.grid(axis="x", color="#e3e6ea")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return Picture("sensitivity-indices", figure)


def _map(sobol: Sobol, shown: _Indexed) -> Picture:
    from matplotlib.figure import Figure

    totals = np.array([own.total for _, own in shown]).T
    errors = np.array([own.total_half_width for _, own in shown]).T
    order = np.argsort(-totals.max(axis=1))
    figure = Figure(figsize=(9.6, 0.33 * len(order) + 2.0), dpi=130, layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(totals[order], cmap="Greys", vmin=0.0, vmax=1.0, aspect="auto")
    for (row, column), value in np.ndenumerate(totals[order]):
        resolved = value > errors[order][row, column]
        colour, text = "white" if value > 0.55 else "black", f"{value:.2f}" if resolved else "?"
        axes.text(column, row, text, ha="center", va="center", fontsize=8, color=colour)
    axes.set_yticks(range(len(order)), [name_of(sobol.inputs[n].key) for n in order], fontsize=8.5)
    axes.set_xticks(
        range(len(shown)), [item.label for item, _ in shown], rotation=30, ha="right", fontsize=8.5
    )
    figure.colorbar(image, label="total Sobol' index", pad=0.02)
    return Picture("sensitivity-map", figure)


def _convergence(sobol: Sobol, rates: _Indexed) -> Chart:
    """Every panel shows the inputs with the largest mean total index over all rates."""
    order = np.argsort(np.mean([own.total for _, own in rates], axis=0))[::-1]
    panels = []
    for item, _ in rates:
        steps = [(step.base_points, step.total) for step in item.convergence if step.total]
        points = [count for count, _ in steps]
        names = [name_of(each.key) for each in sobol.inputs]
        lines = []
        for n, (colour, dash, marker) in zip(order, _LINES):
            totals = [total[n] for _, total in steps]
            lines.append(Line(points, totals, names[n], colour, dash=dash, marker=marker))
        panels.append(Panel(item.label, "base points", "total Sobol' index", lines))
    return Chart("sensitivity-convergence", panels, columns=2, height=280)
