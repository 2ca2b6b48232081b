"""One run of the finite-element reference: set-up, the sampled time loop, and its Trajectory."""

import threading
import time as clock
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path

import numpy as np

from tipoff.files import tell
from tipoff.highfi import result
from tipoff.highfi.dynamics import ending, jolts, linear_range, observe, resting, substeps
from tipoff.highfi.dynamics.checkpoint import Checkpoint
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.step import ADVANCE, EVALUATE, KICK, OPEN, Task, perform
from tipoff.highfi.dynamics.step_size import STEPS_PER_CHECK, Stepping, choose
from tipoff.highfi.dynamics.system import System, build, initial_state
from tipoff.highfi.dynamics.waking import Watch
from tipoff.highfi.faults import fault
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail import spin, step_cost
from tipoff.highfi.rail.fit import check_fit
from tipoff.highfi.rail.memory_check import check_before, check_mesh
from tipoff.highfi.rail.scene_mesh import geometry, make_mesh
from tipoff.highfi.state import records
from tipoff.highfi.state.threads import Team, processors, team_of
from tipoff.highfi.stress import monitor, peak
from tipoff.kernels import rotation
from tipoff.mechanics import outcome
from tipoff.mechanics.ending import DONE, WINDOW, is_left_out
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.scene import Scene

_ELEMENTS_PER_THREAD = 4000
_REPORT_EVERY = 20  # checks from one report of progress to the next
_ROUNDING = 1e-9
MESHES: dict[tuple, RailMesh] = {}  # made by this process, by geometry and element size (m)
_MESH_LOCK = threading.Lock()


def prepare(scene: Scene, numerics: Numerics | None = None) -> RailMesh:
    """Mesh of a scene, made once per process. gmsh, which meshes solids, must run in the main
    thread: call this there before runs in other threads.

    Raises SceneError (also for lack of memory), MeshError, or GmshUnavailable if a solid cannot be
    meshed here.
    """
    require_two_step(scene)
    numerics = numerics or Numerics()
    key = (geometry(scene), numerics.element_size)
    with _MESH_LOCK:
        if key not in MESHES:
            check_before(scene, numerics.element_size)
            mesh = make_mesh(scene, numerics.element_size)
            check_mesh(scene, numerics.element_size, mesh)
            MESHES[key] = mesh
        mesh = MESHES[key]
    check_fit(scene, mesh)
    spin.check(scene, mesh)
    return mesh


def run(
    scene: Scene,
    numerics: Numerics | None = None,
    progress: Callable[[float], None] | None = None,
    threads: int | None = None,
    checkpoint: str | Path | None = None,
    checkpoint_every: float = 60.0,
    resume: bool = False,
    observer: Callable[["Loop"], None] | None = None,
) -> Trajectory:
    """Solve ``scene`` with flexible rails until the settled window is complete, the payload jams,
    or the scene's time limit is reached.

    ``progress`` is called with the completed fraction of the expected time. ``threads`` share the
    run (None: as many as there are processors, ``OMP_NUM_THREADS`` at most, and elements enough for
    them); the result does not depend on their number. The run is written to the file ``checkpoint``
    every ``checkpoint_every`` seconds (wall clock), and the file stays. With ``resume`` the run
    continues from that file if it exists, to the same bits; its cost includes all parts.
    ``observer`` is called with the loop at every sample, the first one at ignition; it must not
    change anything.

    Raises SceneError, MeshError, StepError or CheckpointError before the first step. A later
    failure is the status of the result.
    """
    if resume and checkpoint is None:
        raise ValueError(
            "resume: given True without checkpoint, expected the path of the file to go on from"
        )
    numerics = numerics or Numerics()
    began, cpu = clock.perf_counter(), clock.thread_time()
    system = build(scene, numerics, prepare(scene, numerics))
    stepping = choose(system, scene, numerics)
    if words := step_cost.long_run(system.mesh, scene, stepping.dt_s):
        tell(words)
    rails = None if numerics.step_everything else resting.build(scene, system, stepping)
    loop = Loop(scene, system, stepping, threads or _threads_for(system), rails)
    kept = (
        Checkpoint(checkpoint, checkpoint_every, loop, numerics) if checkpoint is not None else None
    )
    saved = kept.read() if kept is not None and resume else None
    compiling, set_up_cpu = clock.perf_counter(), clock.thread_time() - cpu
    loop.begin()
    compiled = clock.perf_counter()
    if kept is not None and saved is not None:
        kept.resume(loop, saved)
    loop.integrate(progress, kept, observer)
    elements = int(system.operator.cells.shape[0])
    cost = {
        "wall_s": (compiling - began) + loop.wall,
        "compile_s": compiled - compiling,
        "kernel_s": loop.wall,
        "cpu_s": set_up_cpu + loop.cpu + loop.other_cpu,
        "steps": loop.steps,
        **loop.resting(),
        **loop.stepping.as_dict(),
        "elements": elements,
        "ns_per_element_step": 1e9 * loop.wall / max(loop.steps * elements, 1),
    }
    return loop.trajectory(cost, numerics)


