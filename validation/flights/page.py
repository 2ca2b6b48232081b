"""Tables and the figure of the measured launches."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tipoff.workspace import machine
from validation.flights.compare import Flight

_COLUMNS = ("no play", "springs", "pin")
TITLES = {
    "psas_l12": "Launch 12, Portland State Aerospace Society, 2015",
    "hedy_2025": "Hedy, TU Wien Space Team, 2025",
}


def parts(found: dict) -> list[str]:
    """The tables for the terminal."""
    return [table(flight) for flight in found["flights"]]


def table(flight: dict) -> str:
    """The table of a flight in Markdown: every comparison. A model whose 95 % range does not contain the
    measured value has the word ``refused`` beside its range."""
    head = ["quantity", "unit", "measured", "compliant", "share below", *_COLUMNS]
    lines = [" | ".join(head), " | ".join(["---"] * len(head))]
    for row in flight["rows"]:
        spread = f" ± {row['uncertainty']:.2g}" if row["uncertainty"] is not None else ""
        cells = [
            row["quantity"],
            row["unit"],
            f"{row['measured']:.3g}{spread}",
            _range(row, "compliant"),
            f"{row['rank']:.3f}",
            *(_range(row, model) for model in _COLUMNS),
        ]
        lines.append(" | ".join(cells))
    return "\n".join(f"| {line} |" for line in lines)


def _range(row: dict, model: str) -> str:
    ends = row["ranges"].get(model)
    if ends is None:
        return "no run"
    return f"{ends[0]:.3g} to {ends[2]:.3g}" + ("" if row["inside"][model] else ", refused")


def figure(found: Sequence[Flight], path: Path) -> None:
    """Measured rates over time, and the 95 % range of ``compliant``."""
    from matplotlib.figure import Figure

    drawn = Figure(figsize=(12, 7), layout="constrained")
    axes = drawn.subplots(3, len(found), squeeze=False)
    for column, flight in enumerate(found):
        own = flight.own
        shown = (own.time >= -0.03) & (own.time <= own.exit[1] + 0.06)
        time = 1e3 * own.time[shown]
        for axis, name in enumerate("xyz"):
            here = axes[axis][column]
            low, high = np.degrees(flight.band[shown, :, axis]).T
            here.fill_between(time, low, high, alpha=0.35, label="predicted, 95 % of launches")
            here.plot(time, np.degrees(own.rate[shown, axis]), "k", lw=0.9, label="measured")
            here.axvspan(*(1e3 * np.array(own.exit)), color="tab:orange", alpha=0.3, label="exit")
            here.set_ylabel(f"rate {name}, deg/s")
            here.grid(alpha=0.3)
        axes[0][column].set_title(TITLES[own.launcher.name], fontsize=10)
        axes[2][column].set_xlabel("time from the start, ms")
    axes[0][0].legend(fontsize=8)
    made = machine.stated(machine.state())
    drawn.supxlabel(made, x=0.995, horizontalalignment="right", fontsize=7, color="grey")
    path.parent.mkdir(parents=True, exist_ok=True)
    drawn.savefig(path, dpi=110)
