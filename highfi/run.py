"""One run of the reference: set-up, the sampled time loop, and the Trajectory it leaves."""

import threading
import time as clock
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from tipoff.highfi.contact.pads import FASTEST_APPROACH
from tipoff.highfi.contact.surface import magnification
from tipoff.highfi.dynamics import ending, observe, samples
from tipoff.highfi.dynamics.checkpoint import Checkpoint, restore
from tipoff.highfi.dynamics.loads import pull_on_nodes, thrust_load
from tipoff.highfi.dynamics.step import advance, evaluate, kick_bodies
from tipoff.highfi.dynamics.step_size import Stepping, choose
from tipoff.highfi.dynamics.system import System, build, initial_state
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail.fit import check_fit
from tipoff.highfi.rail.memory_check import check_before, check_mesh
from tipoff.highfi.rail.scene_mesh import geometry, make_mesh
from tipoff.highfi.state import records
from tipoff.highfi.state.nodes import kick_nodes
from tipoff.highfi.state.pose import seen_from_frame
from tipoff.highfi.state.threads import gather, processors
from tipoff.highfi.stress import monitor, peak
from tipoff.kernels import rotation
from tipoff.mechanics import comoving, ledger, models, outcome
from tipoff.mechanics.ending import DONE, WINDOW, is_left_out
from tipoff.mechanics.promises import FINITE_ELEMENTS, broken
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.scene import Scene

_STOP_RATIO = 0.1  # of the transverse scale: a run that loses so much energy is not a result
_ELEMENTS_PER_THREAD = 4000
# steps at most from one look at the balances to the next, at samples or between
_STEPS_PER_LOOK = 250
_REPORT_EVERY = 20  # looks from one report of progress to the next
_ROUNDING = 1e-9
_MESHES: dict[tuple, RailMesh] = {}
_MESH_LOCK = threading.Lock()


def prepare(scene: Scene, numerics: Numerics | None = None) -> RailMesh:
    """Mesh of a scene, made once per process. gmsh, which meshes solids, must run in the main
    thread: call this there before runs in other threads.

    Raises SceneError, also where memory does not suffice, MeshError, or GmshUnavailable where a
    solid cannot be meshed here.
    """
    require_two_step(scene)
    numerics = numerics or Numerics()
    key = (geometry(scene), numerics.element_size)
    with _MESH_LOCK:
        if key not in _MESHES:
            check_before(scene, numerics.element_size)
            mesh = make_mesh(scene, numerics.element_size)
            check_mesh(scene, numerics.element_size, mesh)
            _MESHES[key] = mesh
        mesh = _MESHES[key]
    check_fit(scene, mesh)
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
    """Solve ``scene`` with flexible rails until the settled window is complete, a jam, or the
    scene's duration.

    ``progress`` is called with the fraction of the duration done. ``threads`` share the run, unless
    said otherwise as many as there are processors and elements enough for; the result does not hang
    on their number. With the path of a ``checkpoint`` the run is kept there every
    ``checkpoint_every`` seconds (wall clock), and the file stays; with ``resume`` it goes on from
    that file if there is one, to the same bits, and its cost is that of all parts. ``observer`` is
    called with the loop at every sample, the first one at ignition; it may read all and must change
    nothing. Raises SceneError, MeshError, StepError or CheckpointError before any stepping; what
    goes wrong later is the status of the result.
    """
    if resume and checkpoint is None:
        raise ValueError(
            "resume: given True without checkpoint, expected the path of the file to go on from"
        )
    numerics = numerics or Numerics()
    began, cpu = clock.perf_counter(), clock.thread_time()
    system = build(scene, numerics, prepare(scene, numerics))
    loop = Loop(scene, system, choose(system, scene, numerics), threads or _worth_while(system))
    kept = (
        Checkpoint(checkpoint, checkpoint_every, loop, numerics) if checkpoint is not None else None
    )
    saved = kept.read() if kept is not None and resume else None
    compiling, set_up_cpu = clock.perf_counter(), clock.thread_time() - cpu
    loop.begin()
    compiled = clock.perf_counter()
    if saved is not None:
        restore(loop, saved)
    loop.march(progress, kept, observer)
    elements = int(system.operator.cells.shape[0])
    cost = {
        "wall_s": (compiling - began) + loop.wall,
        "compile_s": compiled - compiling,
        "kernel_s": loop.wall,
        "cpu_s": set_up_cpu + loop.cpu + loop.other_cpu,
        "steps": loop.steps,
        **loop.stepping.as_dict(),
        "elements": elements,
        "ns_per_element_step": 1e9 * loop.wall / max(loop.steps * elements, 1),
    }
    return loop.trajectory(cost, numerics)