def _threads_for(system: System) -> int:
    """Threads that a mesh can keep busy; on a small mesh, more threads would wait for each
    other."""
    return max(1, min(processors(), len(system.operator.cells) // _ELEMENTS_PER_THREAD))


class Loop:
    """State of a run in progress, and its samples. Without ``rails`` all rails are always
    stepped."""

    def __init__(
        self,
        scene: Scene,
        system: System,
        stepping: Stepping,
        threads: int = 1,
        rails: Rails | None = None,
    ):
        self.scene, self.system, self.stepping = scene, system, stepping
        self.watch = None if rails is None else Watch(system, rails)
        self.rests = np.zeros(0 if rails is None else len(rails.blocks), dtype=np.bool_)
        self.stride = 1  # steps in one long step
        self.substeps = 1  # parts of a step
        self.jolts = jolts.begin(rails)
        self.team, self.pool = team_of(threads), ThreadPoolExecutor(threads)
        self.state, self.active = initial_state(system)
        self.exit, self.book = ending.build(system)
        self.reach = float(np.linalg.norm(system.rail.points, axis=1).max())  # m
        self.small = linear_range.small(system)  # m
        self.slow = spin.rate_never_checked(scene, system.mesh)  # rad/s, of the platform
        self.milestones = outcome.milestones(scene, system.model)
        self.last = scene.output.last(scene.time_limit)
        self.most = int(scene.time_limit / stepping.dt_s * (1.0 + _ROUNDING))  # steps
        self.expected = min(self.most * stepping.dt_s, scene.expected_end)  # s
        self.wall, self.cpu, self.other_cpu = 0.0, 0.0, 0.0  # s
        self.steps, self.checks = 0, 0  # done
        self.taken, self.block_steps = 0, 0  # long steps or substeps, and blocks that were stepped
        self.damping = 0.0  # largest step * friction damping / mass of a node
        self.friction = substeps.begin()
        self.scale = 0.0  # J, largest transverse energy
        self.message = ""  # why the run stopped
        # At every sample:
        self.rows: list[np.ndarray] = []  # see ``observe``
        self.work: list[np.ndarray] = []
        self.forces: list[np.ndarray] = []  # N, of the faces
        self.gauges: list[np.ndarray] = []  # Pa
        self.monitor = monitor.build(
            system, scene.rail.material, stepping.steps_per_sample, threads
        )
        self.peak = peak.no_peak()

    def constants(self) -> records.Constants:
        """Constant records of the kernels."""
        s, m = self.now, self.system.model
        return records.Constants(
            rail=s.rail,
            surface=s.surface,
            faces=s.faces,
            payload=m.payload,
            frame=s.frame,
            drive=s.drive,
            thrust=m.thrust,
            thrust_offset=m.thrust_offset,
            interface_stiffness=m.interface_stiffness,
            friction=m.friction,  # type: ignore[arg-type]  # sticking is refused by prepare
            body_force=m.body_force,
            exit=self.exit,
            milestones=self.milestones,
            dt=self.step,
            substeps=self.substeps,
        )

    @property
    def now(self) -> System:
        """The system in which the rails at rest belong to the rigid part."""
        return self.system if self.watch is None else self.watch.view(self.rests)

    @property
    def step(self) -> float:
        """Length (s) of a step: long step, substep or ordinary step."""
        return self.stride * self.stepping.dt_s / self.substeps

    def set_stride(self, stride: int, parts: int | None = None) -> None:
        """Continue with steps ``stride`` times as long, or divided into ``parts`` (None: as now);
        velocities are moved back by half a step."""
        before, self.stride = self.step, stride
        self.substeps = 1 if stride > 1 else parts or self.substeps
        if before != self.step:
            self.kick(0.5 * (before - self.step))
            self.active.wait[:] = 0

    def arguments(
        self,
    ) -> tuple[records.Constants, records.State, records.Active, np.ndarray, Team]:
        """Arguments of the time loop, in order."""
        return self.constants(), self.state, self.active, self.book, self.team_now

    @property
    def team_now(self) -> Team:
        """One thread if no rail is stepped, else all."""
        if self.watch is not None and self.rests.all():
            return self.watch.alone
        return self.team

    def begin(self) -> None:
        """First forces, velocities of t = -dt/2 that pass through the given ones at t = 0, and the
        first sample.

        Compiles the kernels.
        """
        self.evaluate()
        self.kick(-0.5 * self.stepping.dt_s)
        if self.watch is not None:
            self.watch.begin(self)
        self._perform(OPEN)
        self.advance_steps(0)
        self._check(keep=True)

    def integrate(self, progress, kept: Checkpoint | None = None, observer=None) -> None:
        """Advance from check to check until the run ends."""
        began, cpu = clock.perf_counter() - self.wall, clock.thread_time() - self.cpu
        if observer:
            observer(self)
        while self._goes_on():
            taken = len(self.rows)
            self._advance_to_check()
            if observer and len(self.rows) > taken:
                observer(self)
            if progress and self.checks % _REPORT_EVERY == 0:
                end = min(self.expected, self.book[WINDOW] + outcome.SETTLE_WINDOW)
                progress(min(1.0, self.steps * self.stepping.dt_s / end))
            self.wall, self.cpu = clock.perf_counter() - began, clock.thread_time() - cpu
            if kept:
                kept.keep(self)

    def _goes_on(self) -> bool:
        """Whether a step remains, be it only for the last sample."""
        if self.message or self.steps >= self.most:
            return False
        interval = self.scene.output.interval
        return self.book[DONE] == np.inf or not is_left_out(
            self.book, len(self.rows) * interval, interval
        )

    def advance_one_sample(self) -> None:
        """Advance to the next sample and take it; stop before if something goes wrong."""
        taken = len(self.rows)
        while len(self.rows) == taken and not self.message:
            self._advance_to_check()

    def _advance_to_check(self) -> None:
        """Advance to the next sample, or part of the way if it is far, and check the balances."""
        per_sample, left = self.stepping.steps_per_sample, self.most - self.steps
        there = per_sample - self.steps % per_sample
        count = min(there, STEPS_PER_CHECK, left if left > 0 else there)
        count = min(count, substeps.adapt(self))
        if self.watch is not None:
            count = min(count, self.watch.adapt(self))
        if count < self.stride:
            self.set_stride(1)
        self.advance_steps(count)
        self.checks += 1
        self._check(keep=self.steps % per_sample == 0)

    def advance_steps(self, count: int) -> None:
        """Take ``count`` steps with all threads of the team; fewer if a pad comes near a rail at
        rest or friction needs shorter steps."""
        count //= self.stride

        def part(thread):
            began = clock.thread_time()
            return self._perform(
                ADVANCE, thread, count * self.substeps
            ), clock.thread_time() - began

        others = [self.pool.submit(part, thread) for thread in range(1, self.team_now.size)]
        (taken, damping), _ = part(0)
        self.damping = max(self.damping, self.step * damping)
        self.other_cpu += sum(other.result()[1] for other in others)
        whole = taken // self.substeps
        substeps.note(self, damping, whole)
        self.steps += whole * self.stride
        self.taken += taken
        self.block_steps += whole * int(self.state.stepped.in_use[0])

    def _check(self, keep: bool) -> None:
        """Check whether the run may continue; store a sample if ``keep``."""
        state, now = self.state, self.now
        before = observe.moving(now, state)
        self.kick(self.step)
        row = observe.sample(now, self.team, state, before, observe.moving(now, state))
        observe.restore(now, state, before)
        self.message = fault(self, row)
        if keep and not self.message:
            self.message = self._out_of_range(row)
        if keep and np.isfinite(row).all():
            self.rows.append(row)
            self.work.append(state.work.copy())
            self.forces.append(state.face_force @ rotation.single(state.platform.quaternion).T)
            self._monitor_stress()

    @cached_property
    def lowest_frequency(self) -> float:
        """Lowest frequency (rad/s) of the rails held at their mounts."""
        return spin.lowest_frequency(self.scene, self.system.mesh)

    def _out_of_range(self, row: np.ndarray) -> str:
        """Reason why the rails are no longer linear at the sample ``row``, or ""."""
        words = ""
        if len(self.rows) % -(-linear_range.EVERY // self.stepping.steps_per_sample) == 0:
            words = linear_range.fault(self.system, self.state.displacement, self.small)
        rate = row[observe.PLATFORM_RATE : observe.PLATFORM_RATE + 3]
        size = float(np.linalg.norm(rate))
        if not words and self.system.frame is not None and size > self.slow:
            found = spin.too_fast(size, self.lowest_frequency)
            words = "; expected ".join(found) if found else ""
        return f"{words}, at {self.steps * self.stepping.dt_s:.6g} s" if words else ""

    def _monitor_stress(self) -> None:
        """Evaluate stresses at the last sample."""
        if self.monitor.patch is not None:
            self.gauges.append(monitor.gauge(self.monitor, self.deformed()))
        # Rails at rest have the stress of the first sample.
        at_rest = len(self.rows) > 1 and self.rests.size and self.rests.all()
        if (len(self.rows) - 1) % self.monitor.every == 0 and not at_rest:
            monitor.scan(
                self.monitor, self.deformed(), self.steps * self.stepping.dt_s, self.peak, self.pool
            )

    def deformed(self) -> np.ndarray:
        """Displacement (n,3) m of the nodal arrays from the rail as mounted, by load and by
        temperature."""
        warm = self.system.warm
        return self.state.displacement if warm is None else self.state.displacement + warm

    def resting(self) -> dict[str, float]:
        """Savings and neglected vibration of rails at rest, and the cost of friction."""
        whole = max(self.steps, 1) * self.state.stepped.block.size
        return {
            "steps_taken": self.taken,
            **substeps.cost(self),
            "stepped_share": self.block_steps / whole,
            "left_out_m": float(self.jolts.most[0]),
        }

    def evaluate(self) -> None:
        """Forces at the present places of rails at rest in their frame."""
        self._perform(EVALUATE)

    def kick(self, span: float) -> None:
        """Advance only the velocities of nodes and bodies, over ``span`` (s), by the present
        forces."""
        self._perform(KICK, span=span)

    def _perform(self, kind: int, thread: int = 0, steps: int = 0, span: float = 0.0) -> float:
        first, most = self.steps * self.substeps, substeps.most_damping(self)
        task = Task(
            kind=kind,
            first_step=first,
            steps=steps,
            span=span,
            stride=self.stride,
            most_damping=most,
        )
        return perform(*self.arguments(), thread, task)

    def trajectory(self, cost: dict, numerics: Numerics) -> Trajectory:
        """The result of the samples so far."""
        return result.trajectory(self, cost, numerics)
