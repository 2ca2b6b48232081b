"""What is recorded of a run of the reference: its samples, why it stopped, and its costs."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tipoff.highfi.dynamics import monitor, pushers
from tipoff.highfi.dynamics.stepper import Stepper, Taken
from tipoff.highfi.state.records import COUNTED, TOTAL
from tipoff.highfi.stress.peak import Peak, no_peak
from tipoff.kernels import rotation


def _work(stepper: Stepper) -> np.ndarray:
    """Work (2,) J since ignition. That of pushers comes from their potential; its difference from
    the integrated one counts as axial, because it is an error of the axial motion."""
    found, pushing = stepper.state.work.copy(), stepper.state.pushing
    if pushing.segment.size:
        work = pushers.work(stepper.setup.system.pushers, pushing)
        found["thrust"] += work - found["thrust"][TOTAL]
    return found


@dataclass
class Recorded:
    """Records of a run. No step depends on them; a checkpoint has them."""

    # At every sample:
    rows: list[np.ndarray] = field(default_factory=list)  # see ``observe``
    work: list[np.ndarray] = field(default_factory=list)  # J
    forces: list[np.ndarray] = field(default_factory=list)  # N, of the faces
    gauges: list[np.ndarray] = field(default_factory=list)  # Pa
    peak: Peak = field(default_factory=no_peak)
    # At every check:
    scale: float = 0.0  # J, largest transverse energy
    message: str = ""  # why the run stopped
    # At every call of the kernel:
    damping: float = 0.0  # largest step * friction damping / mass of a node
    parts: int = 0  # long steps or substeps
    block_steps: int = 0  # blocks that were stepped
    node_steps: int = 0  # nodes that were stepped, summed over long steps and substeps
    most_substeps: int = 1  # of a step
    divided_steps: int = 0
    wall: float = 0.0  # s
    cpu: float = 0.0  # s, of the first thread
    other_cpu: float = 0.0  # s, of the others
    settling_steps: int = 0  # before ignition

    def add_sample(self, stepper: Stepper, row: np.ndarray) -> None:
        """Store the sample ``row`` (``observe``), with forces and stresses."""
        state = stepper.state
        self.rows.append(row)
        self.work.append(_work(stepper))
        self.forces.append(state.face_force @ rotation.single(state.platform.quaternion).T)
        setup, rests = stepper.setup, stepper.rests
        if setup.monitor.patch is not None:
            self.gauges.append(monitor.gauge(setup.monitor, stepper.deformed()))
        # Rails at rest have the stress of the first sample.
        at_rest = len(self.rows) > 1 and rests.size and rests.all()
        if (len(self.rows) - 1) % setup.monitor.every == 0 and not at_rest:
            monitor.scan(setup.monitor, stepper.deformed(), stepper.time, self.peak, setup.pool)

    def add_steps(self, stepper: Stepper, taken: Taken) -> None:
        """Add the cost of the steps that were ``taken`` just now."""
        self.damping = max(self.damping, stepper.step * taken.damping)
        self.parts += taken.parts
        stepped, first = stepper.state.stepped, stepper.setup.system.rail.blocks
        blocks = stepped.block[: stepped.in_use[0]]
        self.block_steps += taken.whole * blocks.size
        self.node_steps += taken.parts * int((first[blocks + 1] - first[blocks]).sum())
        self.most_substeps = max(self.most_substeps, stepper.substeps)
        self.divided_steps += taken.whole if stepper.substeps > 1 else 0
        self.other_cpu += taken.other_cpu

    def cost(self, stepper: Stepper) -> dict[str, Any]:
        """Steps, savings and neglected vibration of rails at rest, and the cost of friction.
        ``element_steps``: elements that were stepped, summed over long steps and substeps;
        ``evaluations``: how often the law of each effect was evaluated, never for an absent one."""
        system = stepper.setup.system
        whole = max(stepper.steps, 1) * stepper.state.stepped.block.size
        elements, nodes = len(system.operator.cells), int(system.rail.blocks[-1])
        settled = {"settling_steps": self.settling_steps} if self.settling_steps else {}
        return settled | {
            "steps": stepper.steps,
            "steps_taken": self.parts,
            "friction_substeps": self.most_substeps,
            "friction_divided_steps": self.divided_steps,
            "stepped_share": self.block_steps / whole,
            "element_steps": round(self.node_steps * elements / nodes),
            "evaluations": dict(zip(COUNTED, stepper.state.evaluated.tolist())),
            "left_out_m": float(stepper.jolts.most[0]),
        }
