"""The step of a run: the largest one below the proven limit that lands on every sample."""

from dataclasses import asdict, dataclass

from highfi import timestep
from highfi.limits import contact_frequency_squared
from highfi.numerics import Numerics
from highfi.system import System
from scenes.scene import Scene


@dataclass(frozen=True)
class Stepping:
    """``dt_s`` the step, ``dt_limit_s`` the proven critical step with contact, ``safety`` asked for, ``steps_per_sample``."""

    dt_s: float
    dt_limit_s: float
    safety: float
    steps_per_sample: int

    def as_dict(self) -> dict:
        return asdict(self)


def choose(system: System, scene: Scene, numerics: Numerics) -> Stepping:
    """Step of a run. Raises StepError when ``numerics.step`` is above the limit."""
    rail = timestep.element_bound(system.operator)
    limit = timestep.critical_step((rail**2 + contact_frequency_squared(system)) ** 0.5)
    step = timestep.choose_step(limit, numerics.safety, scene.output.interval, numerics.step)
    return Stepping(step, limit, numerics.safety, round(scene.output.interval / step))
