"""Stage ``nominal``: the scene itself in both models, and the 95 % range of its rates under the random
errors that it states."""

import math
from pathlib import Path

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes import uncertainty
from tipoff.scenes.scene import NOMINAL
from tipoff.studies.nominal import spread
from tipoff.studies.runs import stage as runs
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

NAME = "nominal"


def requests(study: Study) -> dict[str, Run]:
    """The run of the scene itself in each model."""
    under = study.rail_compliance(study.condition(NOMINAL))
    return {
        FINITE_ELEMENTS: study.highfi(NOMINAL),
        COMPLIANT: study.lowfi(NOMINAL, compliance=under),
    }


def run(study: Study) -> dict:
    """``rows``: the scene itself in both models, as in the result files of runs; ``answer``, the values
    of ``spread.QUANTITIES`` by name for each model, None where its run did not settle; ``spread``, as
    ``spread.of``.

    Raises SceneError where the distributions of the errors cannot be used.
    """
    scene = study.condition(NOMINAL)
    stated = uncertainty.of_scene(scene)
    requested = requests(study)

    def make() -> tuple[dict, list[Path]]:
        found = runs.fill(study, NAME, requested)
        paths = [study.store.path(each) for each in requested.values()]
        rows = {
            model: runs.row(NOMINAL, found[model], study.relative(path))
            for model, path in zip(requested, paths)
        }
        failed = [
            f"{model}, {line}"
            for model, each in requested.items()
            for line in runs.failure(NOMINAL, each, found[model])
        ]
        made = {
            "rows": list(rows.values()),
            "answer": {model: answer(row) for model, row in rows.items()},
            "spread": spread.of(study, scene),
            "failed": failed,
        }
        return made, paths

    keys = [each.key for each in requested.values()]
    key = study.key(__name__, NAME, keys, stated and stated.resolved())
    return study.stage(NAME, key, make)


def answer(row: dict) -> dict[str, float] | None:
    """Values by the names of ``spread.QUANTITIES`` from the row of a run; None unless it settled."""
    if (settled := row["settled"]) is None:
        return None
    rates = settled["rate_deg_s"]
    values = (
        math.hypot(*rates),
        *rates,
        settled["velocity_m_s"][0],
        1e3 * row["exit_time_s"],
    )
    return {item.name: value for item, value in zip(spread.QUANTITIES, values, strict=True)}
