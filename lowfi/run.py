"""One run of the surrogate: set-up, the sampled time loop, and the Trajectory it leaves."""

import time as clock
from typing import Callable

import numpy as np

from lowfi import balance, bow, edges, march, plan, state, system
from lowfi.accuracy import Tolerance
from lowfi.march import EVALUATIONS, EVENTS, LIMIT, LIMIT_USED, NOW, REJECTED, STEPS, STRIKING, TAKEN, Sampling
from lowfi.models import require
from lowfi.numerics import Numerics
from lowfi.walls import record as wall_record
from lowfi.sample import SAMPLE_SIZE
from scenes import ending, outcome
from scenes import model as models
from scenes.calibration import Calibration
from scenes.fidelity import COMPLIANT
from scenes.scene import Scene
from scenes.trajectory import Trajectory
from scenes.walls import Walls, model_of

_STRIDE = 5e-3  # s, from one report of progress to the next
_REASONS = {march.UNDERFLOW: "no step is short enough: the state is no longer finite or its equations too stiff",
            march.NOT_FINITE: "a value became infinite",
            march.OUT_OF_STEPS: "the step budget is spent (numerics.maximum_steps)"}


def run(scene: Scene, model: str = COMPLIANT, *, walls: Walls | None = None, calibration: Calibration | None = None,
        numerics: Numerics | None = None, progress: Callable[[float], None] | None = None) -> Trajectory:
    """Solve ``scene`` with rigid bodies until the settled window is complete, a jam, or the scene's duration.

    The ``model`` is ``compliant``: pads press on the rail compliance ``walls`` (``calibrate.compliance``) through the penalty of
    the reference; or ``springs``: the scene's contact law at each pad face, with the constants of a ``calibration`` if one is
    given, on rigid ``walls`` where the rails are warm. ``progress`` is called with the fraction of the duration done. Raises
    SceneError, every fault listed, before any stepping; what goes wrong later is the status of the result.
    """
    require(scene, model, walls, calibration, numerics)
    return solved(scene, calibration, numerics, progress, walls)


def solved(scene: Scene, calibration: Calibration | None = None, numerics: Numerics | None = None,
           progress: Callable[[float], None] | None = None, walls: Walls | None = None) -> Trajectory:
    """``run`` without its check that options belong to a model: the model is the one that ``walls`` make."""
    began, cpu = clock.perf_counter(), clock.thread_time()
    scene = calibration.apply(scene) if calibration else scene
    known = len(march.march.overloads)
    setting_up = clock.perf_counter()
    run_ = Run(scene, numerics or Numerics(), walls)
    run_.begin()
    compile_s = clock.perf_counter() - setting_up if len(march.march.overloads) > known else 0.0
    compile_cpu = clock.thread_time()
    marching = clock.perf_counter()
    run_.march(progress)
    kernel_s = clock.perf_counter() - marching
    result = run_.trajectory()
    result.cost.update(wall_s=clock.perf_counter() - began - compile_s, compile_s=compile_s, kernel_s=kernel_s)
    result.cost["cpu_s"] = clock.thread_time() - (compile_cpu if compile_s else cpu)
    return result


class Run:
    """State of a run in progress and its samples, up to number ``end`` as far as is known; one that is ``whole`` goes on to the end
    of the scene although nothing is left to learn of exit and jam."""

    def __init__(self, scene: Scene, numerics: Numerics, walls: Walls | None = None):
        self.scene, self.numerics, self.walls = scene, numerics, walls
        self.model = model = models.build(scene)
        self.marks = outcome.milestones(scene, model)
        self.interval = scene.output.interval
        self.end = scene.output.last(scene.duration)
        self.plan = plan.make(model, scene.duration, numerics)
        reach = float(np.sqrt((model.faces.centre**2).sum(axis=1).max()))
        self.tolerance = Tolerance(numerics.relative_tolerance, numerics.speed_floor, reach)
        self.system = system.build(model, walls=wall_record.under_pads(scene, model, walls, numerics.modes),
                                   bow=bow.under_pads(scene, model, walls))
        self.loop = march.ready(self.system, state.initial(model), plan.first_step(self.plan))
        self.rows, self.forces = np.zeros((self.end + 1, SAMPLE_SIZE)), np.zeros((self.end + 1, model.faces.axis.size, 3))
        self.last, self.taken, self.whole, self.message = self.end, 0, False, ""

    def begin(self) -> None:
        """Take the first sample; compiles the kernels, or loads them from disk."""
        self._advance(0)

    def march(self, progress) -> None:
        """Advance, some samples at a time, until something ends the run."""
        stride = max(1, round(_STRIDE / self.interval))
        while self.taken <= self.end and not self.message:
            self._advance(min(self.taken - 1 + stride, self.end))
            if progress:
                progress(self.taken / (self.end + 1))

    def _advance(self, number: int) -> None:
        """Take samples up to ``number``, fewer where nothing is left to learn."""
        sampling = Sampling(self.interval, self.last, number, self.whole)
        status = march.march(self.system, self.plan, self.tolerance, self.marks, self.loop, sampling, self.rows, self.forces)
        self.taken = int(self.loop.count[TAKEN])
        if status == march.STRUCK:
            self.message = self._strike()
        elif status in _REASONS:
            self.message = f"{_REASONS[status]}, at {self.loop.clock[NOW]:.6g} s"
        elif status == march.ENDED:
            self.end = self.taken - 1

    def _strike(self) -> str:
        """What met the edge of a wall, where and when."""
        face = int(self.loop.count[STRIKING])
        return edges.strike(self.model, face, self.system.faces[face], self.loop.after[face], self.loop.clock[NOW])

    def judged(self) -> tuple[str, outcome.Outcome]:
        """Status and outcome of the run so far."""
        return ("diverged", outcome.Outcome()) if self.message else ending.found(self.loop.book)

    def motion(self) -> outcome.Motion:
        """Motion of the samples taken so far."""
        return balance.motion(self.rows[:self.taken], self.interval)

    def trajectory(self) -> Trajectory:
        """The result of the samples taken so far."""
        moved, rows = self.motion(), self.rows[:self.taken]
        total, across = balance.ledgers(rows)
        status, result = self.judged()
        pressed = outcome.pressed_at_ignition(self.model.faces, self.forces[0])
        message = "; ".join(filter(None, [self.message, pressed]))
        return Trajectory(
            model=model_of(self.scene, self.walls), status=status, message=message,
            **moved._asdict(), pad_force=self.forces[:self.taken], energy=total, transverse_energy=across, outcome=result,
            checks=balance.checks(rows, moved, total, across, self.model.payload.mass, self.loop.clock), cost=self._cost(),
            scene=self.scene.resolved(), numerics=self.numerics.as_dict())

    def _cost(self) -> dict[str, float]:
        """Counts; dt_limit_s is the smallest proven limit met while anything touched,
        limit_used the largest step over its limit."""
        clock_, count = self.loop.clock, self.loop.count
        steps, limit = int(count[STEPS]), float(clock_[LIMIT])
        cost = {"steps": steps, "rhs_evaluations": int(count[EVALUATIONS]), "rejected": int(count[REJECTED]),
                "events": int(count[EVENTS]), "dt_s": float(clock_[NOW]) / max(steps, 1), "limit_used": float(clock_[LIMIT_USED])}
        return cost | ({"dt_limit_s": limit} if np.isfinite(limit) else {})
