"""The flying bodies: payload and platform of a scene, their boxes, and their state at the exit.

The payload is a box of ``flight.body``, or else ``payload.size``, about its nominal mass centre. The
platform is the boxes of ``flight.envelope``, and two for every built-in rail, along its legs; rails from
a file count only if ``flight.envelope`` lists their boxes.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tipoff.lowfi.ensemble.columns import UNITS, Columns
from tipoff.mechanics.outcome import Outcome
from tipoff.scenes.body import tensor
from tipoff.scenes.effects.flight import FlightTable
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene


class Bodies(NamedTuple):
    """Of n cases, each about its own mass centre and in its own axes: inertia (n,3,3) kg m2 of
    payload and platform, half sizes (n,3) m and centre (n,3) m of the payload's box, the platform's
    b boxes by centre and half sizes (n,b,3) m; and in scene axes the mass centre (n,3) m of both
    together at ignition. In a scene without a platform, the platform is the scene axes, at rest;
    without boxes b is zero."""

    inertia: np.ndarray
    platform_inertia: np.ndarray
    half: np.ndarray
    centre: np.ndarray
    boxes: np.ndarray
    box_halves: np.ndarray
    origin: np.ndarray


class Start(NamedTuple):
    """n cases at exit, in scene axes: payload and platform by place (m), velocity (m/s), rates in
    body axes (rad/s), all (n,3), and attitude (n,3,3), body to scene. Velocity and rate of the
    payload are the settled values."""

    place: np.ndarray
    velocity: np.ndarray
    turn: np.ndarray
    rate: np.ndarray
    platform_place: np.ndarray
    platform_velocity: np.ndarray
    platform_turn: np.ndarray
    platform_rate: np.ndarray


def bodies(scenes: Iterable[Scene]) -> Bodies:
    """Bodies of all scenes, each with the same number of boxes; without boxes if a size is unknown."""
    return Bodies(*map(np.array, zip(*map(_bodies, scenes))))


def start(found: Columns) -> Start:
    """State at the exit of settled cases."""
    attitude, platform = (
        Rotation.from_rotvec(part).as_matrix()
        for part in (found.exit_attitude, found.exit_platform_attitude)
    )
    return Start(
        found.exit_position,
        found.velocity,
        turn=attitude,
        rate=found.rate,
        platform_place=found.exit_platform_position,
        platform_velocity=found.exit_platform_velocity,
        platform_turn=platform,
        platform_rate=found.exit_platform_rate,
    )


def of_outcomes(outcomes: Sequence[Outcome]) -> Columns:
    """Settled outcomes as columns."""
    none = np.zeros(len(outcomes), dtype=int)  # no status, no steps
    # no share of the impulse, without thrust, is NaN
    values = {
        name: np.array([getattr(each, name) for each in outcomes], dtype=float) for name in UNITS
    }
    return Columns(status=none, **values, steps=none)


def unknown_size(scene: Scene) -> str:
    """The reason why no clearance can be computed in this scene; empty if it can be computed."""
    if _size(scene) is None:
        return "neither flight.body nor payload.size says how large the payload is"
    return (
        ""
        if _boxes(scene)
        else "flight.envelope lists no box of the platform, and its rails are not the built-in L sections"
    )


def unknown_rails(scene: Scene) -> bool:
    """Whether the rails come from a file: then only ``flight.envelope`` has their boxes."""
    return not isinstance(scene.rail, SectionTable)


def table_of(scene: Scene) -> FlightTable:
    """The table of the flight of a scene; a scene without it is refused before."""
    assert scene.flight is not None
    return scene.flight


def _size(scene: Scene) -> tuple[float, float, float] | None:
    return table_of(scene).body or scene.payload.size


def _bodies(scene: Scene) -> tuple:
    platform = scene.platform.record() if scene.platform else None
    offset = np.array(
        scene.mass_offset.eccentricity.offset() if scene.mass_offset else (0.0, 0.0, 0.0)
    )
    place = np.array(platform.mass_centre if platform else (0.0, 0.0, 0.0))
    corners = np.zeros((0, 2, 3)) if unknown_size(scene) else np.array(_boxes(scene))
    low, high = corners.transpose(1, 0, 2)
    size = np.array(_size(scene) or np.zeros(3))
    inertia = platform.inertia if platform else np.eye(3)
    return (
        tensor(scene.payload.inertia),
        inertia,
        0.5 * size,
        -offset,
        0.5 * (low + high) - place,
        0.5 * (high - low),
        _origin(scene, offset, place),
    )


def _origin(scene: Scene, offset: np.ndarray, place: np.ndarray) -> np.ndarray:
    """The point on the orbit: the mass centre of payload and platform at ignition."""
    if scene.platform is None:
        return place
    moved = scene.initial.position if scene.initial else None
    payload = offset + (np.array([moved.x, moved.y, moved.z]) if moved else 0.0)
    return (scene.payload.mass * payload + scene.platform.mass * place) / (
        scene.payload.mass + scene.platform.mass
    )


def _boxes(scene: Scene) -> list[tuple]:
    """Corners (low, high) of the platform's boxes in scene axes at ignition."""
    listed: list[tuple] = [(box.low, box.high) for box in table_of(scene).envelope]
    rail = scene.rail
    if not isinstance(rail, SectionTable):
        return listed
    gap = rail.gap(scene.contact.clearance if scene.contact else 0.0)
    for corner in dict.fromkeys(pad.position[1:] for pad in scene.pads):
        side, inner = np.sign(corner), np.abs(corner) + gap  # of the rail's inner corner
        for across in (0, 1):  # the leg behind the wall normal to y, then to z
            near, far = inner + rail.thickness - rail.leg, inner + rail.thickness
            near[across] = inner[across]
            ends = np.sort([side * near, side * far], axis=0)
            listed.append(((rail.start, *ends[0]), (rail.end, *ends[1])))
    return listed
