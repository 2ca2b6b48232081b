"""A scene solved with the surrogate: the options, the number of modes, the result."""

import time as clock
from collections.abc import Callable
from dataclasses import replace

from tipoff.lowfi import modes
from tipoff.lowfi.models import require
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.lowfi.single_run import Run, integrated
from tipoff.mechanics.models import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance, may_vibrate
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene


def run(
    scene: Scene,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    progress: Callable[[float], None] | None = None,
    vibrates: Callable[[int], None] | None = None,
) -> Trajectory:
    """Solve ``scene`` with rigid bodies until the settled window is complete, a jam, or the scene's
    duration.

    The ``model`` is ``compliant``: pads press on the rail ``compliance`` (``tipoff.compliance``)
    through the interface stiffness of the reference; or ``springs``: the scene's contact law at
    each pad face, and a rigid ``compliance`` where the rails are warm or from a file
    (``calibration.rail_compliance.walls``): no file is read here, so without it they are refused. A
    ``calibration`` replaces constants that were fitted on the same model. ``progress`` is called
    with the fraction of the duration done, and ``vibrates`` with each number of modes that
    ``modes="auto"`` has chosen, before the scene is run with them: their kernels may have to be
    compiled. A run whose ledgers do not close as promised is run again at tighter tolerances, as
    message and cost report; one that keeps breaking a promise is diverged. Raises SceneError, every
    fault listed, before the first step; a later failure is the status of the result."""
    require(scene, model, compliance, calibration, numerics)
    return solved(scene, calibration, numerics, progress, compliance, vibrates)


def solved(
    scene: Scene,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    progress: Callable[[float], None] | None = None,
    compliance: RailCompliance | None = None,
    vibrates: Callable[[int], None] | None = None,
) -> Trajectory:
    """``run`` without its check of the options: the model follows from ``compliance``."""
    began, cpu = clock.perf_counter(), clock.thread_time()
    scene = calibration.apply(scene) if calibration else scene
    numerics, spent = (
        numerics or Numerics(),
        {"compile_s": 0.0, "compile_cpu_s": 0.0, "kernel_s": 0.0},
    )

    def made(asked: Numerics, watches: bool = False) -> Run:
        if watches and asked.count and vibrates:
            vibrates(asked.count)
        return integrated(Run(scene, asked, compliance, watches=watches), progress, spent)

    if numerics.modes == AUTO and may_vibrate(scene, compliance):
        accurate = numerics.accurate()
        run_, choice = modes.choose(
            lambda count: made(replace(numerics, modes=count), True),
            None if accurate == numerics else lambda: made(replace(accurate, modes=0), True),
        )
        result = run_.trajectory()
        result.numerics["modes_why"] = choice.why
        result.cost.update(choice.cost())
    else:
        result = made(numerics).trajectory()
    compile_cpu = spent.pop("compile_cpu_s")
    result.cost.update(wall_s=clock.perf_counter() - began - spent["compile_s"], **spent)
    result.cost["cpu_s"] = clock.thread_time() - cpu - compile_cpu
    return result
