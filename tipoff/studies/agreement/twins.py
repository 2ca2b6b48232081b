"""Runs with 1 um more and less clearance beside those of a study: floor and growth."""

from collections.abc import Callable, Iterable
from functools import partial

from tipoff.mechanics.models import FINITE_ELEMENTS
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.agreement import growth, verdicts
from tipoff.studies.agreement.candidates import Candidate
from tipoff.studies.agreement.verdicts import Spread, spread
from tipoff.workspace.run import Run, with_modes_of
from tipoff.workspace.study import Study


def floors(study: Study, model: str, request: Callable[..., Run]) -> list[Spread]:
    """Spread of one model under +-1 um of clearance, on the scene's conditions of the floor;
    ``request`` makes its runs."""
    if study.scene.contact is None:
        return []
    return [
        spread(name, model, "clearance", nominal, changed)
        for name, (nominal, *changed) in _twins(
            study, f"floor, {model}", request, study.scene.agreement.floor
        ).items()
    ]


def growths(study: Study, compliant: Candidate, rows: Iterable[dict]) -> list[growth.Growth]:
    """Growth of 1 um of clearance in both models, on the conditions of the floor and on those whose
    reference is not converged in the ``rows`` of the agreement table, because chaos can be the
    reason."""
    if study.scene.contact is None:
        return []
    names = dict.fromkeys(
        [
            *study.scene.agreement.floor,
            *(row["condition"] for row in rows if not row["reference_converged"]),
        ]
    )
    gate = verdicts.gates(study.scene)["settled_rate_error_deg_s"]
    return [
        growth.growth(name, model, nominal, changed, study.settings.clearance_change, gate)
        for model, request in (
            (FINITE_ELEMENTS, study.coarse),
            (compliant.title, partial(compliant.request, study)),
        )
        for name, (nominal, *changed) in _twins(study, f"growth, {model}", request, names).items()
    ]


def _twins(
    study: Study, title: str, request: Callable[..., Run], names: Iterable[str]
) -> dict[str, list[Trajectory]]:
    """The run of each condition, and its runs with 1 um more and less clearance."""
    names, changes = list(names), clearances(study)
    nominal = dict(zip(names, study.store.fill(title, [request(name) for name in names])))
    changed = study.store.fill(
        title,
        [
            with_modes_of(nominal[name], request(name, overrides=change, tag=f"-clearance-{sign}"))
            for name in names
            for sign, change in changes.items()
        ],
    )
    runs = iter(changed)
    return {name: [nominal[name], *(next(runs) for _ in changes)] for name in names}


def clearances(study: Study) -> dict[str, dict[str, float]]:
    """Overrides of a scene with contact that perturb its clearance."""
    assert study.scene.contact is not None
    return study.scene.contact.either_way(study.settings.clearance_change)
