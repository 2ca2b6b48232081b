"""Flight of a payload after its exit: miss distance, pointing, and distance from the platform.

From the exit on, all bodies fall freely. Velocity and rate at the exit are the settled values, so thrust
after the exit counts as delivered at the exit. Moments by gravity gradient, drag and radiation pressure
are left out. The target is that of ``scenes.effects.flight``. The miss is measured when the payload
passes the plane through the target normal to the launch axis, in orbit axes.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from tipoff.scenes.effects.flight import Flight
from tipoff.studies.flight import boxes, orbit, rotation
from tipoff.studies.flight.bodies import Bodies, Start

# instants of a flight between which an event is located
_SCAN = 400
_LOOKS = 120  # instants for the smallest distance, before the refinement
_HALVINGS = 60
_APPROACHES = 2000  # largest number of steps to the pointing limit
_CLOSE = 1e-9  # rad
_CHUNK = 250  # cases in memory at once


class Flown(NamedTuple):
    """Flights of n cases. ``passes`` (n,) s: time of passing the target; ``miss`` (n,2) m: scene y
    and z there; ``orbital`` (n,2) m: the miss of a shot of the same axial velocity without errors;
    ``pointing`` (n,) rad: angle between payload x axis and launch axis at that time. These are NaN
    if the target is not passed. ``limit`` (n,) s: first time at the pointing limit, infinite if it
    is not reached before the target, NaN if this is not known. ``cone`` (n,2) rad: smallest and
    largest angle of the x axis from the angular momentum; ``coning`` (n,) rad/s: mean rate of the x
    axis about it; ``nutation`` (n,) s: period. ``clearance`` (n,) m and its time, ``closest`` (n,)
    s; ``returns`` (n,) m: smallest gap between the spheres about both bodies after their largest
    distance, infinite if they do not come closer than the target. NaN without boxes."""

    passes: np.ndarray
    miss: np.ndarray
    orbital: np.ndarray
    pointing: np.ndarray
    limit: np.ndarray
    cone: np.ndarray
    coning: np.ndarray
    nutation: np.ndarray
    clearance: np.ndarray
    closest: np.ndarray
    returns: np.ndarray


class Pair(NamedTuple):
    """Payload and platform of n cases in free flight from ``start``: states (n,6) in orbit axes and
    free rotations."""

    payload: np.ndarray
    platform: np.ndarray
    payload_turn: rotation.Free
    platform_turn: rotation.Free
    bodies: Bodies
    start: Start
    flight: Flight


def fly(
    flight: Flight, bodies: Bodies, start: Start, progress: Callable[[float], None] | None = None
) -> Flown:
    """Fly n cases; ``progress`` is called with the fraction done."""
    cases, parts = len(start.place), []
    for begin in range(0, cases, _CHUNK):
        chosen = slice(begin, begin + _CHUNK)
        parts.append(
            found(
                pair(
                    flight,
                    Bodies(*(part[chosen] for part in bodies)),
                    Start(*(part[chosen] for part in start)),
                )
            )
        )
        if progress:
            progress(min(1.0, (begin + _CHUNK) / cases))
    return joined(parts)


def joined(parts: Sequence[Flown]) -> Flown:
    """Joins flights to one record."""
    return Flown(*map(np.concatenate, zip(*parts)))


def pair(flight: Flight, bodies: Bodies, start: Start) -> Pair:
    """Both bodies from their exit on."""
    n, axes = flight.mean_motion, flight.axes
    return Pair(
        orbit.state(n, axes, start.place - bodies.origin, start.velocity),
        orbit.state(n, axes, start.platform_place - bodies.origin, start.platform_velocity),
        payload_turn=rotation.free(bodies.inertia, start.turn, start.rate),
        platform_turn=rotation.free(
            bodies.platform_inertia, start.platform_turn, start.platform_rate
        ),
        bodies=bodies,
        start=start,
        flight=flight,
    )


def found(both: Pair) -> Flown:
    """Fly each pair."""
    flight, cases = both.flight, len(both.payload)
    target = np.zeros((cases, 6))  # at rest in orbit axes
    target[:, :3] = (np.array([flight.range, 0.0, 0.0]) - both.bodies.origin) @ flight.axes.T
    passes, miss = _passed(flight, both.payload - target)
    _, orbital = _passed(flight, _perfect(both) - target)
    pointing = pointing_error(both, np.nan_to_num(passes)[:, None])[:, 0]
    least, largest, coning = cone(both.payload_turn)
    clearance, closest, returns = (
        _kept(both) if both.bodies.boxes.shape[1] else np.full((3, cases), np.nan)
    )
    return Flown(
        passes,
        miss,
        orbital=orbital,
        pointing=np.where(np.isfinite(passes), pointing, np.nan),
        limit=_limit(both, passes),
        cone=np.stack([least, largest], axis=1),
        coning=coning,
        nutation=rotation.nutation_period(both.payload_turn),
        clearance=clearance,
        closest=closest,
        returns=returns,
    )


def _perfect(both: Pair) -> np.ndarray:
    """States (n,6) of payloads that leave the middle of the rail with the same velocity along the
    launch axis and none across."""
    flight, along = both.flight, np.array([1.0, 0.0, 0.0])
    return orbit.state(
        flight.mean_motion,
        flight.axes,
        both.start.place * along - both.bodies.origin,
        both.start.velocity * along,
    )


def _passed(flight: Flight, apart: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) s at which payloads pass the plane of their target, from states (n,6) relative to
    it, and the miss (n,2) m; NaN if they do not pass."""
    along, across = flight.axes[:, 0], flight.axes[:, 1:]

    def short(time: np.ndarray) -> np.ndarray:
        return orbit.places(flight.mean_motion, apart, time) @ along

    straight = flight.range / np.maximum(
        apart[:, 3:] @ along, 1e-3 * flight.range / flight.duration
    )
    early = np.minimum(straight / 10.0, flight.duration / 10.0)[:, None]
    time = early * (flight.duration / early) ** np.linspace(0.0, 1.0, _SCAN)
    beyond = short(time) >= 0.0
    first = beyond.argmax(axis=1)
    rows = np.arange(len(apart))
    low, high = np.where(first > 0, time[rows, first - 1], 0.0), time[rows, first]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        past = short(middle[:, None])[:, 0] >= 0.0
        low, high = np.where(past, low, middle), np.where(past, middle, high)
    reached = beyond[rows, first]
    beside = orbit.places(flight.mean_motion, apart, high[:, None])[:, 0] @ across
    return np.where(reached, high, np.nan), np.where(reached[:, None], beside, np.nan)


