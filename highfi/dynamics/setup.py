"""What is constant in a run of the reference."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tipoff.highfi.dynamics import ending, linear_range, monitor, resting
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.step_size import STEPS_PER_CHECK, Stepping, raster_steps
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.rail import spin
from tipoff.highfi.state.records import Exit
from tipoff.highfi.state.threads import Team, team_of
from tipoff.mechanics import outcome
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Setup:
    """Constants of a run."""

    scene: Scene
    system: System
    stepping: Stepping
    rails: Rails | None  # that can rest; None: all rails are always stepped
    exit: Exit
    milestones: outcome.Milestones
    monitor: monitor.Monitor  # of stress
    team: Team  # all threads
    alone: Team  # one thread, while no rail is stepped
    pool: ThreadPoolExecutor
    interval: int  # steps from one decision on rest or substeps to the next
    most: int  # steps of the run
    expected: float  # s, duration
    reach: float  # m, from the frame's origin to the farthest node
    small: float  # m, see ``linear_range.small``
    slow: float  # rad/s, rate of the platform that is within the limit for any rail

    @cached_property
    def lowest_frequency(self) -> float:
        """Lowest frequency (rad/s) of the rails held at their mounts."""
        return spin.lowest_frequency(self.scene, self.system.mesh)

    @cached_property
    def _views(self) -> dict[bytes, System]:
        return {}

    def view(self, rests: np.ndarray) -> System:
        """The system in which the rails ``rests`` (rails,) at rest belong to the rigid part."""
        if self.rails is None:
            return self.system
        key = rests.tobytes()
        if key not in self._views:
            self._views[key] = resting.view(self.system, self.rails, rests)
        return self._views[key]


def set_up(
    scene: Scene, system: System, stepping: Stepping, threads: int = 1, rails: Rails | None = None
) -> Setup:
    """Constants of a run of ``threads``."""
    raster = raster_steps(stepping, scene.output.interval)
    most = int(scene.time_limit / stepping.dt_s * (1.0 + _ROUNDING))
    return Setup(
        scene=scene,
        system=system,
        stepping=stepping,
        rails=rails,
        exit=ending.place(system),
        milestones=outcome.milestones(launch.of_scene(scene), scene.time_limit),
        monitor=monitor.build(system, scene.rail.material, stepping.steps_per_sample, threads),
        team=team_of(threads),
        alone=team_of(1),
        pool=ThreadPoolExecutor(threads),
        interval=raster * max(1, STEPS_PER_CHECK // raster),
        most=most,
        expected=min(most * stepping.dt_s, scene.expected_end),
        reach=float(np.linalg.norm(system.rail.points, axis=1).max()),
        small=linear_range.small(system),
        slow=spin.rate_never_checked(scene, system.mesh),
    )
