"""One calibration: free parameters, search, and the record with its evidence."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from tipoff.calibration import (
    alignment,
    choice,
    evidence,
    faults,
    information,
    judgement,
    parameters,
    posterior,
    refine,
)
from tipoff.calibration.information import jacobian
from tipoff.calibration.objective import Objective, Parts, targets
from tipoff.calibration.offset import Offset
from tipoff.calibration.parameters import Parameter
from tipoff.calibration.search import Found, Plan, search
from tipoff.comparison.curves import Curves
from tipoff.lowfi.models import require
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.rail_compliance import model_of
from tipoff.scenes.scene import Scene

WORKERS = 2  # threads


def run(
    scene: Scene,
    references: Mapping[str, Trajectory | Curves],
    numerics=None,
    progress: Callable[[float], None] | None = None,
    plan: Plan | None = None,
    compliance: RailCompliance | None = None,
    workers: int = WORKERS,
    fit: Sequence[str] | None = None,
) -> Calibration:
    """Fit parameters of the surrogate to ``references`` (condition name to reference run or curves)
    of ``scene``. For ``springs`` these are the constants of the contact law (``parameters``). For
    ``compliant`` contact on the rail ``compliance``, or without contact, they have the names
    ``fit``; None: those that the curves determine (``choice``).

    ``numerics`` are the surrogate's (lowfi.Numerics), ``progress`` is called with the completed
    fraction, ``plan`` sets the size of the search; the same plan gives the same bits for any number
    of ``workers``, which run conditions in parallel. Springs on rails that are warm or from a file
    need their rigid ``compliance`` (``lowfi.run``).

    Raises CalibrationError for references that are missing, did not exit, are too short or do not
    turn, for names that cannot be fitted, and for curves that the model does not explain, with the
    likely cause (``judgement``); SceneError for an unknown condition and for a missing compliance.
    """
    faults.check(scene, references)
    curves = {
        name: item if isinstance(item, Curves) else Curves.from_trajectory(item)
        for name, item in references.items()
    }
    require(scene, model_of(scene, compliance), compliance, None, None)
    plan, wanted = plan or Plan(), targets(scene, curves)
    with ThreadPoolExecutor(workers) as pool:
        make = partial(
            Objective, scene, wanted, numerics=numerics, over=pool.map, compliance=compliance
        )
        springs = model_of(scene, compliance) != COMPLIANT
        if springs:
            faults.require_model(scene, SPRINGS, fit)
        elif fit is not None and list(fit) != [choice.ALL]:
            choice.named(scene, curves, fit)
        bench = judgement.before(make([]), choice.moves_free_flight(scene, fit, springs))
        if springs:
            return _of_springs(make, curves, plan, progress, bench)
        return _of_compliant_contact(make, curves, plan, progress, fit, bench)


def _of_springs(
    make: Callable, curves: dict[str, Curves], plan: Plan, progress, bench: judgement.Bench
) -> Calibration:
    scene = make([]).scene
    free, held = parameters.free(scene), parameters.held(scene)
    objective, wide = bench.ready(make(free)), bench.ready(make(free + held))
    found = search(objective, shares_in(scene, free), plan, progress)
    residuals = objective.parts(found.shares)
    bench.require_sound(objective, found.shares)
    at = np.append(found.shares, shares_in(scene, held))
    matrix = information.information(jacobian(wide, at))
    inner = matrix[: len(free), : len(free)]
    ends, count = evidence.intervals(free, found.shares, inner, list(residuals.values()))
    return _record(
        objective,
        found,
        residuals,
        inner,
        intervals=ends,
        verdict="; ".join(bench.words(objective, found.shares)),
        weak_directions=evidence.weak_directions(scene, free, held, found.shares, matrix),
        provenance=evidence.provenance(
            scene,
            curves,
            parameters.overrides(scene, objective.values(found.shares)),
            found,
            plan,
            objective.evaluations + wide.evaluations,
            f"from the residuals, {count:.0f} of them independent; model error is not in them",
        ),
    )


def _of_compliant_contact(
    make: Callable,
    curves: dict[str, Curves],
    plan: Plan,
    progress,
    fit: Sequence[str] | None,
    bench: judgement.Bench,
) -> Calibration:
    scene = make([]).scene
    free, held, stated = choice.parameters(
        scene, curves, fit, lambda items: bench.ready(make(items))
    )
    objective, wide = bench.ready(make(free)), bench.ready(make(free + held))
    own = shares_in(scene, free)
    found = search(objective, own, plan, progress)
    found = found._replace(shares=refine.refined(objective, found.shares))
    wide.offsets = objective.offsets
    residuals = objective.parts(found.shares)
    vector = objective.joined(residuals)
    found = found._replace(value=float(vector @ vector))
    bench.require_sound(objective, found.shares)
    at = np.append(found.shares, np.clip(shares_in(scene, held), 0.0, 1.0))
    slopes = jacobian(partial(refine.both, wide), at)
    matrix = information.information(slopes[: vector.size])
    inner = matrix[: len(free), : len(free)]
    left = np.concatenate(objective.curves(residuals))
    judged = posterior.at_optimum(
        refine.curves(objective, left, slopes[vector.size :, : len(free)]),
        inner,
        found.shares,
        own,
        refine.offset_slopes(objective, found.shares),
    )
    weak = evidence.weak_directions(scene, free, held, found.shares, matrix, information.ROUNDING)
    optimum = found
    if not judged.excludes:  # then the residuals are those of the scene's values
        residuals = objective.parts(own)
        vector = objective.joined(residuals)
        found = found._replace(shares=own, value=float(vector @ vector))
    offsets = {
        name: Offset(value, refine.UNIT * half, bench.offsets[name].step)
        for (name, value), half in zip(
            objective.offsets.items(), judged.half_of_nuisances.tolist(), strict=True
        )
    }
    return _record(
        objective,
        found,
        residuals,
        inner,
        changed=judged.excludes,
        fitted=[item.value(share) for item, share in zip(free, optimum.shares.tolist())],
        intervals=evidence.ends(free, optimum.shares, judged.half),
        with_model_error=evidence.ends(free, optimum.shares, judged.half_with_model_error),
        verdict=bench.verdict(objective, found.shares, judged, offsets),
        weak_directions=weak + stated,
        provenance=evidence.provenance(
            scene,
            curves,
            {},
            optimum,
            plan,
            objective.evaluations + wide.evaluations,
            judged.source,
        )
        | {"offsets in time": "; ".join(item.words(name) for name, item in offsets.items())},
    )


def _record(
    objective: Objective,
    found: Found,
    residuals: dict[str, Parts],
    inner: np.ndarray,
    changed: bool = True,
    **evidence_found,
) -> Calibration:
    """The record of the values ``found``; without constants if the scene's are not ``changed``."""
    values, free = objective.values(found.shares), objective.parameters
    return Calibration(
        constants=parameters.overrides(objective.scene, values) if changed else {},
        changes=alignment.changes(values) if changed else {},
        parameters=[item.name for item in free],
        values=list(values.values()),
        units=[item.unit for item in free],
        lower=[item.lower for item in free],
        upper=[item.upper for item in free],
        justification=[item.justification for item in free],
        information=inner,
        residuals={
            name: evidence.residuals(part, objective.targets[name])
            for name, part in residuals.items()
        },
        conditions=list(residuals),
        objective=found.value,
        **evidence_found,
    )


def shares_in(scene: Scene, items: list[Parameter]) -> np.ndarray:
    """The scene's own values as shares of the bounds."""
    return np.array([item.share(item.read(scene)) for item in items])