def pointing_error(both: Pair, time: np.ndarray) -> np.ndarray:
    """Angle (n,k) rad between the payload's x axis after ``time`` (n,k) s and the launch axis at
    the exit."""
    axis = rotation.at(both.payload_turn, time)[0][..., 0]
    return np.arctan2(np.hypot(axis[..., 1], axis[..., 2]), axis[..., 0])


def _limit(both: Pair, passes: np.ndarray) -> np.ndarray:
    """First time (n,) s at which the pointing error reaches its limit before the target is passed,
    infinite if it does not.

    The error cannot grow faster than the body rotates. So a step of the remaining angle over the
    largest rate never passes the limit.
    """
    limit, end = (
        both.flight.pointing_limit,
        np.where(np.isfinite(passes), passes, both.flight.duration),
    )
    if limit is None:
        return np.full(len(passes), np.nan)
    fastest = np.sqrt((both.payload_turn.amplitude[..., 0] ** 2).sum(axis=0))
    time = np.zeros(len(passes))
    for _ in range(_APPROACHES):
        left = limit - pointing_error(both, time[:, None])[:, 0]
        open_ = (left > _CLOSE) & (time < end)
        if not open_.any():
            break
        time = np.where(open_, time + left / np.maximum(fastest, 1e-12), time)
    return np.where(open_, np.nan, np.where(time < end, time, np.inf))


