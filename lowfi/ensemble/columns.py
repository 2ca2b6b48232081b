"""Results of many cases as columns of arrays, one row per case: what an ensemble keeps, in memory
and on disk."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff.lowfi.ensemble.batch import Case

# a status is stored as its place in this list
STATUSES = ("exited", "time_limit", "jammed", "diverged", "refused")
UNITS = {
    "exit_time": "s",
    "velocity": "m/s",
    "rate": "rad/s",
    "lateral_velocity": "m/s",
    "direction_error": "rad",
    "exit_attitude": "rad",
    "exit_position": "m",
    "exit_platform_position": "m",
    "exit_platform_velocity": "m/s",
    "exit_platform_attitude": "rad",
    "exit_platform_rate": "rad/s",
}
VECTORS = (
    "velocity",
    "rate",
    *(name for name in UNITS if name.startswith("exit_") and name != "exit_time"),
)


class Columns(NamedTuple):
    """``status`` (n,) as a place in STATUSES, exit_time (n,) s, velocity (n,3) m/s, rate (n,3)
    rad/s, lateral_velocity (n,) m/s, direction_error (n,) rad, at exit attitude (n,3) rad as a
    rotation vector and position (n,3) m of the payload and position, velocity, attitude and rate
    (n,3) of the platform, NaN in cases that did not settle, and ``steps`` (n,)."""

    status: np.ndarray
    exit_time: np.ndarray
    velocity: np.ndarray
    rate: np.ndarray
    lateral_velocity: np.ndarray
    direction_error: np.ndarray
    exit_attitude: np.ndarray
    exit_position: np.ndarray
    exit_platform_position: np.ndarray
    exit_platform_velocity: np.ndarray
    exit_platform_attitude: np.ndarray
    exit_platform_rate: np.ndarray
    steps: np.ndarray


def of(cases: Sequence[Case]) -> Columns:
    """Columns of ``cases``."""

    def settled(name: str) -> np.ndarray:
        values = np.full((len(cases), 3) if name in VECTORS else len(cases), np.nan)
        for index, case in enumerate(cases):
            value = getattr(case.outcome, name)
            if value is not None:
                values[index] = value
        return values

    status = np.array([STATUSES.index(case.status) for case in cases], dtype=np.int8)
    return Columns(
        status=status,
        **{name: settled(name) for name in UNITS},
        steps=np.array([case.steps for case in cases], dtype=np.int64),
    )


def counts(status: np.ndarray) -> dict[str, int]:
    """``asked = ok + refused + failed`` of the statuses (n,); failed are the diverged."""
    refused, failed = (
        int((status == STATUSES.index(name)).sum()) for name in ("refused", "diverged")
    )
    return {
        "asked": len(status),
        "ok": len(status) - refused - failed,
        "refused": refused,
        "failed": failed,
    }
