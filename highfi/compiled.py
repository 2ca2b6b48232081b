"""Effects in the compiled time loop of a scene, read from its machine code."""

from tipoff.highfi.contact import cells
from tipoff.highfi.dynamics import damping, hold_down, loads, mounts, pushers
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step import ADVANCE, Task, perform
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import prepare
from tipoff.highfi.state import nodes
from tipoff.kernels.compiled import effects
from tipoff.mechanics.laws.friction import coefficient_over_speed
from tipoff.mechanics.ledger import BODY_FORCE
from tipoff.scenes.scene import Scene

# For each effect, a kernel that only this effect calls. Mass offset, initial state and temperature
# have no kernel: they only change numbers.
LAWS = {
    "contact": cells.press,
    "friction": coefficient_over_speed,
    BODY_FORCE: loads._add_weight,
    "platform": nodes._move_in_frame,
    "rail.damping": damping._damp_component,
    "rail.mount_stiffness": mounts._force,
    "thrust_offset": loads._offset_line,
    "pushers": pushers._load,
    "hold_down": hold_down._arm,
}


def compiled_effects(scene: Scene, numerics: Numerics | None = None) -> dict[str, bool]:
    """For each effect of ``LAWS``, whether the kernel compiled for ``scene`` contains it."""
    numerics = numerics or Numerics()
    system = build(scene, numerics, prepare(scene, numerics))
    stepper = Stepper(set_up(scene, system, choose(system, scene, numerics)))
    return effects(perform, (*stepper.arguments(), 0, Task(ADVANCE, 0, 0, 0.0)), LAWS)
