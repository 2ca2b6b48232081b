"""The model ``springs`` as plain numbers for codes of rigid bodies: two bodies, sixteen points against
planes, a thrust. Also its ten conditions, and the settled rates of a peer's samples.

    p = n . x - wall,    F = -N n - mu(s)/s N (u - (n . u) n)

x is the middle of a pad face and u its velocity against the platform, in platform axes.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from tipoff import lowfi
from tipoff.mechanics.model_names import SPRINGS
from tipoff.mechanics.run_limits import SETTLE_WINDOW
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import scene_model
from tipoff.scenes.scene import Scene, load
from validation.peers.case import require_ours

# Conditions of the catalogue in which pads touch and 1 um of clearance changes little.
CONDITIONS = ("phi0", "phi15", "phi35", "phi60", "phi90", "h1", "h2", "h3", "h4", "h10")
TIGHT = 1e-11  # relative tolerance of our own run
AXES = "xyz"
# A spring and damper that every code can express: as stiff as IMPACT at 20 um.
LINEAR = {
    "law": "linear",
    "clearance": 0.25e-3,
    "exponent": 1.0,
    "stiffness": 1e7,
    "damping": 1e3,
}


class Problem(NamedTuple):
    """One condition. Places relative to the payload's mass centre in body axes, walls relative to
    the platform's mass centre in platform axes."""

    mass: float  # kg
    inertia: np.ndarray  # (3,3) kg m2
    platform_mass: float  # kg
    platform_inertia: np.ndarray  # (3,3) kg m2
    platform_place: tuple  # (3,) m, its mass centre at ignition
    place: tuple  # (3,) m, the payload's mass centre at ignition
    points: np.ndarray  # (f,3) m
    normals: np.ndarray  # (f,3) outward
    walls: np.ndarray  # (f,) m along the normal
    ends: tuple  # (2,) m, X of the ends of the rail
    peak: float  # N
    centre: float  # s
    width: float  # s
    direction: tuple  # (3,) of the thrust, body axes
    arm: tuple  # (3,) m, where it acts
    duration: float  # s

    def thrust(self, time: float) -> float:
        """Thrust (N)."""
        return self.peak * float(np.exp(-0.5 * ((time - self.centre) / self.width) ** 2))


@cache
def scene(condition: str, law: str, friction: bool) -> Scene:
    """A condition of ``clamped`` with its own contact law, ``impact``, or the ``linear`` one."""
    found = load("clamped").condition(condition)
    if law == "linear":
        interface = found.contact.interface_stiffness if found.contact else None
        found = found.replace({"contact": LINEAR | {"interface_stiffness": interface}})
    return found if friction else found.replace({"friction": "absent"})


@cache
def problem(condition: str, law: str, friction: bool) -> Problem:
    """The numbers of a condition."""
    chosen = scene(condition, law, friction)
    model = scene_model.build(chosen)
    faces, platform, pulses = model.faces, model.platform, model.thrust.pulses
    assert platform is not None and pulses is not None and pulses.peaks.size == 1
    normals = faces.sign[:, None] * np.eye(3)[faces.axis]
    offset = model.thrust_offset
    first = np.add(model.payload.mass_centre, model.initial.position)
    return Problem(
        mass=model.payload.mass,
        inertia=model.payload.inertia,
        platform_mass=platform.mass,
        platform_inertia=platform.inertia,
        platform_place=platform.mass_centre,
        place=tuple(first.tolist()),
        points=faces.centre,
        normals=normals,
        walls=faces.sign * faces.wall,
        ends=(model.rail_start, model.rail_end),
        peak=float(pulses.peaks[0]),
        centre=float(pulses.centres[0]),
        width=float(pulses.widths[0]),
        direction=tuple(offset.direction) if offset else (1.0, 0.0, 0.0),
        arm=tuple(offset.arm) if offset else (0.0, 0.0, 0.0),
        duration=chosen.time_limit,
    )


@cache
def solved(condition: str, law: str, friction: bool, tolerance: float = TIGHT) -> Trajectory:
    """Our own run."""
    numerics = lowfi.Numerics(relative_tolerance=tolerance)
    found = lowfi.run(scene(condition, law, friction), SPRINGS, numerics=numerics)
    require_ours(found, "exited")
    return found


@cache
def window(condition: str, law: str, friction: bool) -> float:
    """Start (s) of the settled window of our own tight run, used for all codes."""
    start = solved(condition, law, friction).outcome.window_start
    assert start is not None
    return start


def rates(found: Trajectory) -> np.ndarray:
    """Settled rates (3,) deg/s of a run of ours."""
    return np.rad2deg(np.array(found.outcome.rate, dtype=float))


def settled(time: np.ndarray, rate: np.ndarray, start: float) -> np.ndarray:
    """Mean (3,) deg/s of samples ``rate`` (n,3) rad/s at ``time`` (n,) s over the settled window from
    ``start`` (s), the rate linear between samples."""
    end = start + SETTLE_WINDOW
    inside = (time > start) & (time < end)
    grid = np.concatenate([[start], time[inside], [end]])
    values = np.column_stack([np.interp(grid, time, column) for column in rate.T])
    return np.rad2deg(np.trapezoid(values, grid, axis=0) / SETTLE_WINDOW)
