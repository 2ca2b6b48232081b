"""One calibration: free parameters, search, and the record with its evidence."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from tipoff.calibration import compliant, evidence, faults, parameters
from tipoff.calibration.curves import Curves
from tipoff.calibration.information import information, jacobian
from tipoff.calibration.objective import Objective, targets
from tipoff.calibration.search import Plan, search
from tipoff.mechanics.models import COMPLIANT
from tipoff.mechanics.rail_compliance import RailCompliance, model_of
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene

WORKERS = 2  # threads


def run(
    scene: Scene,
    references: dict[str, Trajectory | Curves],
    numerics=None,
    progress: Callable[[float], None] | None = None,
    seed: int = 0,
    plan: Plan | None = None,
    compliance: RailCompliance | None = None,
    workers: int = WORKERS,
) -> Calibration:
    """Fit constants of the surrogate to ``references`` (condition name to reference run or curves)
    of ``scene``: of ``springs`` those of the contact law (``parameters``), of ``compliant`` contact
    on the rail ``compliance`` interface and mount stiffness, clearance and friction
    (``calibration.compliant``).

    ``numerics`` are the surrogate's (lowfi.Numerics), ``progress`` is called with the fraction
    done, ``plan`` sizes the search; the same seed gives the same bits, however many ``workers`` run
    conditions in parallel. Springs on warm rails need their rigid ``compliance`` (``lowfi.run``).
    Raises CalibrationError for references that are missing, did not exit, are too short or do not
    turn, SceneError for an unknown condition.
    """
    faults.check(scene, references)
    model = model_of(scene, compliance)
    curves = {
        name: item if isinstance(item, Curves) else Curves.from_trajectory(item)
        for name, item in references.items()
    }
    free, held = (
        (compliant.free(scene), [])
        if model == COMPLIANT
        else (parameters.free(scene), parameters.held(scene))
    )
    plan = plan or Plan()
    wanted = targets(scene, curves)
    with ThreadPoolExecutor(workers) as pool:
        objective = Objective(scene, wanted, free, numerics, pool.map, compliance)
        found = search(objective, _shares(free, scene), plan, seed, progress)
        residuals = objective.parts(found.shares)
        wide = Objective(scene, wanted, free + held, numerics, pool.map, compliance)
        matrix = information(jacobian(wide, np.append(found.shares, _shares(held, scene))))
    values = objective.values(found.shares)
    constants = parameters.overrides(scene, values)
    inner = matrix[: len(free), : len(free)]
    ends, count = evidence.intervals(free, found.shares, inner, list(residuals.values()))
    return Calibration(
        constants=constants,
        parameters=[item.name for item in free],
        values=list(values.values()),
        units=[item.unit for item in free],
        lower=[item.lower for item in free],
        upper=[item.upper for item in free],
        justification=[item.justification for item in free],
        intervals=ends,
        information=inner,
        weak_directions=evidence.weak_directions(scene, free, held, found.shares, matrix),
        residuals={
            name: evidence.residuals(part, wanted[name]) for name, part in residuals.items()
        },
        conditions=list(curves),
        objective=found.value,
        provenance=evidence.provenance(
            scene,
            curves,
            constants,
            found,
            plan,
            seed,
            objective.evaluations + wide.evaluations,
            count,
        ),
    )


def _shares(items: list[parameters.Parameter], scene: Scene) -> np.ndarray:
    """The scene's own values as shares of the bounds."""
    return np.array([item.share(item.read(scene)) for item in items])
