"""Step of a run: the largest one below the limit that divides the sampling interval. Sampling
intervals that are multiples of ``RASTER`` give the same step.

The limit comes from the assembled rail. Its highest frequency is well below the highest one of its
elements.
"""

from dataclasses import asdict, dataclass

from tipoff.highfi.dynamics.step_limit import (
    contact_frequency_squared,
    damping_ratio,
    of_pushers,
    step_limit,
    used,
)
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.statics import stable_step
from tipoff.scenes.scene import Scene

RASTER = 5e-5  # s, default sampling interval of a scene
STEPS_PER_CHECK = 250  # at most, between two checks of the balances
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Stepping:
    """Step of a run and its limits."""

    dt_s: float  # the step
    dt_limit_s: float  # critical step with contact and damping
    dt_element_s: float  # critical step by the frequencies of single elements
    safety: float  # requested fraction of the critical step
    steps_per_sample: int
    damping_ratio: float  # at the highest frequency

    def as_dict(self) -> dict:
        """Plain values, as written into results."""
        return asdict(self)

    def used(self, parts: int = 1) -> float:
        """Share of the stability condition in ``step_limit`` that a step in so many ``parts`` uses,
        without friction; the critical step uses 1."""
        return used(self.dt_s / parts, self.dt_limit_s, self.damping_ratio)


def raster_steps(stepping: Stepping, interval: float) -> int:
    """Steps in the time that the step divides: ``RASTER`` or the sampling ``interval`` (s)."""
    count = round(RASTER / stepping.dt_s)
    divides = abs(count * stepping.dt_s - RASTER) <= _ROUNDING * RASTER
    return count if divides and interval >= RASTER else stepping.steps_per_sample


def choose(system: System, scene: Scene, numerics: Numerics) -> Stepping:
    """Step of a run. Raises StepError when ``numerics.step`` is above the limit."""
    pushers = of_pushers(system)
    contact = contact_frequency_squared(system) + pushers.stiffness
    by_elements = stable_step.element_bound(system.operator)
    # A rail whose nodes are all clamped has no frequency.
    assembled = (
        stable_step.operator_bound(system.operator).upper
        if system.operator.free.any()
        else by_elements
    )
    damping = system.rail.damping
    limit, by_elements = (
        step_limit(damping, rail, contact, pushers.damping) for rail in (assembled, by_elements)
    )
    interval = scene.output.interval
    divided = interval if numerics.step else _divided(interval, numerics.safety * limit)
    step = stable_step.choose_step(limit, numerics.safety, divided, numerics.step)
    return Stepping(
        dt_s=step,
        dt_limit_s=limit,
        dt_element_s=by_elements,
        safety=numerics.safety,
        steps_per_sample=round(interval / step),
        damping_ratio=damping_ratio(damping, assembled, contact, pushers.damping),
    )


def _divided(interval: float, largest: float) -> float:
    """The time (s) that a step of at most ``largest`` (s) divides: ``RASTER`` if it divides the
    interval. So the sampling interval changes no bit of the result."""
    count = round(interval / RASTER)
    return (
        RASTER
        if largest <= RASTER and count > 0 and abs(interval / RASTER - count) <= _ROUNDING * count
        else interval
    )
