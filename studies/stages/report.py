"""Stage ``report``: the stages that compare both models, then one page of their results, and of what is there already: the error of
the reference, the posterior of the constants, a benchmark, and the studies that answer an engineer's questions."""

from pathlib import Path
from typing import Callable

from scenes.files import content_hash, write_text
from studies.bench import reference
from studies.report.answers import ANSWERS
from studies.stages import ablation, calibrate, compare, convergence, cost, mesh, posterior, runs, stability, view, walls
from studies.store import Run
from studies.study import Study, StudyError

STAGES: dict[str, Callable[[Study], dict]] = {
    "mesh": mesh.run, "highfi": lambda study: runs.run(study, "highfi"), "lowfi": lambda study: runs.run(study, "lowfi"),
    "walls": walls.run,
    "calibration": calibrate.run, "agreement": compare.run, cost.NAME: cost.run, "stability": stability.run,
    "ablation": ablation.run}


def run(study: Study) -> dict:
    """Runs what is missing and writes report.html; ``failed`` repeats what failed in any stage."""
    documents, problems = {}, {}
    for name, stage in STAGES.items():
        try:
            documents[name] = stage(study)
        except StudyError as fault:
            documents[name], problems[name] = None, str(fault)
    there = ({convergence.NAME: convergence.stored(study), posterior.NAME: posterior.stored(study),
              "bench": reference.stored(study.folder.parent), "view": view.stored(study)}
             | {item.name: item.stored(study) for item in ANSWERS})

    def make() -> tuple[dict, list[Path]]:
        from studies.report.page import Page

        page = Page(study.scene, study.folder, documents | there, _trajectories(study, documents), problems)
        path = study.path("report.html")
        write_text(path, page.render())
        return {"report": study.relative(path), "failed": _failed(documents, problems)}, [path, *page.pictures]

    keys = {name: found and found["key"] for name, found in documents.items()}
    made_at = {name: study.path(f"{name}.json").read_text() for name, found in documents.items() if found}
    shown = study.key(("scenes", "studies"), study.scene.resolved().get("flight"))
    key = content_hash(keys, content_hash(made_at), content_hash(there), problems, shown)
    return study.stage("report", key, make)


def _failed(documents: dict, problems: dict[str, str]) -> list[str]:
    inside = [f"{name}: {line}" for name, found in documents.items() if found for line in found.get("failed", [])]
    return inside + [f"{name}: {reason}" for name, reason in problems.items()]


def _trajectories(study: Study, documents: dict):
    from studies.report.figures import Runs

    asked = [{name: ask(name) for name in study.conditions} for ask in (study.highfi, study.lowfi)]
    if documents["agreement"]:
        asked += [{name: rung.ask(study, name) for name in study.conditions} for rung in compare.rungs(study)[1:3]]
    return Runs(*(_stored(study, runs) for runs in asked))


def _stored(study: Study, asked: dict[str, Run]) -> dict:
    """Only what is there: the page shows results and makes none."""
    return {name: found for name, run in asked.items() if (found := study.store.load(run)) is not None}
