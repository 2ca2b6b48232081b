"""Agreement at a quarter, once and four times the interface stiffness.

The interface stiffness is a property of the launcher that is known only within a factor. Both models have
it and change with it, so it is no uncertainty of the reference. Agreement must hold for any value. So
both models are compared at each value, on the coarse mesh and with the rail compliance of this mesh, so
the mesh adds nothing to their difference.

A condition is judged at a stiffness if the reference is converged and not chaotic there. If the models
miss a limit, the reference also runs with 1 um more and less clearance, which shows chaos. If one of
these runs does not settle, the cause of the miss is not known, and the condition cannot be judged. A
condition that is, or may be, chaotic at the nominal stiffness is judged as a distribution
(``agreement.distributions``).
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from tipoff.comparison.metrics import compare
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import growth, judging, verdicts
from tipoff.studies.agreement.verdicts import AtFactor, Context, Judged, RateL2, SettledError
from tipoff.studies.render.column import Column
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

Place = tuple[str, float]  # a condition and a factor of the stiffness
FACTORS = (0.25, 1.0, 4.0)
_NOT_JUDGED = {
    growth.CHAOTIC: "reference chaotic",
    growth.UNKNOWN: "growth of 1 µm in the reference not known",
}


@dataclass(frozen=True, kw_only=True)
class AtStiffness(Judged):
    """Both models on one condition at one ``factor`` of the stiffness: changes of the largest
    settled rate relative to factor 1, metrics, verdict, and ``growth`` of 1 um in the reference,
    None if not computed."""

    factor: Annotated[float, Column("factor", form="g")]
    interface_stiffness_n_m3: Annotated[float, Column("interface stiffness", "N/m³")]
    reference_change_deg_s: Annotated[
        float | None, Column("change of the reference", "deg/s", ".2g")
    ]
    surrogate_change_deg_s: Annotated[
        float | None, Column("change of the surrogate", "deg/s", ".2g")
    ]
    rate_relative_l2: RateL2
    velocity_relative_l2: float | None
    settled_rate_error_deg_s: SettledError
    growth: str | None = None


def reference(
    study: Study, name: str, factor: float, overrides: dict | None = None, tag: str = ""
) -> Run:
    """The run of the reference on the coarse mesh, with further ``overrides``."""
    own = "" if factor == 1.0 else f"-interface-{factor:g}"
    return study.coarse(name, _stiffened(study, factor) | (overrides or {}), own + tag)


def _stiffened(study: Study, factor: float) -> dict[str, float]:
    """Changes of a scene with contact for ``factor`` times its interface stiffness."""
    assert study.scene.contact is not None  # as for every caller
    return {} if factor == 1.0 else study.scene.contact.stiffened(factor)


def rows(study: Study, request: Callable[..., Run], context: Context) -> list[AtStiffness]:
    """Verdicts on the scene's refined conditions with a converged reference; none without contact.
    ``request`` makes runs of the surrogate on the compliance of the coarse mesh from condition,
    overrides and tag."""
    if study.scene.contact is None:
        return []
    places = [
        (name, factor)
        for name in study.conditions
        if name in study.scene.agreement.refined and context.converged(name)
        for factor in FACTORS
    ]
    wanted = [
        run
        for name, factor in places
        for run in (
            reference(study, name, factor),
            request(study, name, _stiffened(study, factor), f"-interface-{factor:g}-coarse"),
        )
    ]
    runs = iter(study.store.fill("interface stiffness", wanted))
    pairs = {place: (next(runs), next(runs)) for place in places}
    found = [_row(study, place, pairs, context) for place in places]
    missed = [(row.condition, row.factor) for row in found if row.judgement == verdicts.MISSES]
    grown = _growths(study, missed, context)
    return [_regarding(row, grown.get((row.condition, row.factor))) for row in found]


def _regarding(row: AtStiffness, grown: str | None) -> AtStiffness:
    """A row with the computed growth, ``grown``. A miss is a verdict only if 1 um does not grow."""
    row = replace(row, growth=grown)
    if grown is None or (why := _NOT_JUDGED.get(grown)) is None:
        return row
    missed = row.verdict.removeprefix(f"{verdicts.MISSES}: ")
    said = f"{verdicts.CANNOT}: {why} ({missed})"
    return replace(row, judgement=verdicts.CANNOT, verdict=said)


def undecided(found: Sequence[AtStiffness]) -> list[str]:
    """Conditions that no single run can judge at the nominal stiffness: their reference is, or may
    be, chaotic."""
    return [item.condition for item in found if item.factor == 1.0 and item.growth in _NOT_JUDGED]


def combined(
    agreement: Iterable[verdicts.JudgedCondition], found: Sequence[AtStiffness]
) -> list[verdicts.JudgedCondition]:
    """Rows of the agreement table with the verdicts at each factor under ``interface``. A condition
    agrees if it agrees at every factor at which it is judged. It cannot be judged if it misses at
    no factor and the growth of 1 um is not known at one factor."""
    return [
        _combined(row, [item for item in found if item.condition == row.condition])
        for row in agreement
    ]


def _combined(row: verdicts.JudgedCondition, own: list[AtStiffness]) -> verdicts.JudgedCondition:
    as_distribution = row.judgement == verdicts.AS_DISTRIBUTION
    # the distribution judges the nominal stiffness
    further = [item for item in own if not (as_distribution and item.factor == 1.0)]
    row = replace(row, interface=tuple(AtFactor(item.factor, item.verdict) for item in own))
    if row.judgement not in (verdicts.AGREES, verdicts.AS_DISTRIBUTION):
        return row
    misses = [item for item in further if item.judgement == verdicts.MISSES]
    unknown = [item for item in further if item.growth == growth.UNKNOWN]
    if not (decide := misses or unknown):
        return row
    word = verdicts.MISSES if misses else verdicts.CANNOT
    why = "" if misses else f"{_NOT_JUDGED[growth.UNKNOWN]} "
    where = ", ".join(f"{item.factor:g}" for item in decide)
    said = f"{word}: {why}at {where} times the interface stiffness"
    return replace(row, judgement=word, verdict=said)


def _row(
    study: Study, place: Place, pairs: dict[Place, tuple[Trajectory, Trajectory]], context: Context
) -> AtStiffness:
    assert study.scene.contact is not None
    name, factor = place
    (reference, surrogate), nominal = pairs[place], pairs[name, 1.0]
    difference = compare(reference, surrogate)
    touches = bool(reference.pad_force.any())
    _, judgement, verdict = verdicts.single(name, difference, context, touches)
    return AtStiffness(
        condition=name,
        factor=factor,
        interface_stiffness_n_m3=factor * study.scene.contact.series_stiffness(),
        reference_change_deg_s=verdicts.settled_change(nominal[0], reference),
        surrogate_change_deg_s=verdicts.settled_change(nominal[1], surrogate),
        rate_relative_l2=difference.rate_relative_l2,
        velocity_relative_l2=difference.velocity_relative_l2,
        settled_rate_error_deg_s=difference.settled_rate_error_deg_s,
        judgement=judgement,
        verdict=verdict,
    )


def _growths(study: Study, places: Sequence[Place], context: Context) -> dict[Place, str]:
    """``Growth.verdict`` of 1 um of clearance in the reference, by condition and factor."""

    def request(place: Place, **changes: Any) -> Run:
        return reference(study, *place, **changes)

    change, gate = study.settings.clearance_change, context.gates.settled_rate_error_deg_s
    found = judging.twins(study, "interface stiffness, chaos", request, places)
    return {
        place: growth.growth(place[0], FINITE_ELEMENTS, *runs, change, gate).verdict
        for place, runs in found.items()
    }
