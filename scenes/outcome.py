"""What became of an ejection: exit, settled velocity and rate, jam. One home for the definitions, used by both fidelities.

* **Exit**: first instant at which the trailing edge of the last pad face is past the rail end.
* **Settled window**: 2 ms from the later of exit + 1 ms and thrust below 0.1 % of its peak; settled values are means over it.
* **Jammed**: after thrust fell below 1 % of its peak, or under constant thrust, relative axial speed below the friction
  transition speed (10 mm/s where friction has none) for 5 ms.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from scenes import rotation, spline
from scenes.effects import thrust
from scenes.effects.friction import Friction
from scenes.jit import kernel
from scenes.scene import Scene

AROUND = 3  # samples on either side that a spline sees beyond what it is asked about
SETTLE_DELAY = 1e-3
SETTLE_WINDOW = 2e-3
SETTLE_PIECES = 10  # a free body turns so little in the window that more pieces of a spline change nothing
JAM_DURATION = 5e-3


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
    """Exit time (s), settled window start (s), means over it: velocity (m/s), rate (rad/s); lateral velocity (m/s), direction
    error of the velocity (rad). At the first sample past the exit: attitude of the payload as a rotation vector (rad), its
    position (m), and position (m), velocity (m/s), attitude (rad) and rate (rad/s) of the platform. All None unless the payload
    exited and settled."""

    exit_time: float | None = None
    window_start: float | None = None
    velocity: list[float] | None = None
    rate: list[float] | None = None
    lateral_velocity: float | None = None
    direction_error: float | None = None
    exit_attitude: list[float] | None = None
    exit_position: list[float] | None = None
    exit_platform_position: list[float] | None = None
    exit_platform_velocity: list[float] | None = None
    exit_platform_attitude: list[float] | None = None
    exit_platform_rate: list[float] | None = None


class Milestones(NamedTuple):
    """Instants a scene fixes beforehand: thrust below 0.1 % and 1 % of its peak (s), and the jam speed (m/s)."""

    settled_thrust: float
    spent_thrust: float
    jam_speed: float
    constant_thrust: bool
    edges: np.ndarray
    rail_end: float


def milestones(scene: Scene, model) -> Milestones:
    """Instants and trailing edges ``edges`` (f,3) in body axes that ``judge`` needs."""
    edges = model.faces.centre.copy()
    edges[:, 0] -= model.faces.half_length
    record = model.thrust
    return Milestones(*thrust.burnouts(record, (1e-3, 1e-2), scene.duration), jam_speed(model),
                      scene.thrust.kind == "constant", edges, model.rail_end)


def jam_speed(model) -> float:
    """Relative axial speed (m/s) below which a payload may be jammed."""
    return model.friction.static_speed if isinstance(model.friction, Friction) else 0.01


def relative_motion(motion) -> dict[str, np.ndarray]:
    """Payload position (m) and velocity (m/s) relative to the platform in its axes, and rate (rad/s) in payload body axes."""
    frame = rotation.matrices(motion.platform_quaternion)
    separation = motion.position - motion.platform_position
    spin = np.einsum("nij,nj->ni", frame, motion.platform_rate)
    drift = motion.velocity - motion.platform_velocity - rotation.crosses(spin, separation)
    body = rotation.matrices(motion.quaternion)
    return {"relative_position": np.einsum("nji,nj->ni", frame, separation),
            "relative_velocity": np.einsum("nji,nj->ni", frame, drift),
            "relative_rate": motion.rate - np.einsum("nji,nj->ni", body, spin)}


def clearance_to_exit(motion, marks: Milestones) -> np.ndarray:
    """Distance (n,) m by which the rearmost trailing edge is past the rail end (negative while on the rail)."""
    past = np.empty((len(motion.time), 1))
    distances(motion.position, motion.quaternion, motion.platform_position, motion.platform_quaternion, marks.edges, marks.rail_end,
              past)
    return past[:, 0]


@kernel
def distances(position, quaternion, platform_position, platform_quaternion, edges, rail_end, out):
    """``clearance_to_exit`` of n samples with edges (f,3) m into ``out`` (n,1)."""
    for n in range(out.shape[0]):
        turn, axis = rotation.matrix(_four(quaternion[n])), rotation.matrix(_four(platform_quaternion[n]))
        along = rotation.unrotate(turn, (axis[0], axis[3], axis[6]))
        rearmost = np.inf
        for edge in edges:
            rearmost = min(rearmost, along[0] * edge[0] + along[1] * edge[1] + along[2] * edge[2])
        place, origin = position[n], platform_position[n]
        out[n, 0] = rearmost - rail_end + (axis[0] * (place[0] - origin[0]) + axis[3] * (place[1] - origin[1])
                                           + axis[6] * (place[2] - origin[2]))


@kernel
def _four(q):
    return (q[0], q[1], q[2], q[3])


def exit_time(motion, marks: Milestones) -> float | None:
    """Exit (s) from a cubic through the samples around the crossing, or None."""
    past = clearance_to_exit(motion, marks)
    after = np.flatnonzero(past > 0.0)
    if after.size == 0:
        return None
    if after[0] == 0:
        return float(motion.time[0])
    near = slice(max(after[0] - AROUND, 0), after[0] + AROUND)
    return crossed(motion.time[near], past[near, None], after[0] - near.start, np.empty(past[near].size),
                   np.empty((past[near].size, 1)))


@kernel
def crossed(time, past, after, work, slope):
    """Instant (s) between samples ``after`` - 1 and ``after`` at which ``past`` (n,1) m passes zero; ``work`` (n,) and
    ``slope`` (n,1) are scratch."""
    if time.size >= 4:
        spline.slopes(time, past, work, slope)
        return spline.crossing(time, past, slope, after - 1)
    rise = past[after, 0] - past[after - 1, 0]
    return time[after] - past[after, 0] / rise * (time[after] - time[after - 1])


def window_start(exit_at: float, marks: Milestones) -> float:
    """Start (s) of the settled window."""
    return max(exit_at + SETTLE_DELAY, marks.settled_thrust)


@kernel
def thinning(interval):
    """Every how many samples, ``interval`` (s) apart, a mean over the settled window is read from."""
    return max(1, int(SETTLE_WINDOW / (SETTLE_PIECES * interval) + 1e-9))


def mean(time: np.ndarray, values: np.ndarray, start: float, end: float) -> np.ndarray:
    """Mean over start..end (s) of samples (n,3), by the integral of a cubic spline."""
    first, last = np.searchsorted(time, [start, end])
    every = thinning(time[1] - time[0])
    near = np.arange(min(last + AROUND, time.size) - 1, max(first - AROUND * every, 0) - 1, -every)[::-1]
    if time[near].size < 4:
        return scipy.interpolate.CubicSpline(time[near], values[near]).integrate(start, end) / (end - start)
    found, points = np.empty(3), time[near].size
    average(time[near], values[near], start, end, np.empty(points), np.empty((points, 3)), found)
    return found


@kernel
def average(time, values, start, end, work, slope, out):
    """Means ``out`` (3,) over start..end (s) of ``values`` (n,3), n at least 4; ``work`` (n,) and ``slope`` (n,3) are scratch."""
    spline.slopes(time, values, work, slope)
    for axis in range(3):
        out[axis] = spline.integral(time, values, slope, axis, start, end) / (end - start)


def may_be_jammed(now: float, marks: Milestones) -> bool:
    """Whether thrust leaves room for a jam that has lasted long enough at ``now`` (s)."""
    return now >= JAM_DURATION and (marks.constant_thrust or now - JAM_DURATION >= marks.spent_thrust)


def is_jammed(motion, marks: Milestones) -> bool:
    """Whether the payload has come to rest on the rail by the last sample."""
    now = motion.time[-1]
    if not may_be_jammed(now, marks):
        return False
    recent = motion.time >= now - JAM_DURATION * (1.0 + 1e-9)
    speed = relative_motion(motion)["relative_velocity"][recent, 0]
    return bool((np.abs(speed) < marks.jam_speed).all())


def pressed_at_ignition(faces, forces: np.ndarray) -> str:
    """A warning that names the pads on which there are ``forces`` (f,3) N before anything moves, or nothing."""
    pads = sorted(set(faces.pad[(forces != 0.0).any(axis=1)].tolist()))
    return f"initial interference: pads {', '.join(map(str, pads))} press on the rail at ignition" if pads else ""


def strike(faces, face: int, how: str, depth: float, place: float, time: float) -> str:
    """Why a run ends at a pad that meets a wall where no contact is modelled: what it does (``how``), with the penetration
    ``depth`` (m), the middle of the face standing at X = ``place`` (m, as the scene counts it at ignition), at ``time`` (s)."""
    name = f"{'+' if faces.sign[face] > 0.0 else '-'}{'xyz'[faces.axis[face]]}"
    return (f"pad {faces.pad[face]} {how} of its rail with its face {name}, {depth * 1e3:.4g} mm behind the surface of the wall, "
            f"X = {place:.6g} m, at {time:.6g} s: no contact is modelled there")


def judge(motion, marks: Milestones) -> tuple[str, Outcome]:
    """Status ("exited", "jammed" or "time_limit") and outcome of samples so far."""
    exit_at = exit_time(motion, marks)
    if exit_at is None:
        return ("jammed" if is_jammed(motion, marks) else "time_limit"), Outcome()
    start = window_start(exit_at, marks)
    end = start + SETTLE_WINDOW
    if motion.time[-1] < end * (1.0 - 1e-12):
        return "time_limit", Outcome(exit_time=exit_at)
    index = min(int(np.searchsorted(motion.time, exit_at)), motion.time.size - 1)
    bodies = [part[index] for part in (motion.position, motion.quaternion, motion.platform_position, motion.platform_velocity,
                                       motion.platform_quaternion, motion.platform_rate)]
    return "exited", settled(exit_at, start, mean(motion.time, motion.velocity, start, end),
                             mean(motion.time, motion.rate, start, end), *bodies)


def settled(exit_at: float, start: float, velocity: np.ndarray, rate: np.ndarray, position: np.ndarray, attitude: np.ndarray,
            platform_position: np.ndarray, platform_velocity: np.ndarray, platform_attitude: np.ndarray,
            platform_rate: np.ndarray) -> Outcome:
    """Outcome of an exit at ``exit_at`` (s) with these means over the window from ``start`` (s), and both bodies at exit, their
    attitudes as quaternions."""
    lateral = float(np.hypot(velocity[1], velocity[2]))
    return Outcome(exit_at, start, velocity.tolist(), rate.tolist(), lateral, float(np.arctan2(lateral, velocity[0])),
                   rotation.vector(attitude.tolist()), position.tolist(), platform_position.tolist(), platform_velocity.tolist(),
                   rotation.vector(platform_attitude.tolist()), platform_rate.tolist())
