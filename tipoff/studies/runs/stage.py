"""Stages ``highfi`` and ``lowfi``: all conditions of the scene in one fidelity; the surrogate uses
compliant contact."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from tipoff.mechanics import instant
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.mechanics.outcome import Outcome, no_exit_values
from tipoff.results import guides, hand_calculation, unfinished
from tipoff.results.trajectory import Trajectory
from tipoff.studies.convergence import stresses
from tipoff.studies.runs.results import AtExit, ByHand, ConditionRun, Runs, Settled, Vector
from tipoff.workspace import model_error
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import FAILED, Study


def requests(study: Study, fidelity: str) -> dict[str, Run]:
    """The run of each condition, by name."""
    if fidelity == "highfi":
        return {name: study.highfi(name) for name in study.conditions}
    under = study.rail_compliances(study.conditions)
    return {name: study.lowfi(name, compliance=under[name]) for name in study.conditions}


def run(study: Study, fidelity: str) -> Made[Runs]:
    """All conditions in a ``fidelity``."""
    requested = requests(study, fidelity)

    def make() -> tuple[Runs, list[Path]]:
        found = fill(study, fidelity, requested)
        paths = {name: study.store.path(request) for name, request in requested.items()}
        rows = [
            ranged(
                study,
                request,
                found[name],
                row(name, found[name], study.relative(paths[name]), request),
            )
            for name, request in requested.items()
        ]
        failed = [
            line
            for name, request in requested.items()
            for line in failure(name, request, found[name])
        ]
        return Runs(conditions=tuple(rows), failed=tuple(failed)), list(paths.values())

    return STAGES[fidelity].run(study, None, make)


def _stage(fidelity: str) -> Stage:
    def inputs(study: Study, _: None) -> list[str]:
        return [request.key for request in requests(study, fidelity).values()]

    return Stage(fidelity, __name__, inputs=inputs, result=Runs)


# what the user types after "tipoff" for all conditions
EVERY = {"highfi": "run --all --model finite-elements", "lowfi": "run --all"}
STAGES = {fidelity: _stage(fidelity) for fidelity in ("highfi", "lowfi")}


def fill(study: Study, name: str, requested: dict[str, Run]) -> dict[str, Trajectory]:
    """The runs of ``requested`` by their names. Runs that are not stored are made under the
    ``name`` of a stage."""
    return dict(zip(requested, study.store.fill(name, list(requested.values()))))


def failure(name: str, request: Run, found: Trajectory) -> list[str]:
    """One line on an unsuccessful run of a condition; empty for a run that exited or jammed."""
    if found.status not in (*FAILED, "time_limit"):
        return []
    words = "; ".join(filter(None, [found.message, unfinished.advice(request.scene, found)]))
    return [f"{name}: {found.status}: {words}"]


def ranged(study: Study, request: Run, found: Trajectory, own: ConditionRun) -> ConditionRun:
    """The row ``own`` of the run ``found``, with the range over its neighbours if it is a sensitive run of the
    surrogate."""
    if request.fidelity != "lowfi":
        return own
    change = study.settings.clearance_change
    return replace(own, range=model_error.range_of(study.store, request, found, change))


def row(name: str, run: Trajectory, path: str, request: Run | None = None) -> ConditionRun:
    """The row of a condition; advice, thrust and rates by hand belong to the ``request``."""
    cost, checks = run.cost, run.checks
    beside = {} if request is None else _beside(request, run)
    if run.model == FINITE_ELEMENTS:
        beside |= {
            "elements": cost["elements"],
            "ns_per_element_step": cost["ns_per_element_step"],
            "ns_per_element_stepped": cost["ns_per_element_stepped"],
        } | stresses.facts(run)
    return ConditionRun(
        condition=name,
        model=run.model,
        status=run.status,
        message=run.message,
        exit_time_s=run.outcome.exit_time,
        wall_s=cost["wall_s"],
        compile_s=cost["compile_s"],
        steps=int(cost["steps"]),
        dt_s=cost["dt_s"],
        energy_error=checks.get("energy_error"),
        transverse_energy_error=checks.get("transverse_energy_error"),
        linear_momentum_error=checks.get("linear_momentum_error"),
        angular_momentum_error=checks.get("angular_momentum_error"),
        settled=_settled(run.outcome),
        at_exit=_at_exit(run.outcome),
        no_exit_values=no_exit_values(run.status, run.outcome),
        impulse_after_exit=run.outcome.impulse_after_exit,
        trajectory=path,
        checks=checks,
        cost=cost,
        numerics=run.numerics,
        **beside,
    )


def _settled(found: Outcome) -> Settled | None:
    if found.rate is None:
        return None
    # a settled run has all these values
    assert found.velocity and found.direction_error is not None
    assert found.lateral_velocity is not None
    return Settled(
        velocity_m_s=_vector(found.velocity),
        rate_deg_s=_vector(map(math.degrees, found.rate)),
        lateral_velocity_m_s=found.lateral_velocity,
        direction_error_deg=math.degrees(found.direction_error),
    )


def _at_exit(found: Outcome) -> AtExit | None:
    if found.exit_rate is None or found.exit_velocity is None:
        return None
    return AtExit(
        velocity_m_s=_vector(found.exit_velocity),
        rate_deg_s=_vector(map(math.degrees, found.exit_rate)),
    )


def _vector(found: Iterable[float]) -> Vector:
    x, y, z = found
    return x, y, z


def _beside(request: Run, found: Trajectory) -> dict[str, Any]:
    by_hand = {
        each.at: ByHand(_vector(map(math.degrees, each.rate_rad_s)), each.words)
        for each in hand_calculation.of_run(request.scene, found)
    }
    return {
        "advice": unfinished.advice(request.scene, found),
        "thrust": request.scene.thrust.describe(request.scene.time_limit),
        "rail_compliance": request.compliance and request.compliance.stated(),
        "no_by_hand": hand_calculation.why_not(request.scene, found),
        "by_hand": by_hand.get(instant.SETTLED),
        "by_hand_at_exit": by_hand.get(instant.EXIT),
        "guides": guides.of_run(request.scene, found),
    }
