"""The inertial frame of the solution. Its velocity is that of the platform's mass centre at
ignition.

Rounding depends on the frame: at 7.5 km/s, millimetres per second are the last digits of a
velocity, and a step control that compares errors with speeds finds no error. So both solvers
integrate

    r' = r - r_0 - V t,    v' = v - V,      r_0 the payload's displacement at ignition, V the platform's velocity then

and return positions and velocities in scene axes. Forces, rates, attitudes and times are the same
in both frames. Ledgers and momenta are those of the moving frame. Where the rails are fixed in
space, r_0 and V are zero.
"""

from typing import NamedTuple

import numpy as np

from tipoff.mechanics.outcome import Motion, Outcome


class Frame(NamedTuple):
    """Origin at ignition (m) and velocity (m/s) in scene axes."""

    origin: tuple
    velocity: tuple


class Start(NamedTuple):
    """Mass centres (m) and velocities (m/s) of payload and platform at ignition, in the moving
    frame; without a platform its own are zero."""

    place: np.ndarray
    velocity: np.ndarray
    platform_place: np.ndarray
    platform_velocity: np.ndarray


def frame(model) -> Frame:
    """The frame ``model`` is solved in."""
    if model.platform is None:
        return Frame((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return Frame(tuple(model.initial.position), tuple(model.initial.platform_velocity))


def start(model) -> Start:
    """Both bodies at ignition."""
    origin, velocity = frame(model)
    first, zero = model.initial, np.zeros(3)
    # The difference is taken first, so that a large displacement costs no digits.
    place = np.add(model.payload.mass_centre, np.subtract(first.position, origin))
    platform_place, platform_velocity = (
        (zero, zero)
        if model.platform is None
        else (
            np.subtract(model.platform.mass_centre, origin),
            np.subtract(first.platform_velocity, velocity),
        )
    )
    return Start(
        place=place,
        velocity=np.subtract(first.velocity, velocity),
        platform_place=platform_place,
        platform_velocity=platform_velocity,
    )


def motion(seen_from: Frame, moved: Motion) -> Motion:
    """``moved`` in the scene's axes."""
    if not (any(seen_from.origin) or any(seen_from.velocity)):
        return moved
    way = np.add(seen_from.origin, np.multiply.outer(moved.time, seen_from.velocity))
    return moved._replace(
        position=moved.position + way,
        velocity=moved.velocity + seen_from.velocity,
        platform_position=moved.platform_position + way,
        platform_velocity=moved.platform_velocity + seen_from.velocity,
    )


def outcome(seen_from: Frame, found: Outcome) -> Outcome:
    """``found`` in the scene's axes."""
    if found.velocity is None or not (any(seen_from.origin) or any(seen_from.velocity)):
        return found
    assert (
        found.exit_time is not None
        and found.exit_position is not None
        and found.exit_platform_position is not None
        and found.exit_platform_velocity is not None
    )  # as the velocity
    way = np.add(seen_from.origin, found.exit_time * np.array(seen_from.velocity))
    velocity = np.add(found.velocity, seen_from.velocity)
    lateral = float(np.hypot(velocity[1], velocity[2]))
    return found._replace(
        velocity=velocity.tolist(),
        lateral_velocity=lateral,
        direction_error=float(np.arctan2(lateral, velocity[0])),
        exit_position=np.add(found.exit_position, way).tolist(),
        exit_platform_position=np.add(found.exit_platform_position, way).tolist(),
        exit_platform_velocity=np.add(found.exit_platform_velocity, seen_from.velocity).tolist(),
    )
