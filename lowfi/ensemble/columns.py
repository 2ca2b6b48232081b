"""Results of many cases as columns, one row per case."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.mechanics import instant

if TYPE_CHECKING:
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
    "exit_velocity": "m/s",
    "exit_rate": "rad/s",
    "impulse_after_exit": "dimensionless",
}
VECTORS = (
    "velocity",
    "rate",
    *(name for name in UNITS if name.startswith("exit_") and name != "exit_time"),
)


class Columns(NamedTuple):
    """Results of n cases. ``exit_time``, the values at exit and the share of the impulse are NaN in
    cases that did not leave, all others in cases that did not settle. Attitudes are rotation
    vectors."""

    status: np.ndarray  # (n,) place in STATUSES
    exit_time: np.ndarray  # (n,) s
    velocity: np.ndarray  # (n, 3) m/s
    rate: np.ndarray  # (n, 3) rad/s
    lateral_velocity: np.ndarray  # (n,) m/s
    direction_error: np.ndarray  # (n,) rad
    exit_attitude: np.ndarray  # (n, 3) rad
    exit_position: np.ndarray  # (n, 3) m
    exit_platform_position: np.ndarray  # (n, 3) m
    exit_platform_velocity: np.ndarray  # (n, 3) m/s
    exit_platform_attitude: np.ndarray  # (n, 3) rad
    exit_platform_rate: np.ndarray  # (n, 3) rad/s
    exit_velocity: np.ndarray  # (n, 3) m/s, at exit
    exit_rate: np.ndarray  # (n, 3) rad/s, at exit
    impulse_after_exit: np.ndarray  # (n,) share; NaN also without thrust
    steps: np.ndarray  # (n,)


def of_cases(cases: "Sequence[Case]") -> Columns:
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


def seen(found: Columns, at: str) -> Columns:
    """``found`` with the velocity, its lateral part and direction, and the rate of the instant ``at``
    (``mechanics.instant``) under the names of the settled ones."""
    if at != instant.EXIT:
        return found
    return found._replace(
        velocity=found.exit_velocity,
        rate=found.exit_rate,
        lateral_velocity=instant.lateral(found.exit_velocity),
        direction_error=instant.off(found.exit_velocity),
    )
