"""Which effects the compiled time loop of a scene really contains, read from its machine code."""

from highfi.numerics import Numerics
from highfi.run import Loop, prepare
from highfi.step import advance
from highfi.stepping import choose
from highfi.system import build
from scenes.jit import machine_code
from scenes.scene import Scene

# A function that only this effect calls.
LAWS = {"contact": "_press", "friction": "coefficient_over_speed", "gravity": "_add_weight",
        "platform": "_move_in_frame", "rail.damping": "_damp_component", "thrust_offset": "_offset_line"}


def compiled_effects(scene: Scene, numerics: Numerics | None = None) -> dict[str, bool]:
    """For each effect with code of its own, whether the kernel compiled for ``scene`` contains it."""
    numerics = numerics or Numerics()
    system = build(scene, numerics, prepare(scene, numerics))
    loop = Loop(scene, system, choose(system, scene, numerics))
    code = machine_code(advance, (*loop.arguments(), loop.team, 0, 0, 0, 1e-9))
    return {effect: law.encode() in code for effect, law in LAWS.items()}
