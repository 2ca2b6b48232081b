"""Exit state with the best set on the paper's five conditions: the rates, and quantities that the
paper does not print."""

import math

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.populations import answers
from validation import published
from validation.paper import misfit

CALIBRATION = (
    "The contact law has the stiffness, damping and depth that the paper prints; nothing "
    "is calibrated."
)
_RADIAL = "thrust_offset.misalignment.radial"


def run(launcher: misfit.Launcher, shares: np.ndarray) -> Columns:
    """The five conditions at ``shares`` (p,). Raises SceneError for an impossible body or rail."""
    rows = [{_RADIAL: math.radians(radial)} for _, radial in published.angles().values()]
    jobs = Family(launcher.scene(shares), None, launcher.numerics).jobs(rows)
    cases = dict(pair for job in jobs for pair in job())
    return columns.of_cases([cases[number] for number in range(len(rows))])


def summary(left: Columns) -> dict:
    """``conditions`` with the exit state ``left`` of each, None if it did not settle, and
    ``calibration``, the origin of the contact constants."""
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
