"""The outcome of an ejection: exit, settled velocity and rate, jam. Both solvers use these
definitions.

* **Exit**: first instant at which the trailing edge of the last pad face is past the rail end.
* **At exit**: mean over 0.2 ms from the exit on, under the thrust that there is then.
* **Settled window**: 2 ms from the later of two times, exit + 1 ms and thrust below 0.1 % of its
  peak; settled values are means over it.
* **Impulse after the exit**: its share of the impulse of the whole thrust, or of the part before
  the exit if that is larger.
* **Jammed**: relative axial speed below the jam speed for 5 ms, after the thrust fell below 1 % of
  its peak or under a strong constant thrust. The jam speed is the friction transition speed (10 mm/s
  if friction has none) of a payload that would be faster without friction: friction holds it. A payload
  that is as slow without friction coasts. Its jam speed is that of a payload at rest: at it, the rail
  lasts an hour. It is zero, and no payload is jammed, if the weight pulls along rails without friction.
* **Fallen back**: the payload comes back to its stop (``mechanics.estimates.stop``) and is 1 mm behind its start.
  Without a stop, all pads are behind the start of the rail. Such a run ends as a jam.

All values come from the steps of a run (``mechanics.books``), independent of the sampling
interval.
"""

import math
from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.mechanics.estimates import ends, stop
from tipoff.mechanics.estimates.launch import Launch
from tipoff.mechanics.laws import thrust
from tipoff.mechanics.run_limits import EXIT_WINDOW, SETTLE_DELAY

BEHIND = 1e-3  # m behind its start, at which a run of a payload that falls back on its stop ends
_ROUNDING = 1e-12  # relative error of a difference of two equal impulses


