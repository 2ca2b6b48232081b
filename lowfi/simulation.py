"""A scene solved with the surrogate: the options, the number of modes, the result."""

import time as clock
from collections.abc import Callable
from dataclasses import replace

from tipoff.lowfi import degrees, modes
from tipoff.lowfi.models import require
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.lowfi.single_run import SingleRun, integrated
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.rail_compliance import may_vibrate
from tipoff.scenes.scene import Scene


def run(
    scene: Scene,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Solve ``scene`` with rigid bodies until the settled window is complete, the payload jams, or
    the scene's duration is over.

    The ``model`` is ``compliant``: pads press on the rail ``compliance`` (``tipoff.compliance``)
    through the interface stiffness of the reference. Or it is ``springs``: the scene's contact law
    at each pad face. Rails that are warm or from a file then need a rigid ``compliance``
    (``calibration.rail_compliance.walls``), because no file is read here. A ``calibration``
    replaces constants that were fitted on the same model. ``progress`` is called with the completed
    fraction of the duration. A run whose ledgers do not close as promised is repeated at tighter
    tolerances; message and cost state it. A run that still breaks a promise is diverged. Raises
    SceneError with every fault before the first step; a later failure is the status of the result."""
    require(scene, model, compliance, calibration, numerics)
    return solved(scene, calibration, numerics, progress, compliance)


def solved(
    scene: Scene,
    calibration: Calibration | None = None,
    numerics: Numerics | None = None,
    progress: Callable[[float], None] | None = None,
    compliance: RailCompliance | None = None,
) -> Trajectory:
    """``run`` without its check of the options; ``compliance`` determines the model."""
    began, cpu = clock.perf_counter(), clock.thread_time()
    scene = calibration.apply(scene) if calibration else scene
    numerics, spent = (
        numerics or Numerics(),
        {"compile_s": 0.0, "compile_cpu_s": 0.0, "kernel_s": 0.0},
    )

    first: SingleRun | None = None

    def made(asked: Numerics, watches: bool = False) -> SingleRun:
        nonlocal first
        run_ = SingleRun(scene, asked, compliance, watches=watches, like=first)
        first = first or run_
        return integrated(run_, progress, spent)

    why = ""
    if numerics.degree == AUTO and compliance is not None:
        plain = replace(numerics, modes=0)
        degree, why = degrees.choose(
            lambda each: made(replace(plain, degree=each)), compliance.degree
        )
        numerics = replace(numerics, degree=degree)

    def tried(count: int) -> SingleRun:
        return made(replace(numerics, modes=count), watches=count == 0)

    if numerics.modes == AUTO and may_vibrate(scene, compliance):
        accurate = numerics.accurate()
        run_, choice = modes.choose(
            tried,
            None if accurate == numerics else lambda: made(replace(accurate, modes=0), True),
        )
        result = run_.trajectory()
        result.numerics["modes_why"] = choice.why
        result.cost.update(choice.cost())
    else:
        result = made(numerics).trajectory()
    if why:
        result.numerics["degree_why"] = why
    compile_cpu = spent.pop("compile_cpu_s")
    result.cost.update(wall_s=clock.perf_counter() - began - spent["compile_s"], **spent)
    result.cost["cpu_s"] = clock.thread_time() - cpu - compile_cpu
    return result
