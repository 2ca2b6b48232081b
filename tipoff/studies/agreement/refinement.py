"""Uncertainty of the reference by its own refinements: mesh, step, contact cells.

Each is refined alone, and the settled rates are extrapolated with the order that they show
(``comparison.extrapolation``). The uncertainty is that of the run which every other stage uses:
the mesh of the scene; for step and cells, which are refined further on the coarse mesh, that of the
finest run and the distance to it. A mesh file that cannot be coarsened is refined instead.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tipoff.comparison.extrapolation import Estimate, estimate
from tipoff.comparison.metrics import compare
from tipoff.mechanics.trajectory import Trajectory

MESH, STEP, CELLS = "mesh", "step", "cells"


@dataclass(frozen=True)
class Refinement:
    """Refinement of one ``cause`` on one condition: ``sizes``, coarsest first, and of the last two
    runs the change of both metrics; ``uncertainty_deg_s`` of the settled rates, None where it is
    not known; ``order`` and ``method`` of the axis with the largest."""

    condition: str
    model: str
    cause: str
    sizes: list[float]
    rate_relative_l2: float | None
    settled_rate_change_deg_s: float | None
    uncertainty_deg_s: float | None
    order: float | None
    method: str


def refinement(
    condition: str, cause: str, sizes: Sequence[float], runs: Sequence[Trajectory], used: int
) -> Refinement:
    """Uncertainty of the run number ``used`` of the ``runs`` of the reference at falling ``sizes``
    in any unit."""
    last = compare(runs[-1], runs[-2]) if len(runs) > 1 else None
    uncertainty, found = _largest(sizes, runs, used)
    return Refinement(
        condition,
        "reference",
        cause,
        list(sizes),
        last.rate_relative_l2 if last else None,
        last.settled_rate_error_deg_s if last else None,
        uncertainty,
        found.order,
        found.method,
    )


def _largest(
    sizes: Sequence[float], runs: Sequence[Trajectory], used: int
) -> tuple[float | None, Estimate]:
    """Uncertainty (deg/s) of the axis that has the largest, and its estimate."""
    rates = [run.outcome.rate for run in runs]
    if any(rate is None for rate in rates):
        return None, estimate(sizes, [None] * len(sizes))
    columns = np.degrees(np.array(rates, dtype=float)).T.tolist()
    found = [estimate(sizes, column) for column in columns]
    total = [
        None if item.uncertainty is None else item.uncertainty + abs(column[used] - column[-1])
        for item, column in zip(found, columns)
    ]
    worst = max(range(len(found)), key=lambda axis: _or_infinite(total[axis]))
    return total[worst], found[worst]


def _or_infinite(value: float | None) -> float:
    return math.inf if value is None else value
