"""The instant at which velocity and rates are taken: the exit, or settled.

The thrust after the exit moves a free payload. It changes velocity and rates until burnout, and settled
values then are those of the thrust more than those of the rail. Rule: at the exit if more than ``MOST``
of the impulse comes after the exit of the scene itself, else settled. ``mechanics.outcome`` defines both.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.outcome import Outcome

EXIT, SETTLED = "exit", "settled"
MOST = 0.01  # of the impulse, after the exit
IN_A_VACUUM = "in a vacuum"  # said of values after a flight under thrust


class Instant(NamedTuple):
    """``at`` ``EXIT`` or ``SETTLED``, and ``why``."""

    at: str = SETTLED
    why: str = "the default"

    @property
    def words(self) -> str:
        """Both as text."""
        return f"{where(self.at)}, {self.why}"


def where(at: str) -> str:
    """The instant as text."""
    return "at the exit" if at == EXIT else "settled"


def chosen(asked: str | None, share: float | None) -> Instant:
    """The instant ``asked``, or that by the ``share`` of the impulse after the exit; None if the
    payload does not leave, or has no thrust."""
    if asked is not None:
        return Instant(asked, "as asked")
    if share is None:
        return Instant(SETTLED, "because no impulse after the exit is known")
    beyond = share > MOST
    words = f"{100.0 * share:.2g} % of the impulse comes after the exit"
    return Instant(
        EXIT if beyond else SETTLED,
        f"because {words} ({'more than' if beyond else 'at most'} {100.0 * MOST:g} %)",
    )


def rate(found: Outcome, at: str) -> list[float] | None:
    """Rate (rad/s) of one run at the instant; None where it has none."""
    return found.exit_rate if at == EXIT else found.rate


def velocity(found: Outcome, at: str) -> list[float] | None:
    """Velocity (m/s) of one run at the instant; None where it has none."""
    return found.exit_velocity if at == EXIT else found.velocity


def of_outcome(found: Outcome) -> str:
    """The instant that counts for one run: ``EXIT`` or ``SETTLED``. A run without values at its exit
    counts as settled, and so does one that has settled values alone."""
    at = chosen(None, found.impulse_after_exit).at
    return at if rate(found, at) is not None else SETTLED


def change(found: Outcome, other: Outcome) -> float | None:
    """Largest change of a rate (deg/s) from ``found`` to ``other``, at the instant of ``found``; None
    where one of them has no rate then."""
    at = of_outcome(found)
    first, second = rate(found, at), rate(other, at)
    if first is None or second is None:
        return None
    return math.degrees(np.abs(np.subtract(second, first)).max())


def lateral(velocity: np.ndarray) -> np.ndarray:
    """Lateral part (n,) of a velocity (n,3)."""
    return np.hypot(velocity[:, 1], velocity[:, 2])


def off(velocity: np.ndarray) -> np.ndarray:
    """Angle (n,) in rad of a velocity (n,3) to the X axis."""
    return np.arctan2(lateral(velocity), velocity[:, 0])
