"""Stages ``highfi`` and ``lowfi``: all conditions of the scene in one fidelity; the surrogate uses
compliant contact."""

import math
from pathlib import Path

from tipoff.mechanics import hand_calculation, unfinished
from tipoff.mechanics.models import FINITE_ELEMENTS
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.convergence import stresses
from tipoff.workspace import kernel_marks
from tipoff.workspace.run import Run
from tipoff.workspace.study import FAILED, Study


def requests(study: Study, fidelity: str) -> dict[str, Run]:
    """The run of each condition, by name."""
    if fidelity == "highfi":
        return {name: study.highfi(name) for name in study.conditions}
    under = study.rail_compliances(study.conditions)
    return {name: study.lowfi(name, compliance=under[name]) for name in study.conditions}


def run(study: Study, fidelity: str) -> dict:
    """``{"conditions": [...]}``, each with ``advice``, empty unless it ended too early; ``failed``
    names those that diverged, were refused, or reached the end of the scene too early."""
    requested = requests(study, fidelity)

    def make() -> tuple[dict, list[Path]]:
        runs = fill(study, fidelity, requested)
        rows = [
            row(name, runs[name], study.relative(study.store.path(run))) | beside(run, runs[name])
            for name, run in requested.items()
        ]
        failed = [
            line for name, run in requested.items() for line in failure(name, run, runs[name])
        ]
        return {"conditions": rows, "failed": failed}, [
            study.store.path(item) for item in requested.values()
        ]

    return study.stage(
        fidelity, study.key(__name__, [item.key for item in requested.values()]), make
    )


def fill(study: Study, name: str, requested: dict[str, Run]) -> dict[str, Trajectory]:
    """The runs of ``requested`` by their names, those that are not stored made under the ``name`` of
    a stage. What must be compiled first is said once."""
    asked = list(requested.values())
    missing = [run for run in asked if not study.store.path(run).is_file()]
    for run in missing:
        kernel_marks.announce(run)
    found = dict(zip(requested, study.store.fill(name, asked)))
    for run in missing:
        kernel_marks.remember(run)
    return found


def beside(request: Run, found: Trajectory) -> dict:
    """``advice`` for a run that ended too early; the rates ``by_hand`` (deg/s) with what they
    count, None where more than one pad touches; the ``thrust`` that acted; ``rail_compliance``,
    what that of the run states about its elements, None without one."""
    hand = hand_calculation.rates(request.scene, found)
    return {
        "advice": unfinished.advice(request.scene, found),
        "thrust": request.scene.thrust.describe(request.scene.time_limit),
        "rail_compliance": request.compliance and request.compliance.stated(),
        "by_hand": hand
        and {"rate_deg_s": [math.degrees(rate) for rate in hand.rate], "words": hand.words},
    }


def failure(name: str, request: Run, found: Trajectory) -> list[str]:
    """One line on the run of a condition that is no success; empty for one that exited or jammed."""
    if found.status not in (*FAILED, "time_limit"):
        return []
    words = "; ".join(filter(None, [found.message, unfinished.advice(request.scene, found)]))
    return [f"{name}: {found.status}: {words}"]


def row(name: str, run: Trajectory, path: str) -> dict:
    """One condition as in the result files; ``settled`` is null for a run that did not settle."""
    result, cost, checks = run.outcome, run.cost, run.checks
    settled = None
    if result.rate is not None:
        assert result.direction_error is not None  # a settled run has all of them
        settled = {
            "velocity_m_s": result.velocity,
            "rate_deg_s": [math.degrees(rate) for rate in result.rate],
            "lateral_velocity_m_s": result.lateral_velocity,
            "direction_error_deg": math.degrees(result.direction_error),
        }
    found = {
        "condition": name,
        "model": run.model,
        "status": run.status,
        "message": run.message,
        "exit_time_s": result.exit_time,
        "wall_s": cost["wall_s"],
        "compile_s": cost["compile_s"],
        "steps": cost["steps"],
        "dt_s": cost["dt_s"],
        "energy_error": checks.get("energy_error"),
        "transverse_energy_error": checks.get("transverse_energy_error"),
        "linear_momentum_error": checks.get("linear_momentum_error"),
        "angular_momentum_error": checks.get("angular_momentum_error"),
        "settled": settled,
        "trajectory": path,
        "checks": checks,
        "cost": cost,
        "numerics": run.numerics,
    }
    if run.model == FINITE_ELEMENTS:
        found |= {
            "elements": cost["elements"],
            "ns_per_element_step": cost["ns_per_element_step"],
        } | stresses.facts(run)
    return found
