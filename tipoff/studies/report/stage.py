"""Stage ``report``: the stages that compare both models, then one page of their results, and of
what is there already: the error of the reference, a benchmark, and the studies that answer an
engineer's questions."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tipoff import scenes, sources
from tipoff.files import content_hash, write_text
from tipoff.mechanics.rail_compliance import digest
from tipoff.scenes.faults import InputError
from tipoff.studies.ablation import stage as ablation
from tipoff.studies.agreement import stage as compare
from tipoff.studies.bench import reference
from tipoff.studies.calibration import compliance
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.core.progress import say
from tipoff.studies.core.settings import defaults
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study, StudyError, read
from tipoff.studies.cost import stage as cost
from tipoff.studies.mesh import stage as mesh
from tipoff.studies.registry import QUESTIONS
from tipoff.studies.runs import stage as runs
from tipoff.studies.stability import stage as stability
from tipoff.studies.view import stage as view

STAGES: dict[str, Callable[[Study], dict]] = {
    "mesh": mesh.run,
    "highfi": lambda study: runs.run(study, "highfi"),
    "lowfi": lambda study: runs.run(study, "lowfi"),
    compliance.NAME: compliance.run,
    "calibration": calibrate.run,
    "agreement": compare.run,
    cost.NAME: cost.run,
    "stability": stability.run,
    "ablation": ablation.run,
}


def optional() -> dict[str, tuple[Callable[[Study], dict], Callable[[Study], dict | None]]]:
    """Studies that the page shows if they were made: how each is made, and how it is found."""
    parts = {item.name: item.load() for item in QUESTIONS}
    return {convergence.NAME: (convergence.run, convergence.stored)} | {
        name: (item.run, item.stored) for name, item in parts.items()
    }


def run(study: Study, every: bool = False) -> dict:
    """Runs what is missing and writes report.html; ``failed`` repeats what failed in any stage.
    With ``every``, each study that has no present result is made too; one that the scene gives no
    occasion for says so on the page."""
    documents: dict[str, dict | None] = {}
    problems: dict[str, str] = {}
    for name, stage in STAGES.items():
        try:
            documents[name] = stage(study)
        except StudyError as fault:
            documents[name], problems[name] = None, str(fault)
    absent = _made(study) if every else {}
    there = (
        {
            convergence.NAME: convergence.stored(study),
            "bench": reference.stored(study.folder.parent),
            "view": view.stored(study),
        }
        | {item.name: item.load().stored(study) for item in QUESTIONS}
        | {"rails": beside(study.folder)}
    )

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.report.page import Page

        page = Page(
            study.scene,
            study.folder,
            documents | there,
            _trajectories(study, documents),
            problems | absent,
        )
        path = study.path("report.html")
        write_text(path, page.render())
        return {"report": study.relative(path), "failed": _failed(documents, problems)}, [
            path,
            *page.pictures,
        ]

    keys = {name: found and found["key"] for name, found in documents.items()}
    made_at = {
        name: study.path(f"{name}.json").read_text() for name, found in documents.items() if found
    }
    drawn = sources.digest("tipoff.studies.report.page")
    shown = study.key(__name__, drawn, study.scene.resolved().get("flight"))
    key = content_hash(keys, content_hash(made_at), content_hash(there), problems | absent, shown)
    return study.stage("report", key, make)


def _made(study: Study) -> dict[str, str]:
    """Make every optional study without a present result; why not, by name, where the scene or its
    settings do not allow it."""
    reasons = {}
    for name, (make, stored) in optional().items():
        try:
            if stored(study) is None:
                make(study)
        except (StudyError, InputError) as fault:
            reasons[name] = str(fault)
            say(f"{name}: not made\n{fault}")
    return reasons


def beside(folder: Path) -> list[dict]:
    """Agreement and constants of the catalogue's scenes with other rails or pads whose folders lie
    beside ``folder``, made from the present code."""
    found, own = [], digest(scenes.load(folder.name)) if folder.name in scenes.catalog() else None
    for path in sorted(folder.parent.glob("*/agreement.json")):
        name, size = path.parent.name, (read(path) or {}).get("element_size_m")
        if name not in scenes.catalog() or digest(scenes.load(name)) == own or size is None:
            continue
        other = Study(scenes.load(name), path.parent, replace(defaults(name), element_size=size))
        if agreement := compare.stored(other):
            calibration = read(other.path("calibration.json"))
            assert calibration is not None  # with which the agreement was found
            found.append(
                {
                    "name": name,
                    "element_size_m": size,
                    "agreement": agreement,
                    "constants": calibration["constants"],
                }
            )
    return found


def _failed(documents: dict, problems: dict[str, str]) -> list[str]:
    inside = [
        f"{name}: {line}"
        for name, found in documents.items()
        if found
        for line in found.get("failed", [])
    ]
    return inside + [f"{name}: {reason}" for name, reason in problems.items()]


def _trajectories(study: Study, documents: dict):
    from tipoff.studies.report.figures import Runs

    asked = [runs.requests(study, fidelity) for fidelity in ("highfi", "lowfi")]
    if documents["agreement"]:
        plain, calibrated, *_ = compare.rungs(study)
        asked += [
            {name: rung.ask(study, name) for name in study.conditions}
            for rung in (calibrated, plain)
        ]
    return Runs(*(_stored(study, wanted) for wanted in asked))


def _stored(study: Study, asked: dict[str, Run]) -> dict:
    """Only what is there: the page shows results and makes none."""
    return {
        name: found for name, run in asked.items() if (found := study.store.load(run)) is not None
    }
