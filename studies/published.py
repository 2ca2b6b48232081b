"""Numbers of the paper that this project starts from, where a study sets its own beside them.

Jin, Ma, Yang, Wu, Tan and Tao, "Rapid Modeling Method and Analysis of Factors Affecting the Dynamics of On-Orbit Launch Systems for
Micro-Spacecraft", Aerospace 2026, 13, 541, https://doi.org/10.3390/aerospace13060541. Its scene is not ours: it prints no geometry,
thrust or inertia.
"""

import csv
from pathlib import Path
from typing import NamedTuple

CITATION = "Jin et al., Aerospace 2026, 13, 541"
CONDITIONS = {"phi15": 2, "phi35": 3, "phi60": 4}  # of Table 2, by the name of the same misalignment in the catalogue
PLATEAUS = {"misalignment": 0.4, "thrust_eccentricity": 0.6, "mass_eccentricity": 0.4}  # deg, mm, mm: sections 3.1 to 3.3
_TABLE_2 = Path(__file__).parent / "data" / "table2_sensitivity.csv"


class Changed(NamedTuple):
    """A row of Table 2: the condition's number, ``symbol`` of the constant, whether it was raised (None: nothing was changed), and
    the settled rates about x, y, z in deg/s."""

    condition: int
    symbol: str
    raised: bool | None
    rates: tuple[float, float, float]


def table_2() -> list[Changed]:
    """The rows of Table 2 in their order."""
    with open(_TABLE_2, encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    found, seen = [], set()
    for row in rows:
        place = row["condition"], row["parameter"]
        raised = None if row["parameter"] == "baseline" else place in seen  # the lower value comes first
        seen.add(place)
        rates = tuple(float(row[f"omega_{axis}_deg_s"]) for axis in "xyz")
        found.append(Changed(int(row["condition"]), row["parameter"], raised, rates))
    return found
