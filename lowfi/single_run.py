"""One run in progress: set-up, the sampled time loop, and its Trajectory."""

import time as clock
from collections.abc import Callable

import numpy as np

from tipoff.lowfi.contact import wall_ends
from tipoff.lowfi.contact.compliant import yielding
from tipoff.lowfi.dynamics import audit, balance, integrate
from tipoff.lowfi.dynamics.loop import Sampling
from tipoff.lowfi.dynamics.sample import SAMPLE_SIZE
from tipoff.lowfi.numerics import Numerics, promises_of
from tipoff.lowfi.preparation import prepare
from tipoff.mechanics import books, comoving, outcome, promises
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import launch, scene_model
from tipoff.scenes.rail_compliance import model_of
from tipoff.scenes.scene import Scene

_ROWS = 65_536  # samples allocated at first
_STRIDE = 5e-3  # s between reports of progress
_REASONS = {
    integrate.UNDERFLOW: "no step is short enough: the state is no longer finite or its equations too "
    "stiff",
    integrate.NOT_FINITE: "a value became infinite",
    integrate.OUT_OF_STEPS: "the step budget is spent (numerics.maximum_steps)",
    integrate.LOST_ENERGY: "a tenth of the energy is lost or came from nothing",
}
_RERUNS = 4  # each at a tenth of the tolerance, while that halves the errors of the ledgers


class SingleRun:
    """State of a run in progress and its samples; the last has the number ``end``. A ``whole`` run
    continues to the end of the scene even if exit and jam are settled. It keeps the promises of
    ``numerics``, with the steps of ``finer`` ones if given. A run without modes that ``watches``
    them finds their effect. A run ``like`` another one of the same scene has the same records of it."""

    reruns, discarded = 0, 0  # runs of the scene before this one, and their steps

    def __init__(
        self,
        scene: Scene,
        numerics: Numerics,
        compliance: RailCompliance | None = None,
        finer: Numerics | None = None,
        watches: bool = False,
        like: "SingleRun | None" = None,
    ):
        self.scene, self.numerics, self.compliance = scene, numerics, compliance
        self.watches, self.modes = watches, numerics.count
        self.promised = promises_of(numerics)
        self.used = finer or numerics
        self.model: scene_model.Model = like.model if like else scene_model.build(scene)
        model = self.model
        self.interval = scene.output.interval
        self.end = scene.output.last(scene.time_limit)
        self.expected = scene.output.last(scene.expected_end)
        self.marks: outcome.Milestones = (
            like.marks if like else outcome.milestones(launch.of_scene(scene), scene.time_limit)
        )
        self.system, self.plan, self.tolerance, _, self.loop, self.cases = prepare(
            scene, [model], self.marks, self.used, self.promised, compliance, watches
        )
        first = min(self.end + 1, _ROWS)
        self.rows, self.forces = (
            np.zeros((first, SAMPLE_SIZE)),
            np.zeros((first, model.faces.axis.size, 3)),
        )
        self.loads = books.no_loads(int(model.faces.guide.max(initial=-1)) + 1)
        self.last, self.taken, self.whole, self.message = self.end, 0, False, ""

    def begin(self) -> None:
        """Take the first sample; compiles the kernels, or loads them from disk."""
        self.advance(0)

    def integrate(self, progress) -> None:
        """Advance to the end of the run. If ``progress`` is reported, it takes some samples at a
        time, because each call of the kernel takes some microseconds for its records."""
        stride = max(1, round(_STRIDE / self.interval)) if progress else self.end + 1
        while self.taken <= self.end and not self.message:
            if self.taken == len(self.rows):
                self._grow()
            self.advance(min(self.taken - 1 + stride, len(self.rows) - 1))
            if progress:
                progress(min(1.0, self.taken / (min(self.end, self.expected) + 1)))

    def _grow(self) -> None:
        """Double the allocated samples: few runs last as long as they may."""
        more = min(len(self.rows), self.end + 1 - len(self.rows))
        self.rows = np.concatenate([self.rows, np.zeros((more, *self.rows.shape[1:]))])
        self.forces = np.concatenate([self.forces, np.zeros((more, *self.forces.shape[1:]))])

    def advance(self, number: int) -> None:
        """Take samples up to ``number``; fewer if exit or jam end the run."""
        status = integrate.integrate(*self.arguments(number))
        self.taken = int(self.loop.counts.samples)
        if status == integrate.STRUCK:
            self.message = self._strike()
        elif status in _REASONS:
            self.message = f"{_REASONS[status]}, at {self.loop.clock.now:.6g} s"
            if status == integrate.UNDERFLOW:
                loop, pressed = self.loop, self.system.compliance
                cause = yielding.words(pressed, loop.touching, loop.before)
                self.message = "; ".join(filter(None, [self.message, cause]))
        elif status == integrate.ENDED:
            self.end = self.taken - 1

    def arguments(self, number: int) -> tuple:
        """Arguments of ``integrate.integrate`` for samples up to ``number``."""
        sampling = Sampling(
            interval=self.interval,
            last=self.last,
            number=number,
            whole=self.whole,
            rows=self.rows,
            forces=self.forces,
            loads=self.loads,
        )
        parts = self.system, self.plan, self.tolerance, self.marks, self.loop, self.cases
        return *parts, sampling

    def _strike(self) -> str:
        """Message of a face that struck an edge of a wall, with place and time."""
        face = int(self.loop.counts.striking_face)
        surveyed, time = self.loop.after[face], float(self.loop.clock.now)
        return wall_ends.strike(self.model, face, self.system.faces[face], surveyed, time)

    def release(self) -> None:
        """Forget the compliance in the records of a run that has ended. On a long rail it is large, and
        the next run may have one with other modes."""
        self.system = self.system._replace(compliance=None)

    def usage(self) -> float:
        """Largest error of a ledger at the ends of steps over half of its promise."""
        return float(audit.usage(self.loop.audit, self.tolerance.total, self.tolerance.transverse))

    def neglected(self) -> np.ndarray:
        """Effect (n,) on the settled rates (rad/s) of each mode of all rails if it vibrated; for a run
        that watches."""
        assert self.system.neglected is not None
        return self.system.neglected.effect.copy()

    def lost_energy(self) -> bool:
        """Whether the run stopped because it lost a tenth of its energy."""
        return bool(self.loop.audit.failed)

    def judged(self) -> tuple[str, outcome.Outcome]:
        """Status and outcome of the run so far, in the frame of the solution."""
        if self.message:
            return "diverged", outcome.Outcome()
        status, found = books.found(self.loop.book)
        return status, outcome.with_impulse(found, self.model)

    def motion(self) -> outcome.Motion:
        """Motion of the samples so far, in the frame of the solution (``mechanics.comoving``)."""
        return balance.motion(self.rows[: self.taken], self.interval)

    def trajectory(self) -> Trajectory:
        """The result of the samples so far."""
        moved, rows, forces = self.motion(), self.rows[: self.taken], self.forces[: self.taken]
        total, across = balance.ledgers(rows)
        checks = balance.checks(rows, moved, forces, self.model, self.loop, self.promised)
        broken, seen_from = promises.broken(checks, self.promised), comoving.frame(self.model)
        status, result = ("diverged", outcome.Outcome()) if broken else self.judged()
        pressed = outcome.pressed_at_ignition(self.model, self.forces[0])
        message = "; ".join(filter(None, [self.message, broken, self._again(), pressed]))
        return Trajectory(
            model=model_of(self.scene, self.compliance),
            status=status,
            message=message,
            **comoving.motion(seen_from, moved)._asdict(),
            pad_force=forces,
            **books.named_loads(self.loads[0]),
            energy=total,
            transverse_energy=across,
            outcome=comoving.outcome(seen_from, result),
            checks=checks,
            cost=self._cost(),
            scene=self.scene.resolved(),
            numerics=self.numerics.as_dict(),
        )

    def _again(self) -> str:
        """Text about smaller steps than requested, or ""."""
        if not self.reruns:
            return ""
        times = "once" if self.reruns == 1 else f"{self.reruns} times"
        return (
            f"it was run again {times}, with relative_tolerance {self.used.relative_tolerance:.3g}, "
            f"for the energy ledgers to close"
        )

    def _cost(self) -> dict[str, float]:
        """Counts; dt_limit_s is the smallest proven limit in contact, limit_used the largest step
        over its limit. If the scene was run again: the number of earlier runs and their steps."""
        clock_, counts = self.loop.clock, self.loop.counts
        steps, limit = int(counts.steps), float(clock_.limit)
        cost = {
            "steps": steps,
            "rhs_evaluations": int(counts.evaluations),
            "rejected": int(counts.rejected),
            "events": int(counts.events),
            "dt_s": float(clock_.now) / max(steps, 1),
            "limit_used": float(clock_.limit_used),
        }
        again = {"reruns": self.reruns, "discarded_steps": self.discarded} if self.reruns else {}
        return cost | again | ({"dt_limit_s": limit} if np.isfinite(limit) else {})


