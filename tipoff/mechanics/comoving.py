"""The frame of the solution. Its velocity is that of the platform's mass centre at ignition, and it
falls freely.

Rounding depends on the frame: at 7.5 km/s, millimetres per second are the last digits of a
velocity, and a step control that compares errors with speeds finds no error. A common body force
accelerates payload and platform alike. It changes no relative motion, but it would change errors
and steps. So both solvers integrate

    r' = r - r_0 - V t - a t^2 / 2,    v' = v - V - a t

with the payload's displacement r_0 and the platform's velocity V at ignition, and the body force
per mass a. They return positions and velocities in scene axes. Contact, thrust, rates, attitudes
and times are the same in both frames. In the moving frame no body force acts; ledgers and momenta
are those of this frame. If the rails are fixed in space, r_0, V and a are zero, and the body force
acts on the payload (``mechanics.model``).
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.mechanics.run_limits import EXIT_WINDOW, SETTLE_WINDOW

if TYPE_CHECKING:
    from tipoff.mechanics.outcome import Motion, Outcome


class Frame(NamedTuple):
    """Frame of the solution, in scene axes."""

    origin: tuple  # (3,) m, at ignition
    velocity: tuple  # (3,) m/s, at ignition
    acceleration: tuple  # (3,) m/s2

    @property
    def is_that_of_the_scene(self) -> bool:
        """Whether it is at rest at the scene's origin."""
        return not (any(self.origin) or any(self.velocity) or any(self.acceleration))

    def speed(self, time) -> np.ndarray:
        """Velocity (...,3) m/s at ``time`` (...) s."""
        return np.add(self.velocity, np.multiply.outer(time, self.acceleration))

    def place(self, time) -> np.ndarray:
        """Place (...,3) m of the origin at ``time`` (...) s."""
        mean = np.add(self.velocity, np.multiply.outer(time, np.multiply(0.5, self.acceleration)))
        return np.add(self.origin, np.expand_dims(time, -1) * mean)


class Start(NamedTuple):
    """Payload and platform at ignition, in the moving frame; zeros for a missing platform."""

    place: np.ndarray  # (3,) m, mass centre of the payload
    velocity: np.ndarray  # (3,) m/s
    platform_place: np.ndarray  # (3,) m, mass centre
    platform_velocity: np.ndarray  # (3,) m/s


def frame(model) -> Frame:
    """The frame of the solution of ``model``."""
    zero = (0.0, 0.0, 0.0)
    if model.platform is None:
        return Frame(zero, zero, zero)
    return Frame(
        origin=tuple(model.initial.position),
        velocity=tuple(model.initial.platform_velocity),
        acceleration=zero if model.fall is None else tuple(model.fall),
    )


def start(model) -> Start:
    """Both bodies at ignition."""
    origin, velocity, _ = frame(model)
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


def motion(seen_from: Frame, moved: "Motion") -> "Motion":
    """``moved`` in the scene's axes."""
    if seen_from.is_that_of_the_scene:
        return moved
    way, speed = seen_from.place(moved.time), seen_from.speed(moved.time)
    return moved._replace(
        position=moved.position + way,
        velocity=moved.velocity + speed,
        platform_position=moved.platform_position + way,
        platform_velocity=moved.platform_velocity + speed,
    )


def outcome(seen_from: Frame, found: "Outcome") -> "Outcome":
    """``found`` in the scene's axes."""
    if found.exit_time is None or seen_from.is_that_of_the_scene:
        return found
    if found.exit_velocity is not None:
        middle = found.exit_time + 0.5 * EXIT_WINDOW
        mean = np.add(found.exit_velocity, seen_from.speed(middle))
        found = found._replace(exit_velocity=mean.tolist())
    if found.velocity is None:
        return found
    assert (
        found.window_start is not None
        and found.exit_position is not None
        and found.exit_platform_position is not None
        and found.exit_platform_velocity is not None
    )  # as the velocity
    way, speed = seen_from.place(found.exit_time), seen_from.speed(found.exit_time)
    # a mean over the window equals a linear function at its middle
    velocity = np.add(found.velocity, seen_from.speed(found.window_start + 0.5 * SETTLE_WINDOW))
    lateral = float(np.hypot(velocity[1], velocity[2]))
    return found._replace(
        velocity=velocity.tolist(),
        lateral_velocity=lateral,
        direction_error=float(np.arctan2(lateral, velocity[0])),
        exit_position=np.add(found.exit_position, way).tolist(),
        exit_platform_position=np.add(found.exit_platform_position, way).tolist(),
        exit_platform_velocity=np.add(found.exit_platform_velocity, speed).tolist(),
    )
