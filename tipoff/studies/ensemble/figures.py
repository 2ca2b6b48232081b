"""Figures of an ensemble: its rates about each axis with their limits, and what halving each tolerance
gains."""

from collections.abc import Sequence

import numpy as np

from tipoff.studies.ensemble.halves import SHARE, Halved
from tipoff.studies.populations import exceedance
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.paired import Bounded
from tipoff.studies.render.chart import Picture
from tipoff.studies.render.palette import AXIS_COLOURS, GREY, INK, NAVY, RULE, TEAL, VERMILION

_BINS = 60


def of_rates(rates: np.ndarray, limits: Sequence[Limit], at: str) -> Picture:
    """The distributions of ``rates`` (n,3), deg/s, of the cases that have one, about each axis and in total,
    with the ``limits`` as lines; ``at``: the instant in words."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 5.6), dpi=130, layout="constrained")
    columns = [*rates.T, np.linalg.norm(rates, axis=1)]
    for place, (axis, values) in enumerate(zip((*"xyz", exceedance.TOTAL), columns)):
        axes = figure.add_subplot(2, 2, place + 1)
        shares = np.full(len(values), 100.0 / len(values))
        axes.hist(values, _BINS, weights=shares, color=AXIS_COLOURS.get(axis, TEAL))
        own = [limit.deg_s for limit in limits if limit.axis == axis]
        for limit in own:
            for end in (limit,) if axis == exceedance.TOTAL else (-limit, limit):
                axes.axvline(end, color=INK, linestyle="--", linewidth=1.2)
        name = "total rate" if axis == exceedance.TOTAL else f"rate about {axis}"
        limited = f", limit {', '.join(f'{limit:g}' for limit in own)}" if own else ""
        axes.set_xlabel(f"{name} (deg/s){limited}", fontsize=9.5)
        axes.set_ylabel("cases (%)", fontsize=9.5)
        _plain(axes, "y")
    figure.suptitle(f"{len(rates):,} cases, rates {at}", fontsize=10.5)
    return Picture("rates", figure)


def _plain(axes, grid: str) -> None:
    axes.grid(axis=grid, color=RULE)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8.5)
    axes.spines[["top", "right"]].set_visible(False)


def of_halves(rows: Sequence[Halved], limits: Sequence[str]) -> Picture:
    """The quantile of the total rate with each tolerance halved, and the share of the cases above the
    ``limits``. The bar of a row is the bounds of its change, from the line of the errors as stated."""
    from matplotlib.figure import Figure

    stated, *own = rows
    panels = [
        (
            f"{100.0 * SHARE:g} % quantile of the total rate (deg/s)",
            stated.rate.value,
            [row.rate.value for row in own],
            [row.rate_change for row in own],
            1.0,
        )
    ]
    if stated.above is not None:
        shares = [row.above.value for row in own if row.above is not None]
        words = f"cases above {' or '.join(limits)} (%)"
        panels.append((words, stated.above.value, shares, [row.above_change for row in own], 100.0))
    height = 0.42 * len(own) + 1.5
    figure = Figure(figsize=(4.6 * len(panels) + 1.6, height), dpi=130, layout="constrained")
    places = np.arange(len(own))[::-1]
    for place, (words, before, values, changes, scale) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), place + 1)
        axes.axvline(scale * before, color=GREY, linestyle="--", linewidth=1.2)
        for y, value, change in zip(places, values, changes):
            _row(axes, y, scale * before, scale * value, change, scale)
        axes.annotate(
            "as stated",
            (scale * before, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8.5,
            color=GREY,
        )
        axes.set_yticks(places, [f"half of {row.tolerance}" if not place else "" for row in own])
        axes.set_ylim(-0.6, len(own) - 0.4)
        axes.set_xlabel(words, fontsize=9.5)
        _plain(axes, "x")
    return Picture("halved", figure)


def _row(axes, y: float, before: float, value: float, change: Bounded | None, scale: float) -> None:
    """A point at the ``value`` with the bounds of its ``change`` from the value ``before``."""
    colour = NAVY if value <= before else VERMILION
    axes.plot([before, value], [y, y], color=colour, linewidth=4.0, alpha=0.35)
    if change is not None and change.low is not None and change.high is not None:
        ends = [before + scale * change.low, before + scale * change.high]
        axes.plot(ends, [y, y], color=colour, linewidth=1.4, marker="|", markersize=9)
    axes.plot(value, y, color=colour, marker="o", markersize=5)