class Motion(NamedTuple):
    """Sampled motion, named as in Trajectory."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    quaternion: np.ndarray
    rate: np.ndarray
    platform_position: np.ndarray
    platform_velocity: np.ndarray
    platform_quaternion: np.ndarray
    platform_rate: np.ndarray


class Outcome(NamedTuple):
    """Outcome of a run. ``exit_time`` and the values at exit are None unless the payload exited, all
    others unless it settled too."""

    exit_time: float | None = None  # s
    window_start: float | None = None  # s, of the settled window
    velocity: list[float] | None = None  # m/s, mean over the window
    rate: list[float] | None = None  # rad/s, mean over the window
    lateral_velocity: float | None = None  # m/s
    direction_error: float | None = None  # rad, of the velocity
    exit_attitude: list[float] | None = None  # rad, rotation vector
    exit_position: list[float] | None = None  # m
    exit_platform_position: list[float] | None = None  # m
    exit_platform_velocity: list[float] | None = None  # m/s
    exit_platform_attitude: list[float] | None = None  # rad, rotation vector
    exit_platform_rate: list[float] | None = None  # rad/s
    exit_velocity: list[float] | None = None  # m/s, at exit
    exit_rate: list[float] | None = None  # rad/s, at exit
    impulse_after_exit: float | None = None  # share; None also without thrust


_VECTORS = {name for name, kind in Outcome.__annotations__.items() if kind == list[float] | None}


def is_number(value: object) -> bool:
    """Whether a value is a finite number, not True or False."""
    return isinstance(value, float) or (type(value) is int and abs(value) < 2**53)


def require(found: Outcome) -> None:
    """Raise ValueError for an entry that is neither None nor a number, or three for a vector."""
    for name, value in found._asdict().items():
        numbers = value if name in _VECTORS else [value]
        is_right = value is None or (
            isinstance(numbers, (list, tuple))
            and len(numbers) == (3 if name in _VECTORS else 1)
            and all(is_number(one) for one in numbers)
        )
        if not is_right:
            raise ValueError(f"outcome.{name}: given {value!r}, expected a number, or None")


def with_impulse(found: Outcome, model) -> Outcome:
    """``found`` with the share of the impulse after the exit. That of springs is zero, because their
    strokes end on the rail."""
    if found.exit_time is None:
        return found
    if model.pushers is not None:
        return found._replace(impulse_after_exit=0.0)
    whole = thrust.impulse(model.thrust, math.inf)
    before = thrust.impulse(model.thrust, found.exit_time)
    scale = max(abs(whole), abs(before))
    if scale == 0.0:
        return found
    share = abs(whole - before) / scale
    return found._replace(impulse_after_exit=share if share > _ROUNDING else 0.0)


def no_exit_values(status: str, found: Outcome) -> str:
    """Reason why a run has no values at exit, or empty."""
    if found.exit_rate is not None:
        return ""
    if found.exit_time is None:
        return f"the payload did not leave the rail: {status}"
    return f"the run ended less than {1e3 * EXIT_WINDOW:g} ms after the exit"


class Milestones(NamedTuple):
    """Values that only the scene determines."""

    settled_thrust: float  # s, time after which the thrust is below 0.1 % of its peak
    # s, time after which it is below 1 %, at least the time at which a body force can move the
    # payload
    spent_thrust: float
    jam_speed: float  # m/s
    constant_thrust: bool  # whether a slow payload is jammed under the thrust: constant and strong
    # m, place of the rearmost trailing edge beyond the rail end at which a payload has fallen back on its
    # stop or, without one, off the rear end of the rail
    behind: float = -math.inf


def burnouts(launch: Launch, until: float) -> tuple[float, float]:
    """Times (s) after which the thrust is below 0.1 % and 1 % of its peak in 0..``until`` (s)."""
    settled, spent = thrust.burnouts(launch.thrust, (1e-3, 1e-2), until)
    return settled, spent


def milestones(
    launch: Launch, until: float, burnt: tuple[float, float] | None = None
) -> Milestones:
    """Milestones of a run that ends at the latest at the time ``until`` (s); ``burnt``: its
    ``burnouts``, if known."""
    settled, spent = burnt or burnouts(launch, until)
    return Milestones(
        settled_thrust=settled,
        spent_thrust=max(spent, ends.slides(launch, launch.slow)),
        jam_speed=ends.jam_speed(launch),
        constant_thrust=ends.starts_briskly(launch, launch.slow),
        behind=_behind(launch),
    )


def _behind(launch: Launch) -> float:
    """``Milestones.behind``."""
    if stop.is_there(launch):
        return -launch.way - BEHIND
    return launch.rear_end - launch.nominal_way


def relative_motion(motion) -> dict[str, np.ndarray]:
    """Position (m) and velocity (m/s) of the payload relative to the platform, in platform axes,
    and rate (rad/s) in payload body axes."""
    frame = rotation.matrices(motion.platform_quaternion)
    separation = motion.position - motion.platform_position
    spin = np.einsum("nij,nj->ni", frame, motion.platform_rate)
    drift = motion.velocity - motion.platform_velocity - rotation.crosses(spin, separation)
    body = rotation.matrices(motion.quaternion)
    return {
        "relative_position": np.einsum("nji,nj->ni", frame, separation),
        "relative_velocity": np.einsum("nji,nj->ni", frame, drift),
        "relative_rate": motion.rate - np.einsum("nji,nj->ni", body, spin),
    }


@kernel
def window_start(exit_at, marks):
    """Start (s) of the settled window of an exit at ``exit_at`` (s)."""
    return max(exit_at + SETTLE_DELAY, marks.settled_thrust)


def pressed_at_ignition(model, forces: np.ndarray) -> str:
    """A warning that names the pads with ``forces`` (f,3) N at ignition; empty if there are
    none, or if the payload rests on them."""
    if model.initial.settled:
        return ""
    pads = sorted(set(model.faces.pad[(forces != 0.0).any(axis=1)].tolist()))
    return (
        f"initial interference: pads {', '.join(map(str, pads))} press on the rail at ignition"
        if pads
        else ""
    )


def strike(faces, face: int, how: str, depth: float, place: float, time: float) -> str:
    """Message of a run that ends because a pad meets a wall where no contact is modelled. ``how``
    is the verb of the pad, ``depth`` (m) its penetration, ``place`` (m) the X of the middle of the
    face in scene axes at ignition, ``time`` in s."""
    name = f"{'+' if faces.sign[face] > 0.0 else '-'}{'xyz'[faces.axis[face]]}"
    return (
        f"pad {faces.pad[face]} {how} of its rail with its face {name}, {depth * 1e3:.4g} mm "
        f"behind the surface of the wall, "
        f"X = {place:.6g} m, at {time:.6g} s: no contact is modelled there"
    )