def integrated(
    run_: SingleRun, progress: Callable[[float], None] | None, spent: dict[str, float]
) -> SingleRun:
    """``run_`` integrated, and repeated with smaller steps if necessary; adds its times (s) to
    ``spent``."""
    compiled, cpu = len(integrate.integrate.overloads), clock.thread_time()
    setting_up = clock.perf_counter()
    run_.begin()
    integrating = clock.perf_counter()
    if len(integrate.integrate.overloads) > compiled:
        spent["compile_s"] += integrating - setting_up
        spent["compile_cpu_s"] += clock.thread_time() - cpu
    run_.integrate(progress)
    run_ = improved(run_, progress)
    run_.release()
    spent["kernel_s"] += clock.perf_counter() - integrating
    return run_


def improved(first: SingleRun, progress: Callable[[float], None] | None = None) -> SingleRun:
    """``first``, which is integrated, or the same scene with smaller steps if its ledgers need
    them."""
    best, numerics = first, first.numerics
    for reruns in range(1, _RERUNS + 1):
        if (
            best.usage() <= 1.0
            or (best.message and not best.lost_energy())
            or numerics == numerics.tightened()
        ):
            break
        numerics = numerics.tightened()
        finer = SingleRun(
            first.scene,
            first.numerics,
            first.compliance,
            numerics,
            first.watches,
            first,
        )
        finer.reruns, finer.discarded = reruns, best.discarded + int(best.loop.counts.steps)
        finer.begin()
        finer.integrate(progress)
        usage, best = best.usage(), finer
        if finer.usage() > 0.5 * usage and not usage == np.inf:
            break
    return best
