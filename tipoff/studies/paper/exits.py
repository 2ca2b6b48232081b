"""What the best set leaves its rail with on the paper's five conditions: the rates, and what the
paper prints no number of."""

import math

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies import published
from tipoff.studies.paper import misfit
from tipoff.studies.populations import answers

CALIBRATION = (
    "The contact law has the stiffness, damping and depth that the paper prints; nothing "
    "is calibrated."
)
_RADIAL = "thrust_offset.misalignment.radial"


def run(launcher: misfit.Launcher, shares: np.ndarray) -> Columns:
    """The five conditions at ``shares`` (p,). Raises SceneError where no such body or rail can
    be."""
    rows = [{_RADIAL: math.radians(radial)} for _, radial in published.angles().values()]
    jobs = Family(launcher.scene(shares), None, launcher.numerics).jobs(rows)
    cases = dict(pair for job in jobs for pair in job())
    return columns.of([cases[number] for number in range(len(rows))])


def summary(left: Columns) -> dict:
    """``conditions`` with what each ``left`` its rail with, None where it did not settle, and where
    the constants of contact come from."""
    rows = []
    for place, (condition, (_, radial)) in enumerate(published.angles().items()):
        values = {item.name: float(item.of(left)[place]) for item in answers.ALL}
        rows.append(
            {
                "condition": condition,
                "radial_misalignment_deg": radial,
                "status": columns.STATUSES[left.status[place]],
                **{name: value if math.isfinite(value) else None for name, value in values.items()},
            }
        )
    return {"conditions": rows, "calibration": CALIBRATION}


def lines(found: dict) -> list[str]:
    """A quantity a line, its values by condition."""
    rows = found["conditions"]
    ended = ", ".join(
        f"{row['condition']} ({row['radial_misalignment_deg']:g} deg{_odd(row)})" for row in rows
    )
    text = [f"  at exit       best set on conditions {ended}; the paper prints rates only"]
    for item in answers.ALL:
        values = "".join(
            f"{'–' if row[item.name] is None else format(row[item.name], '.4g'):>11}"
            for row in rows
        )
        text.append(f"    {item.label:30}{values} {item.unit}")
    return [*text, f"    {found['calibration']}"]


def _odd(row: dict) -> str:
    return "" if row["status"] == "exited" else f", {row['status'].replace('_', ' ')}"
