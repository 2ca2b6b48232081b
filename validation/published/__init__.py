"""The printed tables of the paper that this project starts from, as data, and checks of their arithmetic.

Z. Jin, Z. Ma, H. Yang, S. Wu, Z. Tan, X. Tao: Rapid Modeling Method and Analysis of Factors
Affecting the Dynamics of On-Orbit Launch Systems for Micro-Spacecraft. Aerospace 13 (2026) 541, doi
10.3390/aerospace13060541. Rates in deg/s about X, Y and Z.
"""

import csv
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

_FOLDER = Path(__file__).resolve().parent
CITATION = "Jin et al., Aerospace 2026, 13, 541"
SENSITIVE = (2, 3, 4)  # conditions of Table 2
# its rows: N/mm^e, N s/mm, mm
CHANGES = (("k", 66000.0), ("k", 74000.0), ("c", 50.0), ("c", 70.0), ("d", 0.25), ("d", 0.35))
BASELINE = {"k": 70000.0, "c": 60.0, "d": 0.30}
# %, largest of x, y and z on conditions 2 and 4, section 2.3
CLAIMED_DEVIATION = (2.73, 1.47, 0.26)
NEGLIGIBLE = (1, 5)  # conditions whose rates the paper calls negligible; it prints none


class Sensitivity(NamedTuple):
    """Table 2: settled rates at the baseline (3,3), condition by axis, and with one constant
    changed (3,6,3), deg/s."""

    baseline: np.ndarray
    changed: np.ndarray

    def deviations(self) -> np.ndarray:
        """Change by each constant (3,6,3), deg/s."""
        return self.changed - self.baseline[:, None, :]

    def largest_relative(self) -> np.ndarray:
        """Largest change per axis (3,) as a fraction of the rate, on conditions 2 and 4. On
        condition 3 the rate about z is near zero."""
        share = np.abs(self.deviations() / self.baseline[:, None, :])
        return share[[0, 2]].max(axis=(0, 1))


@cache
def angles() -> dict[int, tuple[float, float]]:
    """Table 1: axial and radial misalignment (deg) by condition."""
    return {
        int(row["condition"]): (
            float(row["axial_misalignment_deg"]),
            float(row["radial_misalignment_deg"]),
        )
        for row in _rows("table1_conditions.csv")
    }


@cache
def sensitivity() -> Sensitivity:
    """Table 2."""
    rates = [
        [float(row[f"omega_{axis}_deg_s"]) for axis in "xyz"]
        for row in _rows("table2_sensitivity.csv")
    ]
    table = np.reshape(rates, (len(SENSITIVE), 1 + len(CHANGES), 3))
    return Sensitivity(table[:, 0], table[:, 1:])


@cache
def headline() -> dict[str, str]:
    """Values the text claims, by quantity, as printed."""
    return {row["quantity"]: row["value"] for row in _rows("headline.csv")}


def slips() -> list[str]:
    """Printed numbers that do not follow from the printed tables, in words."""
    largest, claimed = 100.0 * sensitivity().largest_relative()[2], CLAIMED_DEVIATION[2]
    stiffness, damping, depth = (
        100.0 * (value - BASELINE[name]) / BASELINE[name] for name, value in CHANGES[1::2]
    )
    hours, seconds = (
        float(headline()["high_fidelity_wall_time"]),
        float(headline()["low_fidelity_wall_time"]),
    )
    return [
        f"The largest relative deviation of the z rate on conditions 2 and 4 of Table 2 is "
        f"{largest:.2f} %; "
        f"the text has {claimed:.2f} %.",
        f"The stiffness is changed by {stiffness:.1f} %, damping by {damping:.1f} % and depth by "
        f"{depth:.1f} %; "
        "the text has 5 % and 15 %.",
        f"{hours:g} h over {seconds:g} s is {3600.0 * hours / seconds:,.0f}; the text has "
        f"{float(headline()['speedup']):,.0f}.",
    ]


def _rows(name: str) -> list[dict[str, str]]:
    with open(_FOLDER / name, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))
