"""How often a run evaluates the law of each effect: never if the scene does not have the effect."""

from tipoff.lowfi.numerics import Numerics
from tipoff.lowfi.single_run import SingleRun
from tipoff.lowfi.system import COUNTED
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.scene import Scene


def evaluations(
    scene: Scene, numerics: Numerics | None = None, compliance: RailCompliance | None = None
) -> dict[str, int]:
    """Run ``scene``, with compliant contact or springs, and count the evaluations of each effect of
    ``COUNTED``. Mass offset, initial state and damping of rails have no law: they only change
    numbers."""
    run = SingleRun(scene, numerics or Numerics(), compliance)
    run.begin()
    run.integrate(None)
    return dict(zip(COUNTED, run.system.evaluated.tolist()))
