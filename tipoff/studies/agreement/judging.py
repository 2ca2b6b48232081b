"""Judgement of surrogates on the conditions of a study, chosen or drawn.

Single runs are compared first. No single run can judge a condition whose reference is not converged, or
changes by more than the limit with 1 um. Such conditions are then judged as distributions. Runs with 1 um
more and less clearance give the floor and the growth.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import NamedTuple, TypeVar

from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import distributions, growth, refinement, verdicts
from tipoff.studies.agreement.candidates import Candidate, on_coarse
from tipoff.studies.agreement.distributions import Distribution
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.agreement.verdicts import Context, JudgedCondition, Refinement, Spread
from tipoff.workspace.run import Run, with_modes_of
from tipoff.workspace.study import Study, require_success

Name = TypeVar("Name")


class Curves(NamedTuple):
    """Runs of the ``reference`` by condition; ``rows`` of the agreement table by candidate, all of them
    judged as curves, and the ``contexts`` of these verdicts; measured ``floors``, first those of the
    reference, and ``refinements`` of the reference."""

    reference: dict[str, Trajectory]
    rows: dict[str, list[JudgedCondition]]
    contexts: dict[str, Context]
    floors: list[Spread]
    refinements: list[Refinement]


class Judged(NamedTuple):
    """``rows`` of the agreement table by candidate, each judged as a curve or as a distribution;
    ``growths`` of 1 um; ``distributions``."""

    rows: dict[str, list[JudgedCondition]]
    growths: list[Growth]
    distributions: list[Distribution]


def as_curves(study: Study, compared: Sequence[Candidate], purpose: str) -> Curves:
    """The candidates against single runs of the reference. Raises StudyError if one of these fails,
    with the ``purpose`` in the message."""
    wanted = {name: study.highfi(name) for name in study.conditions}
    reference = dict(zip(wanted, study.store.fill("highfi", list(wanted.values()))))
    require_success(reference, purpose)
    refinements = refinement.refinements(study)
    floor = floors(study, "reference", study.coarse)
    own = {
        candidate.name: floors(study, candidate.title, partial(candidate.request, study))
        for candidate in compared
    }
    gates = verdicts.gates(study.scene)
    contexts = {name: Context([*floor, *found], refinements, gates) for name, found in own.items()}
    rows = {
        candidate.name: _rows(study, candidate, reference, contexts[candidate.name])
        for candidate in compared
    }
    return Curves(reference, rows, contexts, sum(own.values(), floor), refinements)


def _rows(
    study: Study, candidate: Candidate, reference: dict[str, Trajectory], context: Context
) -> list[JudgedCondition]:
    """Agreement of one surrogate on every condition."""
    wanted = {name: candidate.request(study, name) for name in study.conditions}
    found = dict(zip(wanted, study.store.fill(candidate.title, list(wanted.values()))))
    return [
        verdicts.row(name, role, reference[name], found[name], context)
        for role in ("fitted", "held_out")
        for name in getattr(study.scene.agreement, role)
    ]


def judge(
    study: Study,
    compared: Sequence[Candidate],
    curves: Curves,
    draws: int,
    undecided: Iterable[str] = (),
) -> Judged:
    """The verdicts on the candidates, one of which is compliant contact: the verdicts of the
    ``curves``, and those of distributions over ``draws`` neighbours on conditions that no single
    run can judge. The caller knows some of these conditions, ``undecided``. The store keeps the
    runs, so an interrupted study continues."""
    static = next(candidate for candidate in compared if candidate.name == COMPLIANT)
    own = curves.rows[static.name]
    growths = _growths(study, static, own)
    wanted = distributions.counts(own, growths, undecided, draws)
    limit = verdicts.gates(study.scene).settled_rate_error_deg_s
    coarse = list(on_coarse(study, compared).values()) if wanted else []
    found = distributions.judge(study, wanted, coarse, limit)
    rows = {
        name: distributions.combined(single, found, wanted, name)
        for name, single in curves.rows.items()
    }
    return Judged(rows, growths, found)


def floors(study: Study, model: str, request: Callable[..., Run]) -> list[Spread]:
    """Spread of one model under +-1 um of clearance, on the scene's conditions of the floor;
    ``request`` makes its runs."""
    if study.scene.contact is None:
        return []
    return [
        verdicts.spread(name, model, "clearance", nominal, changed)
        for name, (nominal, changed) in twins(
            study, f"floor, {model}", request, study.scene.agreement.floor
        ).items()
    ]


def _growths(study: Study, compliant: Candidate, rows: Iterable[JudgedCondition]) -> list[Growth]:
    """Growth of 1 um of clearance in both models, on the conditions of the floor and on conditions
    whose reference is not converged in the ``rows`` of the agreement table: the reason may be
    chaos."""
    if study.scene.contact is None:
        return []
    names = dict.fromkeys(
        [
            *study.scene.agreement.floor,
            *(row.condition for row in rows if not row.reference_converged),
        ]
    )
    gate = verdicts.gates(study.scene).settled_rate_error_deg_s
    return [
        growth.growth(name, model, nominal, changed, study.settings.clearance_change, gate)
        for model, request in (
            (FINITE_ELEMENTS, study.coarse),
            (compliant.title, partial(compliant.request, study)),
        )
        for name, (nominal, changed) in twins(study, f"growth, {model}", request, names).items()
    ]


def twins(
    study: Study, title: str, request: Callable[..., Run], names: Iterable[Name]
) -> dict[Name, tuple[Trajectory, list[Trajectory]]]:
    """The run of each name, made by ``request``, and its runs with 1 um more and less clearance."""
    assert study.scene.contact is not None  # as for every caller
    names, changes = list(names), study.scene.contact.either_way(study.settings.clearance_change)
    nominal = dict(zip(names, study.store.fill(title, [request(name) for name in names])))
    wanted = [
        with_modes_of(nominal[name], request(name, overrides=change, tag=f"-clearance-{sign}"))
        for name in names
        for sign, change in changes.items()
    ]
    runs = iter(study.store.fill(title, wanted))
    return {name: (nominal[name], [next(runs) for _ in changes]) for name in names}
