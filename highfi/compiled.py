"""Which effects the compiled time loop of a scene really contains, read from its machine code."""

from highfi import damping, facet_contact, loads, nodes
from highfi.numerics import Numerics
from highfi.run import Loop, prepare
from highfi.step import advance
from highfi.stepping import choose
from highfi.system import build
from scenes.effects.friction import coefficient_over_speed
from scenes.jit import contains, machine_code
from scenes.scene import Scene

# A function that only this effect calls. Mass offset, initial state and temperature are numbers
# without code of their own.
LAWS = {
    "contact": facet_contact.press,
    "friction": coefficient_over_speed,
    "gravity": loads._add_weight,
    "platform": nodes._move_in_frame,
    "rail.damping": damping._damp_component,
    "thrust_offset": loads._offset_line,
}


def compiled_effects(scene: Scene, numerics: Numerics | None = None) -> dict[str, bool]:
    """For each effect with code of its own, whether the kernel compiled for ``scene`` contains
    it."""
    numerics = numerics or Numerics()
    system = build(scene, numerics, prepare(scene, numerics))
    loop = Loop(scene, system, choose(system, scene, numerics))
    code = machine_code(advance, (*loop.arguments(), *loop.followed(), loop.team, 0, 0, 0, 1e-9))
    return {effect: contains(code, law) for effect, law in LAWS.items()}
