"""Stage ``nominal``: the scene itself in both models, and the 95 % range of its rates under the random
errors stated in the scene."""

import math
from dataclasses import dataclass
from pathlib import Path

from tipoff.mechanics import instant
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes import uncertainty
from tipoff.scenes.names import NOMINAL
from tipoff.studies.nominal import spread
from tipoff.studies.nominal.spread import Spread
from tipoff.studies.runs import stage as runs
from tipoff.studies.runs.results import ConditionRun
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

NAME = "nominal"


def requests(study: Study) -> dict[str, Run]:
    """The run of the scene itself in each model."""
    under = study.rail_compliance(study.condition(NOMINAL))
    return {
        FINITE_ELEMENTS: study.highfi(NOMINAL),
        COMPLIANT: study.lowfi(NOMINAL, compliance=under),
    }


@dataclass(frozen=True, kw_only=True)
class Nominal:
    """The scene itself: ``rows`` of both models; ``at``: the instant of velocity and rates, and why;
    ``answer`` of each model, the values of ``spread.QUANTITIES`` by name, None if its run has none
    there; ``spread`` under random errors, None if the scene states none; ``failed``, a line for each run
    without success."""

    rows: tuple[ConditionRun, ...]
    at: str
    at_why: str
    answer: dict[str, dict[str, float] | None]
    spread: Spread | None
    failed: tuple[str, ...]


def run(study: Study) -> Made[Nominal]:
    """The answer of the scene itself with its range. Raises SceneError for invalid distributions of the errors."""
    scene = study.condition(NOMINAL)
    uncertainty.of_scene(scene)

    def make() -> tuple[Nominal, list[Path]]:
        requested = requests(study)
        found = runs.fill(study, NAME, requested)
        paths = [study.store.path(each) for each in requested.values()]
        rows = {
            model: runs.ranged(
                study,
                requested[model],
                found[model],
                runs.row(NOMINAL, found[model], study.relative(path)),
            )
            for model, path in zip(requested, paths)
        }
        failed = [
            f"{model}, {line}"
            for model, each in requested.items()
            for line in runs.failure(NOMINAL, each, found[model])
        ]
        shares = [each.outcome.impulse_after_exit for each in found.values()]
        share = next((share for share in shares if share is not None), None)
        taken = instant.chosen(None, share)
        made = Nominal(
            rows=tuple(rows.values()),
            at=taken.at,
            at_why=taken.why,
            answer={model: answer(row, taken.at) for model, row in rows.items()},
            spread=spread.of_scene(study, scene),
            failed=tuple(failed),
        )
        return made, paths

    return STAGE.run(study, None, make)


def _inputs(study: Study, _: None) -> list:
    stated = uncertainty.of_scene(study.condition(NOMINAL))
    keys = [each.key for each in requests(study).values()]
    return [keys, stated and stated.resolved()]


STAGE = Stage(NAME, __name__, inputs=_inputs, result=Nominal)


def answer(row: ConditionRun, at: str) -> dict[str, float] | None:
    """Values by the names of ``spread.QUANTITIES`` from the row of a run at an instant; None if it has
    none there."""
    seen = row.at_exit if at == instant.EXIT else row.settled
    if seen is None or row.exit_time_s is None:
        return None
    rates = seen.rate_deg_s
    values = (math.hypot(*rates), *rates, seen.velocity_m_s[0], 1e3 * row.exit_time_s)
    return {item.name: value for item, value in zip(spread.QUANTITIES, values, strict=True)}
