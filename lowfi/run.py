"""One run of the surrogate: set-up, the sampled time loop, and the Trajectory it leaves."""

import time as clock
from typing import Callable, Sequence

import numpy as np

from lowfi import accuracy, audit, balance, bow, march, plan, state, system
from lowfi.march import EVALUATIONS, EVENTS, LIMIT, LIMIT_USED, NOW, REJECTED, STEPS, TAKEN
from lowfi.numerics import Numerics, promises_of
from lowfi.walls import record as wall_record
from lowfi.sample import SAMPLE_SIZE, relative_axial_speed
from scenes import comoving, outcome
from scenes import model as models
from scenes import promises
from scenes.calibration import Calibration
from scenes.scene import Scene
from scenes.trajectory import Trajectory
from scenes.walls import Walls

_REASONS = {march.UNDERFLOW: "no step is short enough: the state is no longer finite or its equations too stiff",
            march.NOT_FINITE: "a value became infinite",
            march.OUT_OF_STEPS: "the step budget is spent (numerics.maximum_steps)",
            march.LOST_ENERGY: "a tenth of the energy is lost or came from nothing"}
_RERUNS = 4  # at a tenth of the tolerance each, while that makes the ledgers' errors smaller by half at least
_BEYOND_WINDOW = 2  # samples past the settled window, for the spline that averages over it


def run(scene: Scene, calibration: Calibration | None = None, numerics: Numerics | None = None,
        progress: Callable[[float], None] | None = None, walls: Walls | None = None) -> Trajectory:
    """Solve ``scene`` with rigid rails until the settled window is complete, a jam, or the scene's duration.

    ``calibration`` replaces the scene's contact and friction constants; the message says where the scene lies outside what they
    were found for. With ``walls`` the pads press walls that give way, through the penalty of the reference, in place of the contact
    law; at rigid ones, which a warm scene asks for, that law acts where they stand. ``progress`` is called with the fraction of the
    duration done. A run whose ledgers do not close as promised is run again at tighter tolerances, as message and cost say; one
    that keeps breaking a promise is diverged. Raises SceneError before any stepping; what goes wrong later is the status of the
    result.
    """
    began, cpu = clock.perf_counter(), clock.thread_time()
    outside = calibration.outside(scene) if calibration else []
    scene = calibration.apply(scene) if calibration else scene
    known = len(march.march.overloads)
    setting_up = clock.perf_counter()
    run_ = Run(scene, numerics or Numerics(), walls)
    run_.begin()
    compile_s = clock.perf_counter() - setting_up if len(march.march.overloads) > known else 0.0
    compile_cpu = clock.thread_time()
    marching = clock.perf_counter()
    run_.march(progress)
    run_ = improved(run_, progress)
    kernel_s = clock.perf_counter() - marching
    result = run_.trajectory([f"outside the calibration: {words}" for words in outside])
    result.cost.update(wall_s=clock.perf_counter() - began - compile_s, compile_s=compile_s, kernel_s=kernel_s)
    result.cost["cpu_s"] = clock.thread_time() - (compile_cpu if compile_s else cpu)
    return result


def end_of(scene: Scene) -> int:
    """Number of the last sample before the scene's duration is over."""
    return max(1, round(scene.duration / scene.output.interval))


def improved(first: "Run", progress: Callable[[float], None] | None = None) -> "Run":
    """``first``, which has marched, or the same scene run again with smaller steps, because its ledgers call for them."""
    best, numerics = first, first.numerics
    for reruns in range(1, _RERUNS + 1):
        if best.usage() <= 1.0 or (best.message and not best.lost_energy()) or numerics == numerics.tightened():
            break
        numerics = numerics.tightened()
        finer = Run(first.scene, first.numerics, first.walls, numerics)
        finer.reruns, finer.discarded = reruns, best.discarded + int(best.loop.count[STEPS])
        finer.begin()
        finer.march(progress)
        usage, best = best.usage(), finer
        if finer.usage() > 0.5 * usage and not usage == np.inf:
            break
    return best


