"""A launch as a motion along the rail: the numbers of a scene on which the estimates rest."""

import math
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.thrust import Thrust


class Launch(NamedTuple):
    """Numbers of one scene. Places along the rail are relative to the nominal mass centre."""

    thrust: Thrust  # over time; without both records for pushers
    pushers: Pushers | None  # thrust over travel
    steady: float  # N, of a constant thrust from ignition on; 0 for any other
    along: float  # share of the thrust along the rail
    mass: float  # kg, of the payload
    recoil: float  # 1/kg, acceleration of the platform per thrust, without rotation
    platform_inertia: np.ndarray | None  # (3,3) kg m2, of a platform that takes the reaction
    lever: (
        float  # m, largest distance across the rail of a pad from the mass centre of that platform
    )
    is_free: bool  # whether there is a platform
    body_force: BodyForce | None
    begun: float  # m/s, speed along the rail at ignition
    place: float  # m, of the payload along the rail at ignition
    turns: bool  # whether payload or platform turn at ignition
    rests: bool  # whether the payload is at rest, and no latch of 0 N takes its stop away
    latched: float  # s, time at which the latch releases; 0 without one
    rail: tuple[float, float]  # m, its start and its end
    pads: tuple[float, float]  # m, trailing edge of the rearmost, leading edge of the foremost
    friction: float  # static coefficient; 0 without friction or contact
    slow: float  # m/s, relative axial speed below which friction may hold the payload
    duration: float | None  # s, stated
    interval: float  # s, between samples

    @property
    def gain(self) -> float:
        """Acceleration of the payload relative to the rail per thrust (1/kg); the platform does not
        turn."""
        return 1.0 / self.mass + self.recoil

    @property
    def pull(self) -> float:
        """Acceleration (m/s2) along the rail relative to it by the body forces; zero on a free
        platform, which falls like the payload."""
        return self.body_force.x if self.body_force is not None and not self.is_free else 0.0

    @property
    def nominal_way(self) -> float:
        """``way`` (m) of a payload that begins at its nominal place."""
        return self.rail[1] - self.pads[0]

    @property
    def way(self) -> float:
        """Travel (m) along the rail from ignition to the exit: the trailing edge of the rearmost pad
        reaches the end of the rail. A payload that turns has a little more or less."""
        return self.nominal_way - self.place

    @property
    def rear_end(self) -> float:
        """Place (m) of the payload at which the leading edge of the foremost pad is at the start of the
        rail; -infinity for a payload that begins behind it."""
        place = self.rail[0] - self.pads[1]
        return place if place < self.place else -math.inf
