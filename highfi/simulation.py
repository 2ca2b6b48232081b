"""One run of the finite-element reference: set-up, the sampled time loop, and its Trajectory."""

import threading
import time as clock
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.files import tell
from tipoff.highfi import result
from tipoff.highfi.dynamics import resting, substeps, waking
from tipoff.highfi.dynamics.checkpoint import Checkpoint
from tipoff.highfi.dynamics.settle import settle
from tipoff.highfi.dynamics.setup import Setup, set_up
from tipoff.highfi.dynamics.step_size import STEPS_PER_CHECK, choose
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.dynamics.system import System, build
from tipoff.highfi.faults import fault, out_of_range
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail import spin, step_cost
from tipoff.highfi.rail.fit import check_fit
from tipoff.highfi.rail.geometry import geometry
from tipoff.highfi.rail.memory_check import check_before, check_mesh
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.highfi.recorded import Recorded
from tipoff.highfi.state.threads import processors
from tipoff.mechanics.books import DONE, WINDOW, is_left_out
from tipoff.mechanics.run_limits import SETTLE_WINDOW
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import settled
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.scene import Scene

_ELEMENTS_PER_THREAD = 4000
_REPORT_EVERY = 20  # checks from one report of progress to the next
MESHES: dict[tuple, RailMesh] = {}  # made by this process, by geometry and element size (m)
_MESH_LOCK = threading.Lock()


def prepare(scene: Scene, numerics: Numerics | None = None) -> RailMesh:
    """Mesh of a scene, made once per process. gmsh, which meshes solids, must run in the main
    thread: call this there before runs in other threads.

    Raises SceneError (also for lack of memory), MeshError, or GmshUnavailable if a solid cannot be
    meshed here.
    """
    require_two_step(scene)
    settled.require(scene)
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
    loop = Loop(set_up(scene, system, stepping, threads or _threads_for(system), rails))
    kept = (
        Checkpoint(checkpoint, checkpoint_every, loop, numerics) if checkpoint is not None else None
    )
    saved = kept.read() if kept is not None and resume else None
    compiling, set_up_cpu = clock.perf_counter(), clock.thread_time() - cpu
    loop.begin(settles=saved is None)
    compiled = clock.perf_counter()
    if kept is not None and saved is not None:
        kept.resume(loop, saved)
    loop.integrate(progress, kept, observer)
    elements, recorded = int(system.operator.cells.shape[0]), loop.recorded
    counted = recorded.cost(loop.stepper)
    cost = {
        "wall_s": (compiling - began) + recorded.wall,
        "compile_s": compiled - compiling,
        "kernel_s": recorded.wall,
        "cpu_s": set_up_cpu + recorded.cpu + recorded.other_cpu,
        **counted,
        **stepping.as_dict(),
        "elements": elements,
        # per element of the model and step, those that rest included
        "ns_per_element_step": 1e9 * recorded.wall / max(loop.stepper.steps * elements, 1),
        "ns_per_element_stepped": _per(1e9 * recorded.wall, counted["element_steps"]),
    }
    return loop.trajectory(cost, numerics)


def _per(amount: float, count: float) -> float | None:
    return amount / count if count else None


def _threads_for(system: System) -> int:
    """Threads that a mesh can keep busy; on a small mesh, more threads would wait for each
    other."""
    return max(1, min(processors(), len(system.operator.cells) // _ELEMENTS_PER_THREAD))


class Loop:
    """A run in progress: ``setup`` is constant, ``stepper`` evolves, ``recorded`` has the samples
    and costs."""

    def __init__(self, setup: Setup):
        self.stepper, self.recorded = Stepper(setup), Recorded()

    @property
    def setup(self) -> Setup:
        """Constants of the run."""
        return self.stepper.setup

    def begin(self, settles: bool = True) -> None:
        """First forces, velocities of t = -dt/2 that pass through the given ones at t = 0, and the
        first sample.

        Compiles the kernels. A payload that is settled comes to rest before, if it ``settles``.
        """
        stepper, rails = self.stepper, self.setup.rails
        if settles and self.setup.system.model.initial.settled:
            self.recorded.settling_steps = settle(stepper)
        stepper.evaluate()
        stepper.kick(-0.5 * self.setup.stepping.dt_s)
        if rails is not None:
            waking.begin(rails, stepper)
        stepper.open_book()
        self.advance_steps(0)
        self._check(keep=True)

    def integrate(self, progress, kept: Checkpoint | None = None, observer=None) -> None:
        """Advance from check to check until the run ends."""
        recorded, book = self.recorded, self.stepper.book
        began, cpu = clock.perf_counter() - recorded.wall, clock.thread_time() - recorded.cpu
        checks = 0
        if observer:
            observer(self)
        while self._goes_on():
            taken = len(recorded.rows)
            self._advance_to_check()
            checks += 1
            if observer and len(recorded.rows) > taken:
                observer(self)
            if progress and checks % _REPORT_EVERY == 0:
                end = min(self.setup.expected, book[WINDOW] + SETTLE_WINDOW)
                progress(min(1.0, self.stepper.time / end))
            recorded.wall, recorded.cpu = clock.perf_counter() - began, clock.thread_time() - cpu
            if kept:
                kept.keep(self)

    def _goes_on(self) -> bool:
        """Whether a step remains, be it only for the last sample."""
        stepper, recorded = self.stepper, self.recorded
        if recorded.message or stepper.steps >= self.setup.most:
            return False
        interval = self.setup.scene.output.interval
        return stepper.book[DONE] == np.inf or not is_left_out(
            stepper.book, len(recorded.rows) * interval, interval
        )

    def advance_one_sample(self) -> None:
        """Advance to the next sample and take it; stop before if something goes wrong."""
        taken = len(self.recorded.rows)
        while len(self.recorded.rows) == taken and not self.recorded.message:
            self._advance_to_check()

    def _advance_to_check(self) -> None:
        """Advance to the next sample, or part of the way if it is far, and check the balances."""
        setup, stepper = self.setup, self.stepper
        per_sample, left = setup.stepping.steps_per_sample, setup.most - stepper.steps
        there = per_sample - stepper.steps % per_sample
        count = min(there, STEPS_PER_CHECK, left if left > 0 else there)
        count = min(count, substeps.adapt(stepper))
        if setup.rails is not None:
            count = min(count, waking.adapt(setup.rails, stepper))
        if count < stepper.stride:
            stepper.set_stride(1)
        self.advance_steps(count)
        self._check(keep=stepper.steps % per_sample == 0)

    def advance_steps(self, count: int) -> None:
        """Take ``count`` steps; see ``Stepper.advance``."""
        self.recorded.add_steps(self.stepper, self.stepper.advance(count))

    def _check(self, keep: bool) -> None:
        """Check whether the run may continue; store a sample if ``keep``."""
        stepper, recorded = self.stepper, self.recorded
        row = stepper.sample()
        recorded.message, recorded.scale = fault(stepper, recorded, row)
        if keep and not recorded.message:
            recorded.message = out_of_range(stepper, len(recorded.rows), row)
        if keep and np.isfinite(row).all():
            recorded.add_sample(stepper, row)

    def trajectory(self, cost: dict, numerics: Numerics) -> Trajectory:
        """The result of the samples so far."""
        return result.trajectory(self.stepper, self.recorded, cost, numerics)
