"""Which effects the compiled time loop of a scene really contains, read from its machine code."""

from lowfi.march import march
from lowfi.numerics import Numerics
from lowfi.run import Run
from scenes.jit import machine_code
from scenes.scene import Scene

# A function that only this effect calls.
LAWS = {"contact": "penetration", "friction": "coefficient_over_speed", "sticking": "traction", "gravity": "_weigh",
        "platform": "_relative_turn", "thrust_offset": "_offset_line"}


def compiled_effects(scene: Scene, numerics: Numerics | None = None) -> dict[str, bool]:
    """For each effect with code of its own, whether the kernel compiled for ``scene`` contains it."""
    begun = Run(scene, numerics or Numerics())
    code = machine_code(march, (begun.system, begun.plan, begun.tolerance, begun.loop, 0, True, begun.rows, begun.forces))
    return {effect: law.encode() in code for effect, law in LAWS.items()}
