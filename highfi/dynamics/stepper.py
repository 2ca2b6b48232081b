"""What evolves in a run of the reference, and the steps that change it."""

import time as clock
from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics import ending, jolts, observe
from tipoff.highfi.dynamics.setup import Setup
from tipoff.highfi.dynamics.step import ADVANCE, EVALUATE, KICK, OBSERVE, OPEN, Task, perform
from tipoff.highfi.dynamics.system import System, initial_state
from tipoff.highfi.state import records
from tipoff.highfi.state.threads import Team
from tipoff.mechanics.absent import NO_FORCE, NO_LATCH, SMOOTH, offset
from tipoff.mechanics.laws.thrust import complete


class Taken(NamedTuple):
    """What ``Stepper.advance`` did."""

    whole: int  # long or ordinary steps
    parts: int  # long steps or substeps
    damping: float  # 1/s, largest friction damping / mass of a node before any of them
    other_cpu: float  # s, of all threads but the first one


class Stepper:
    """State of a run. All attributes but ``setup`` evolve, and a checkpoint has them. Nothing but
    the methods, ``regroup`` and ``waking`` changes them."""

    def __init__(self, setup: Setup):
        self.setup = setup
        self.state, self.active = initial_state(setup.system)
        self.book = ending.new_book()  # of exit, settled window and jam
        self.steps = 0  # done
        self.stride = 1  # steps in one long step
        self.substeps = 1  # parts of a step
        # 1/s, largest friction damping / mass of a node since the last decision on substeps
        self.fastest = 0.0
        # (rails,) whether a rail rests
        self.rests = np.zeros(len(setup.rails.blocks) if setup.rails else 0, dtype=np.bool_)
        self.jolts = jolts.begin(setup.rails)  # vibration that rails at rest leave out

    @property
    def time(self) -> float:
        """Time (s) since ignition."""
        return self.steps * self.setup.stepping.dt_s

    @property
    def step(self) -> float:
        """Length (s) of a step: long step, substep or ordinary step."""
        return self.stride * self.setup.stepping.dt_s / self.substeps

    @property
    def damping(self) -> float:
        """Largest friction damping / mass (1/s) of a node now."""
        return float(self.state.loads["damping_rate"].max(initial=0.0))

    @property
    def most_damping(self) -> float:
        """Limit of friction damping / mass (1/s) of a node for a step as now."""
        return max(0.0, 2.0 * (1.0 - self.setup.stepping.used(self.substeps)) / self.step)

    @property
    def now(self) -> System:
        """The system in which the rails at rest belong to the rigid part."""
        return self.setup.view(self.rests)

    @property
    def team(self) -> Team:
        """One thread if no rail is stepped, else all."""
        return self.setup.alone if self.rests.size and self.rests.all() else self.setup.team

    def deformed(self) -> np.ndarray:
        """Displacement (n,3) m of the nodal arrays from the rail as mounted, by load and by
        temperature."""
        warm = self.setup.system.warm
        return self.state.displacement if warm is None else self.state.displacement + warm

    def moving(self) -> tuple[observe.Moving, observe.Moving]:
        """Velocities of the bodies half a step before and after the present places; sums over the
        nodes are then in ``State.sums``."""
        before = observe.moving(self.state)
        self._perform(OBSERVE, span=self.step)
        after = observe.moving(self.state)
        observe.restore(self.state, before)
        return before, after

    def constants(self) -> records.Constants:
        """Constant records of the kernels."""
        s, m = self.now, self.setup.system.model
        return records.Constants(
            rail=s.rail,
            surface=s.surface,
            faces=s.faces,
            payload=m.payload,
            frame=s.frame or records.FIXED,
            drive=s.drive,
            thrust=complete(m.thrust),
            pushers=s.pushers,
            thrust_offset=offset(m.thrust_offset),
            hold_down=s.hold_down or NO_LATCH,
            interface_stiffness=m.interface_stiffness or 0.0,
            friction=m.friction or SMOOTH,  # type: ignore[arg-type]  # prepare refuses sticking
            body_force=m.body_force or NO_FORCE,
            exit=self.setup.exit,
            milestones=self.setup.milestones,
            dt=self.step,
            substeps=self.substeps,
        )

    def arguments(
        self,
    ) -> tuple[records.Constants, records.State, records.Active, np.ndarray, Team]:
        """Arguments of the time loop, in order."""
        return self.constants(), self.state, self.active, self.book, self.team

    def evaluate(self) -> None:
        """Forces at the present places of rails at rest in their frame."""
        self._perform(EVALUATE)

    def kick(self, span: float) -> None:
        """Advance only the velocities of nodes and bodies, over ``span`` (s), by the present
        forces."""
        self._perform(KICK, span=span)

    def sample(self) -> np.ndarray:
        """Sample vector (SAMPLE_SIZE,) of the present places (``observe``)."""
        before, after = self.moving()
        return observe.sample(self.now, self.state, before, after)

    def open_book(self) -> None:
        """Begin the book at ignition, with the velocities of half a step before."""
        self._perform(OPEN)

    def advance(self, count: int) -> Taken:
        """Take ``count`` steps with all threads of the team; fewer if a pad comes near a rail at
        rest or friction needs shorter steps."""
        count = count // self.stride * self.substeps

        def part(thread):
            began = clock.thread_time()
            return self._perform(ADVANCE, thread, count), clock.thread_time() - began

        others = [self.setup.pool.submit(part, thread) for thread in range(1, self.team.size)]
        (parts, damping), _ = part(0)
        other_cpu = sum(other.result()[1] for other in others)
        whole = parts // self.substeps
        self.steps += whole * self.stride
        self.fastest = max(self.fastest, damping)
        return Taken(whole=whole, parts=parts, damping=damping, other_cpu=other_cpu)

    def set_stride(self, stride: int, parts: int | None = None) -> None:
        """Continue with steps ``stride`` times as long, or divided into ``parts`` (None: as now);
        velocities are moved back by half a step."""
        before, self.stride = self.step, stride
        self.substeps = 1 if stride > 1 else parts or self.substeps
        if before != self.step:
            self.kick(0.5 * (before - self.step))
            self.active.wait[:] = 0

    def divide(self, count: int) -> None:
        """Continue with ``count`` substeps. The energy that the scheme conserves depends on its
        step, so the ledger gets the difference."""
        if (self.stride, self.substeps) != (1, count):
            before = self._kinetic_energy()
            self.set_stride(1, count)
            self.state.work["released"] += before - self._kinetic_energy()
        self.fastest = self.damping

    def _kinetic_energy(self) -> np.ndarray:
        """Kinetic energy (J) of the scheme: total and axial part (``TOTAL`` and ``AXIAL``)."""
        return self.sample()[[observe.KINETIC, observe.AXIAL_KINETIC]]

    def _perform(self, kind: int, thread: int = 0, steps: int = 0, span: float = 0.0):
        task = Task(
            kind=kind,
            first_step=self.steps * self.substeps,
            steps=steps,
            span=span,
            stride=self.stride,
            most_damping=self.most_damping,
        )
        return perform(*self.arguments(), thread, task)
