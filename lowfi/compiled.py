"""Effects in the compiled time loop of a scene, read from its machine code."""

from tipoff.kernels.compiled import effects
from tipoff.kernels.jit import machine_code
from tipoff.lowfi import hold_down, pushers
from tipoff.lowfi.contact import springs, stick_slip, thermal_offset
from tipoff.lowfi.contact.compliant import modes, solution
from tipoff.lowfi.dynamics import equations
from tipoff.lowfi.dynamics.integrate import integrate
from tipoff.lowfi.numerics import Numerics
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.ledger import BODY_FORCE
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.effects.friction import coefficient_over_speed
from tipoff.scenes.scene import Scene

# For each effect, a kernel that only it calls. Mass offset, initial state and damping of rails have
# no kernel: they only change numbers. Compliant contact has the temperature in its own code.
LAWS = {
    "contact": springs.load,
    "compliance": solution.solve,
    "modes": modes.vibrate,
    "friction": coefficient_over_speed,
    "sticking": stick_slip.traction,
    BODY_FORCE: equations._add_body_force,
    "platform": springs._relative_turn,
    "thrust_offset": equations._offset_line,
    "pushers": pushers.push_of,
    "hold_down": hold_down.hold,
    "thermal": thermal_offset.offset_and_slope,
}


def compiled_effects(
    scene: Scene, numerics: Numerics | None = None, compliance: RailCompliance | None = None
) -> dict[str, bool]:
    """For each effect of ``LAWS``, whether the kernel compiled for ``scene``, with compliant
    contact or springs, contains it."""
    return effects(integrate, _arguments(scene, numerics, compliance), LAWS)


def compiled_code(
    scene: Scene, numerics: Numerics | None = None, compliance: RailCompliance | None = None
) -> bytes:
    """Object code of the time loop."""
    return machine_code(integrate, _arguments(scene, numerics, compliance))


def _arguments(scene: Scene, numerics: Numerics | None, compliance: RailCompliance | None) -> tuple:
    """Arguments of ``integrate``."""
    return SingleRun(scene, numerics or Numerics(), compliance).arguments(0)
