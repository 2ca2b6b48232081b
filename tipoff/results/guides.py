"""What each guide of a payload does in a run: a button, or a pad of a scene without buttons.

A guide leaves the rail when the trailing edges of all its faces are past the open end, as the exit is that
of the last one. The instant is that of the cubic through places and speeds of two samples. Velocity and
rates are linear between them.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics.outcome import relative_motion
from tipoff.scenes import guides, scene_model
from tipoff.scenes.scene import Scene

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Guide:
    """A guide in a run. What a run does not have is None: a guide that stays on the rail, or that has no
    load.

    Example:
        >>> run = tipoff.run(tipoff.load("tiny"), "springs")
        >>> run.guides[0].name
        'pad 1'
    """

    #: "button 1" or "pad 3", counted as in the scene, from 1.
    name: str
    #: m, middle of its faces, from the nominal mass centre.
    place_m: Vector
    #: s, instant at which it leaves the rail.
    leaves_s: float | None = None
    #: m/s, speed of the payload's mass centre along the rail then, relative to the platform.
    speed_m_s: float | None = None
    #: rad/s, inertial rates in body axes then.
    rate_rad_s: Vector | None = None
    #: N, largest force of the rail on it.
    largest_force_n: float | None = None
    #: s, instant of that force.
    largest_force_time_s: float | None = None
    #: N, that force in body axes.
    force_n: Vector | None = None
    #: N m, moment of that force about the foot of a button, in body axes; None for a pad.
    moment_n_m: Vector | None = None


def of_run(scene: Scene, run: Any) -> tuple[Guide, ...]:
    """The guides of ``scene`` in its ``run``."""
    found = scene_model.built(scene)
    faces, centre = found.model.faces, np.array(found.model.payload.mass_centre)
    moved = relative_motion(run) if run.time.size > 1 else None
    rows = []
    for number, guide in enumerate(guides.from_pads(scene.pads)):
        own = faces.guide == number
        place = faces.centre[own].mean(axis=0) + centre
        left = {} if moved is None else _left(run, moved, faces, own, found.model.rail_end)
        foot = None if guide.foot is None else np.array(guide.foot) - centre
        load = _load(run, number, foot)
        rows.append(Guide(name=guide.name, place_m=_vector(place), **left, **load))
    return tuple(rows)


def _left(run, moved: dict, faces, own: np.ndarray, end: float) -> dict:
    """Instant at which the faces ``own`` (f,) leave the rail that ends at X = ``end`` (m), speed and rates."""
    position, speeds = moved["relative_position"][:, 0], moved["relative_velocity"][:, 0]
    base, body = rotation.matrices(run.platform_quaternion), rotation.matrices(run.quaternion)
    axis = np.einsum("nji,nj->ni", body, base[:, :, 0])  # X of the platform in body axes
    edges = axis @ faces.centre[own].T - axis[:, :1] * faces.half_length[own]
    # Places of the model begin at the platform's mass centre at ignition.
    past = position + edges.min(axis=1) - end
    beyond = np.flatnonzero(past > 0.0)
    if not beyond.size:
        return {}
    after = int(beyond[0])
    if after == 0:
        return _at(run, speeds, 0, 1.0)
    step = run.time[after] - run.time[after - 1]
    turning = (past[after] - past[after - 1] - position[after] + position[after - 1]) / step
    rise, fall = (step * (speeds[at] + turning) for at in (after - 1, after))
    share = _root(past[after - 1], past[after], rise, fall)
    return _at(run, speeds, after - 1, share)


def _at(run, speeds: np.ndarray, sample: int, share: float) -> dict:
    """Instant, speed and rates a ``share`` of the way from a ``sample`` to the next."""
    first, second = sample, min(sample + 1, run.time.size - 1)
    if sample == 0 and share == 1.0:
        second, share = first, 0.0  # beyond the end from ignition on

    def between(values: np.ndarray):
        return values[first] + share * (values[second] - values[first])

    return {
        "leaves_s": float(between(run.time)),
        "speed_m_s": float(between(speeds)),
        "rate_rad_s": _vector(between(run.rate)),
    }


def _root(low: float, high: float, rise: float, fall: float) -> float:
    """Share of a step at which the cubic with these values and slopes passes zero, by bisection."""
    step = high - low
    a, b = rise + fall - 2.0 * step, 3.0 * step - 2.0 * rise - fall
    begin, end = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (begin + end)
        value = low + middle * (rise + middle * (b + middle * a))
        begin, end = (begin, middle) if value > 0.0 else (middle, end)
    return 0.5 * (begin + end)


def _load(run, number: int, foot: np.ndarray | None) -> dict:
    """Largest force of a guide, and its moment about the ``foot`` (m, from the mass centre)."""
    if number >= run.guide_time.size or not run.guide_force[number].any():
        return {}
    force, moment = run.guide_force[number], run.guide_moment[number]
    own = {} if foot is None else {"moment_n_m": _vector(moment - np.cross(foot, force))}
    return own | {
        "largest_force_n": math.hypot(*force),
        "largest_force_time_s": float(run.guide_time[number]),
        "force_n": _vector(force),
    }


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