def _worth_while(system: System) -> int:
    """Threads that a mesh can keep busy: with less to do they would mostly wait for each other."""
    return max(1, min(processors(), len(system.operator.cells) // _ELEMENTS_PER_THREAD))


class Loop:
    """State of a run in progress and its samples."""

    def __init__(self, scene: Scene, system: System, stepping: Stepping, threads: int = 1):
        self.scene, self.system, self.stepping = scene, system, stepping
        self.team, self.pool = gather(threads), ThreadPoolExecutor(threads)
        self.state, self.active = initial_state(system)
        self.walls = np.unique(system.surface.facets)
        self.marks = outcome.milestones(scene, system.model)
        self.last, self.most = (
            scene.output.last(scene.duration),
            int(scene.duration / stepping.dt_s * (1.0 + _ROUNDING)),
        )
        self.exit, self.ending = ending.build(system)
        self.wall, self.cpu, self.looks = 0.0, 0.0, 0
        self.steps, self.damping, self.scale, self.other_cpu, self.message = 0, 0.0, 0.0, 0.0, ""
        self.rows: list[np.ndarray] = []
        self.work: list[np.ndarray] = []
        self.forces: list[np.ndarray] = []
        self.gauges: list[np.ndarray] = []
        self.watch, self.worst = (
            monitor.build(system, scene.rail.material, stepping.steps_per_sample, threads),
            peak.nothing(),
        )

    def arguments(self) -> tuple:
        """Records the kernels take, in their order."""
        s, m = self.system, self.system.model
        return (
            s.rail,
            s.surface,
            s.faces,
            m.payload,
            s.frame,
            s.drive,
            m.thrust.pulses,
            m.thrust.curve,
            m.thrust_offset,
            m.penalty,
            m.friction,
            m.body_force,
            self.state,
            self.active,
        )

    def followed(self) -> tuple:
        """Records by which the kernels follow the payload off the rail, in their order."""
        return self.exit, self.marks, self.ending

    def begin(self) -> None:
        """First forces, velocities set back to -1/2 so that they pass through the given ones at t =
        0, and the first sample.

        Compiles the kernels.
        """
        s, m = self.system, self.system.model
        evaluate(
            s.rail,
            s.surface,
            s.faces,
            m.payload,
            s.frame,
            m.penalty,
            m.friction,
            self.state,
            self.active,
            self.team,
            self.stepping.dt_s,
        )
        self._kick(-0.5 * self.stepping.dt_s)
        ending.begin(self.exit, m.payload, s.frame, self.state, self.marks, self.ending.book)
        self.advance_steps(0)
        self._look(keep=True)

    def march(self, progress, kept: Checkpoint | None = None, observer=None) -> None:
        """Advance look by look until something ends the run."""
        began, cpu = clock.perf_counter() - self.wall, clock.thread_time() - self.cpu
        if observer:
            observer(self)
        while self._goes_on():
            taken = len(self.rows)
            self._advance_one_look()
            if observer and len(self.rows) > taken:
                observer(self)
            if progress and self.looks % _REPORT_EVERY == 0:
                end = min(
                    self.most * self.stepping.dt_s, self.ending.book[WINDOW] + outcome.SETTLE_WINDOW
                )
                progress(min(1.0, self.steps * self.stepping.dt_s / end))
            self.wall, self.cpu = clock.perf_counter() - began, clock.thread_time() - cpu
            if kept:
                kept.keep(self)

    def _goes_on(self) -> bool:
        """Whether a step is left to take, be it only for the last sample."""
        if self.message or self.steps >= self.most:
            return False
        interval = self.scene.output.interval
        return self.ending.book[DONE] == np.inf or not is_left_out(
            self.ending.book, len(self.rows) * interval, interval
        )

    def advance_one_sample(self) -> None:
        """Step to the next sample and take it; less where something goes wrong before."""
        taken = len(self.rows)
        while len(self.rows) == taken and not self.message:
            self._advance_one_look()

    def _advance_one_look(self) -> None:
        """Step to the next sample, or not so far where that is long, and look at the balances
        there."""
        there, left = (
            self.stepping.steps_per_sample - self.steps % self.stepping.steps_per_sample,
            self.most - self.steps,
        )
        count = min(there, _STEPS_PER_LOOK, left if left > 0 else there)
        self.advance_steps(count)
        self.looks += 1
        self._look(keep=count == there)

    def advance_steps(self, count: int) -> None:
        """``count`` steps, by all threads of the team."""

        def part(thread):
            began = clock.thread_time()
            damping = advance(
                *self.arguments(),
                *self.followed(),
                self.team,
                thread,
                self.steps,
                count,
                self.stepping.dt_s,
            )
            return damping, clock.thread_time() - began

        others = [self.pool.submit(part, thread) for thread in range(1, self.team.size)]
        self.damping = max(self.damping, part(0)[0])
        self.other_cpu += sum(other.result()[1] for other in others)
        self.steps += count

    def _look(self, keep: bool) -> None:
        """See whether the run may go on, and ``keep`` what is seen as a sample."""
        state, step = self.state, self.stepping.dt_s
        before = observe.moving(state)
        self._kick(step)
        row = observe.sample(self.system, self.team, state, before, observe.moving(state))
        observe.restore(state, before)
        self.message = self._fault(row)
        if keep and np.isfinite(row).all():
            self.rows.append(row)
            self.work.append(state.work.copy())
            self.forces.append(
                state.face_force @ rotation.matrices(state.platform.quaternion[None])[0].T
            )
            self._watch()

    def _watch(self) -> None:
        """Stresses at the sample just taken."""
        if self.watch.patch is not None:
            self.gauges.append(monitor.gauge(self.watch, self.deformed()))
        if (len(self.rows) - 1) % self.watch.every == 0:
            monitor.look(
                self.watch, self.deformed(), self.steps * self.stepping.dt_s, self.worst, self.pool
            )

    def deformed(self) -> np.ndarray:
        """Displacement (n,3) m of the nodal arrays from the rail as it was mounted: by load, and by
        temperature where it is warm."""
        warm = self.system.warm
        return self.state.displacement if warm is None else self.state.displacement + warm

    def _kick(self, step: float) -> None:
        """Advance the velocities alone, over ``step`` (s), by the present forces."""
        s, m, state = self.system, self.system.model, self.state
        pose = seen_from_frame(state, m.payload, s.frame)
        thrust = thrust_load(
            state,
            s.drive,
            m.thrust.pulses,
            m.thrust.curve,
            m.thrust_offset,
            self.steps * self.stepping.dt_s,
        )
        kick_bodies(m.payload, s.frame, s.drive, m.body_force, state, pose, thrust, step)
        kick_nodes(
            s.rail.inverse_mass,
            state.velocity,
            state.resistance,
            pull_on_nodes(m.body_force, pose),
            step,
        )

    def _fault(self, row: np.ndarray) -> str:
        """Why the run must stop here, or nothing."""
        now = f"at {self.steps * self.stepping.dt_s:.6g} s"
        if not (np.isfinite(row).all() and np.isfinite(self.state.work).all()):
            return f"a value became infinite {now}"
        _, transverse = samples.ledgers(
            np.array([*self.rows[:1], row]), np.array([*self.work[:1], self.state.work])
        )
        self.scale = max(self.scale, transverse[-1, 2:5].sum())
        if self.active.struck.any():
            return self._strike()
        loss, work = abs(ledger.residual(transverse)[-1]), abs(self.state.work[records.THRUST])
        # Rounding of the large axial work is no fault while nothing has moved sideways yet.
        if loss > _STOP_RATIO * self.scale + 1e-11 * work:
            return (
                f"transverse energy is off by {loss:.3g} J, its scale being {self.scale:.3g} J, "
                f"{now}"
            )
        if (
            self.system.model.penalty is not None
            and (speed := self._approach_speed()) > FASTEST_APPROACH
        ):
            return (
                f"payload and rails approach at up to {speed:.3g} m/s, contact search allows "
                f"{FASTEST_APPROACH:g} m/s, {now}"
            )
        if self.stepping.used() + 0.5 * self.damping > 1.0:
            return (
                f"friction damps nodes faster than the step of {self.stepping.dt_s:.4g} s can "
                f"follow, {now}; lower safety"
            )
        return ""

    def _strike(self) -> str:
        """What met an edge of a wall first, where and when."""
        face = int(
            max(
                np.flatnonzero(self.active.struck[:, 0]),
                key=lambda struck: self.active.struck[struck, 2],
            )
        )
        depth, x, since = self.active.struck[face]
        time = (self.steps - since) * self.stepping.dt_s
        return outcome.strike(
            self.system.model.faces,
            face,
            "strikes an edge or the back",
            depth,
            x + self.system.origin[0],
            time,
        )

    def _approach_speed(self) -> float:
        """Bound (m/s) of the speed across the rail at which any pad and any point of a wall can
        approach each other now."""
        state, payload = self.state, self.system.model.payload
        spin = np.linalg.norm(payload.inverse_inertia, 2) * np.linalg.norm(state.payload.spin)
        reach = np.linalg.norm(self.system.faces.centre, axis=1).max()
        turn = rotation.matrices(state.platform.quaternion[None])[0]
        across = (state.payload.velocity @ turn)[1:]
        nodes = np.linalg.norm(state.velocity[self.walls, 1:] - across, axis=1).max()
        return float(magnification(self.system.surface) * nodes + spin * reach)

    def _motion(self) -> outcome.Motion:
        return samples.motion(
            np.array(self.rows), self.scene.output.interval, self.system.body_offset
        )

    def _stress(self) -> dict:
        return monitor.record(
            self.watch, self.system, self.worst, self.scene.rail.material.yield_strength
        )

    def _broken(self, checks: dict[str, float]) -> str:
        """The promises that the run broke, and what helps, or nothing. It is not run again with
        smaller steps: that is for who pays for it to decide."""
        words = broken(checks, FINITE_ELEMENTS)
        return f"{words}; lower safety or element_size" if words else ""

    def trajectory(self, cost: dict, numerics: Numerics) -> Trajectory:
        """The result of the samples taken so far."""
        rows, moved = np.array(self.rows), self._motion()
        total, transverse = samples.ledgers(rows, np.array(self.work))
        status, result = ending.found(self.system, self.ending.book)
        forces = np.array(self.forces)
        linear, angular = samples.momentum_errors(
            rows, moved, self.system.model.payload.mass, forces, self.steps
        )
        friction = (
            np.diff(total[:, ledger.ENTRIES.index("friction")], prepend=0.0)
            / self.scene.output.interval
        )
        checks = {
            "energy_error": ledger.total_error(total, FINITE_ELEMENTS),
            "transverse_energy_error": ledger.transverse_error(transverse, total, FINITE_ELEMENTS),
            "linear_momentum_error": linear,
            "angular_momentum_error": angular,
            "quaternion_error": float(np.abs(np.linalg.norm(moved.quaternion, axis=1) - 1.0).max()),
            "friction_power_max": float(-friction.min()),
            "friction_step_ratio": float(self.damping),
        }
        broken = self._broken(checks)
        if self.message or broken:
            status, result = "diverged", outcome.Outcome()
        pressed = (
            outcome.pressed_at_ignition(self.system.faces, self.forces[0]) if self.forces else ""
        )
        message = "; ".join(filter(None, [self.message, broken, pressed]))
        seen_from = comoving.frame(self.system.model)
        return Trajectory(
            model=models.FINITE_ELEMENTS,
            status=status,
            message=message,
            **comoving.motion(seen_from, moved)._asdict(),
            pad_force=forces,
            energy=total,
            transverse_energy=transverse,
            outcome=comoving.outcome(seen_from, result),
            checks=checks,
            cost=cost,
            scene=self.scene.resolved(),
            numerics=numerics.as_dict(),
            stress=None if status == "diverged" else self._stress(),
            wall_stress=np.array(self.gauges).reshape(len(rows), -1, 6) if self.gauges else None,
        )