def cone(body: rotation.Free) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Smallest and largest angle (n,) rad of the body's x axis from the angular momentum, and the
    mean rate (n,) rad/s of the x axis about it.

    Principal axis 3 rotates with the precession. The x axis does too if the path of the momentum in
    body axes encloses x. Otherwise the rotation of the body about axis 3 carries x along.
    """
    period = rotation.nutation_period(body)
    _, rate = rotation.at(
        body, np.where(np.isfinite(period), period, 0.0)[:, None] * np.linspace(0.0, 1.0, _SCAN)
    )
    inertia = body.axes @ (body.moments[..., 0].T[..., None] * body.axes.transpose(0, 2, 1))
    momentum = np.einsum("nij,nkj->nki", inertia, rate)
    angle = np.arctan2(np.hypot(momentum[..., 1], momentum[..., 2]), momentum[..., 0])
    way = np.unwrap(np.arctan2(momentum[..., 2], momentum[..., 1]), axis=1)
    encircled = abs(way[:, -1] - way[:, 0]) > np.pi
    return (
        angle.min(axis=1),
        angle.max(axis=1),
        rotation.precession_rate(body) + np.where(encircled, 0.0, rotation.spin_rate(body)),
    )


def gap(both: Pair, time: np.ndarray) -> np.ndarray:
    """Clearance (n,k) m between payload and platform after ``time`` (n,k) s: the smallest
    separation of boxes."""
    bodies, flight = both.bodies, both.flight
    apart = orbit.back(
        flight.mean_motion,
        flight.axes,
        orbit.places(flight.mean_motion, both.payload - both.platform, time),
        time,
    )
    turn, frame = rotation.at(both.payload_turn, time)[0], rotation.at(both.platform_turn, time)[0]
    middle = np.einsum(
        "nkji,nkj->nki", frame, apart + np.einsum("nkij,nj->nki", turn, bodies.centre)
    )
    seen = frame.transpose(0, 1, 3, 2) @ turn
    gaps = [
        boxes.separation(
            seen,
            middle - bodies.boxes[:, None, box],
            bodies.half[:, None],
            bodies.box_halves[:, None, box],
        )
        for box in range(bodies.boxes.shape[1])
    ]
    return np.min(gaps, axis=0)


def clear_after(both: Pair) -> np.ndarray:
    """Time (n,) s after which the sphere about the payload is ahead of the platform, so the
    clearance only grows."""
    bodies, flight = both.bodies, both.flight
    along = (both.payload - both.platform) @ np.kron(np.eye(2), flight.axes[:, :1])
    front = (bodies.boxes + bodies.box_halves)[..., 0].max(axis=1)
    return (
        front
        + np.linalg.norm(bodies.half, axis=1)
        + np.linalg.norm(bodies.centre, axis=1)
        - along[:, 0]
    ) / along[:, 1]


def _kept(both: Pair) -> np.ndarray:
    """Smallest clearance (n,) m while the payload moves away, its time (n,) s, and the smallest gap
    (n,) m if the payload returns."""
    bodies, flight, away = both.bodies, both.flight, clear_after(both)
    clearance, closest = boxes.least(
        lambda time: gap(both, time), np.zeros(len(away)), away, _LOOKS, 2
    )
    reach = np.linalg.norm(abs(bodies.boxes) + bodies.box_halves, axis=2).max(axis=1)
    reach = reach + np.linalg.norm(bodies.half, axis=1) + np.linalg.norm(bodies.centre, axis=1)

    def spheres(time: np.ndarray) -> np.ndarray:
        return (
            np.linalg.norm(
                orbit.places(flight.mean_motion, both.payload - both.platform, time), axis=2
            )
            - reach[:, None]
        )

    far = np.linspace(0.0, 1.0, _SCAN) * flight.duration
    turned = far[spheres(np.broadcast_to(far, (len(away), _SCAN))).argmax(axis=1)]
    back, _ = boxes.least(spheres, turned, np.full(len(away), flight.duration), _LOOKS, 2)
    return np.stack(
        [
            clearance,
            closest,
            np.where((turned < flight.duration) & (back < flight.range), back, np.inf),
        ]
    )
