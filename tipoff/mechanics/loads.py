"""Largest load of each guide in a run: rows that the kernels of both solvers fill, and their arrays."""

from typing import Any

import numpy as np

from tipoff.kernels.jit import kernel

# Columns of a row: time (s), square of the force (N2), force (N) and its moment about the payload's mass
# centre (N m), both in body axes.
TIME, SQUARE, FORCE, MOMENT, LOAD_SIZE = 0, 1, 2, 5, 8


# Rows of the largest loads, of the present instant, and of the two before it.
LARGEST, NOW, LAST, BEFORE = range(4)


def none(guides: int) -> np.ndarray:
    """Rows (4, ``guides``, LOAD_SIZE) of no load."""
    return np.zeros((4, guides, LOAD_SIZE))


@kernel
def clear(loads):
    """Begin the rows of an instant."""
    for i in range(loads.shape[1]):
        for j in range(LOAD_SIZE):
            loads[NOW, i, j] = 0.0


@kernel
def add(loads, guide, force, moment):
    """Add a ``force`` (N) on a ``guide`` and its ``moment`` (N m) to the rows of an instant."""
    for i in range(3):
        loads[NOW, guide, FORCE + i] += force[i]
        loads[NOW, guide, MOMENT + i] += moment[i]


@kernel
def last(loads):
    """Time (s) of the last instant that was taken."""
    return loads[LAST, 0, TIME]


@kernel
def take(loads, time):
    """Keep the rows of the instant ``time`` (s) that are larger than the largest ones so far, and the peaks
    of parabolas through the last three instants."""
    for guide in range(loads.shape[1]):
        row = loads[NOW, guide]
        row[TIME], row[SQUARE] = time, _square(row)
        _keep(row, loads[LARGEST, guide])
        if row[SQUARE] < loads[LAST, guide, SQUARE] >= loads[BEFORE, guide, SQUARE]:
            _keep_peak(loads, guide)
        for j in range(LOAD_SIZE):
            loads[BEFORE, guide, j], loads[LAST, guide, j] = loads[LAST, guide, j], row[j]


@kernel
def _square(row):
    return row[FORCE] ** 2 + row[FORCE + 1] ** 2 + row[FORCE + 2] ** 2


@kernel
def _keep(row, largest):
    if row[SQUARE] > largest[SQUARE]:
        for j in range(LOAD_SIZE):
            largest[j] = row[j]


@kernel
def _keep_peak(loads, guide):
    """Keep the load at the peak of the parabola through the squares of three instants, the middle one of
    which is the largest; uses the row before as workspace."""
    row, middle, before = loads[NOW, guide], loads[LAST, guide], loads[BEFORE, guide]
    a, b = before[TIME] - middle[TIME], row[TIME] - middle[TIME]
    if a < 0.0 < b:
        low, high = before[SQUARE] - middle[SQUARE], row[SQUARE] - middle[SQUARE]
        bend = (high / b - low / a) / (b - a)
        at = -0.5 * (low / a - a * bend) / bend
        first, second = at * (at - b) / (a * (a - b)), at * (at - a) / (b * (b - a))
        for j in range(FORCE, LOAD_SIZE):
            before[j] = middle[j] + first * (before[j] - middle[j]) + second * (row[j] - middle[j])
        before[TIME], before[SQUARE] = middle[TIME] + at, _square(before)
        _keep(before, loads[LARGEST, guide])


def named(rows: np.ndarray) -> dict[str, Any]:
    """Rows (g, LOAD_SIZE) as the arrays of a Trajectory."""
    return {
        "guide_time": rows[:, TIME].copy(),
        "guide_force": rows[:, FORCE:MOMENT].copy(),
        "guide_moment": rows[:, MOMENT:].copy(),
    }