class Run:
    """State of a run in progress and its samples. It keeps the promises of ``numerics``, with the steps of ``finer`` ones if
    given."""

    reruns, discarded = 0, 0  # runs of the scene before this one, and their steps

    def __init__(self, scene: Scene, numerics: Numerics, walls: Walls | None = None, finer: Numerics | None = None):
        self.scene, self.numerics, self.walls, self.promised = scene, numerics, walls, promises_of(numerics)
        self.used = used = finer or numerics
        self.model = model = models.build(scene)
        self.marks = outcome.milestones(scene, model)
        self.interval = scene.output.interval
        self.end = end_of(scene)
        self.plan = plan.make(model, self.interval, self.end * self.interval, used)
        reach = float(np.sqrt((model.faces.centre**2).sum(axis=1).max()))
        self.tolerance = accuracy.tolerance(used, self.promised, reach)
        self.system = system.build(model, walls=wall_record.under_pads(scene, model, walls),
                                   bow=bow.under_pads(scene, model, walls))
        self.loop = march.ready(self.system, state.initial(model), plan.first_step(self.plan))
        self.rows, self.forces = np.zeros((self.end + 1, SAMPLE_SIZE)), np.zeros((self.end + 1, model.faces.axis.size, 3))
        self.taken, self.left, self.message = 0, False, ""

    def begin(self) -> None:
        """Take the first sample; compiles the kernels, or loads them from disk."""
        self._advance(0)

    def march(self, progress) -> None:
        """Advance look by look until something ends the run."""
        stride = max(1, round(outcome.JAM_DURATION / self.interval))
        while self.taken <= self.end and not self.message:
            self._advance(min(self.taken - 1 + stride, self.end))
            if progress:
                progress(min(1.0, (self.taken - 1) / self.end))

    def _advance(self, number: int) -> None:
        """Take samples up to ``number``, fewer where the payload leaves the rail; then look what is known of the end."""
        watched = not self.left
        status = march.march(self.system, self.plan, self.tolerance, self.loop, number, watched, self.rows, self.forces)
        self.taken = int(self.loop.count[TAKEN])
        if status in _REASONS:
            self.message = f"{_REASONS[status]}, at {self.loop.clock[NOW]:.6g} s"
        elif watched:
            self._look(status == march.PASSED)

    def usage(self) -> float:
        """Largest share that a ledger uses of half of what is promised of it at the ends of steps."""
        return float(audit.usage(self.loop.audit, self.tolerance.total, self.tolerance.across))

    def keeps_ledgers(self) -> bool:
        """Whether both ledgers close as promised at the ends of all steps."""
        total, across = audit.errors(self.loop.audit, self.tolerance.total, self.tolerance.across)
        return total <= self.tolerance.total and across <= self.tolerance.across

    def lost_energy(self) -> bool:
        """Whether the run stopped because a tenth of its energy was lost."""
        return bool(self.loop.audit[audit.LOST] != 0.0)

    def _look(self, passed: bool) -> None:
        if not passed and self._is_moving():
            return
        recent = self._motion(max(0, self.taken - 2 - round(2.0 * outcome.JAM_DURATION / self.interval)))
        if passed:
            exit_at = outcome.exit_time(recent, self.marks)
            self.left = exit_at is not None
            if self.left:
                settled = outcome.window_start(exit_at, self.marks) + outcome.SETTLE_WINDOW
                self.end = min(self.end, int(np.ceil(settled / self.interval)) + _BEYOND_WINDOW)
        elif outcome.is_jammed(recent, self.marks):
            self.end = self.taken - 1

    def _is_moving(self) -> bool:
        """Whether the payload cannot be jammed by now, judged cheaply."""
        last = self.taken - 1
        return not (outcome.may_be_jammed(last * self.interval, self.marks)
                    and abs(relative_axial_speed(self.system.platform, self.rows[last])) < 2.0 * self.marks.jam_speed)

    def _motion(self, first: int = 0) -> outcome.Motion:
        return balance.motion(self.rows[first:self.taken], first, self.interval)

    def trajectory(self, warnings: Sequence[str] = ()) -> Trajectory:
        """The result of the samples taken so far; its message also holds ``warnings``."""
        moved, rows, forces = self._motion(), self.rows[:self.taken], self.forces[:self.taken]
        total, across = balance.ledgers(rows)
        checks = balance.checks(rows, moved, forces, self.model.payload.mass, self.loop, self.promised)
        status, result = outcome.judge(moved, self.marks)
        broken = promises.broken(checks, self.promised)
        if self.message or broken:
            status, result = "diverged", outcome.Outcome()
        pressed = outcome.pressed_at_ignition(self.model.faces, self.forces[0])
        message = "; ".join(filter(None, [self.message, broken, self._again(), pressed, *warnings]))
        seen_from = comoving.frame(self.model)
        return Trajectory(
            fidelity="lowfi", status=status, message=message, **comoving.motion(seen_from, moved)._asdict(), pad_force=forces,
            energy=total, transverse_energy=across, outcome=comoving.outcome(seen_from, result, self.interval), checks=checks,
            cost=self._cost(), scene=self.scene.resolved(), numerics=self.numerics.as_dict())

    def _again(self) -> str:
        """That smaller steps than asked for were taken, or nothing."""
        if not self.reruns:
            return ""
        times = "once" if self.reruns == 1 else f"{self.reruns} times"
        return f"run again {times}, with relative_tolerance {self.used.relative_tolerance:.3g}, for the energy ledgers to close"

    def _cost(self) -> dict[str, float]:
        """Counts; dt_limit_s is the smallest proven limit met while anything touched, limit_used the largest step over its limit.
        Where the scene was run again, how often, and the steps of the runs before."""
        clock_, count = self.loop.clock, self.loop.count
        steps, limit = int(count[STEPS]), float(clock_[LIMIT])
        cost = {"steps": steps, "rhs_evaluations": int(count[EVALUATIONS]), "rejected": int(count[REJECTED]),
                "events": int(count[EVENTS]), "dt_s": float(clock_[NOW]) / max(steps, 1), "limit_used": float(clock_[LIMIT_USED])}
        again = {"reruns": self.reruns, "discarded_steps": self.discarded} if self.reruns else {}
        return cost | again | ({"dt_limit_s": limit} if np.isfinite(limit) else {})
