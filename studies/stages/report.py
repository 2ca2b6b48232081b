"""Stage ``report``: the stages that compare both models, then one page of their results, and of
what is there already: the error of the reference, a benchmark, and the studies that answer an
engineer's questions."""

import importlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import scenes
from scenes import sources
from scenes.faults import SceneError
from scenes.files import content_hash, write_text
from scenes.walls import digest
from studies.bench import reference
from studies.progress import say
from studies.report.answers import ANSWERS
from studies.settings import defaults
from studies.stages import (
    ablation,
    calibrate,
    compare,
    compliance,
    convergence,
    cost,
    mesh,
    runs,
    stability,
    view,
)
from studies.store import Run
from studies.study import INPUT_FAULTS, Study, StudyError, read

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


# each has a module here by that name
OPTIONAL = (convergence.NAME, *(item.name for item in ANSWERS))


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
        | {item.name: item.stored(study) for item in ANSWERS}
        | {"rails": beside(study.folder)}
    )

    def make() -> tuple[dict, list[Path]]:
        from studies.report.page import Page

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
    # Sections are drawn by modules that are found by name.
    drawn = sources.digest(*sources.modules("studies.report"))
    shown = study.key(__name__, drawn, study.scene.resolved().get("flight"))
    key = content_hash(keys, content_hash(made_at), content_hash(there), problems | absent, shown)
    return study.stage("report", key, make)


def _made(study: Study) -> dict[str, str]:
    """Make every optional study without a present result; why not, by name, where the scene or its
    settings do not allow it."""
    reasons = {}
    for name in OPTIONAL:
        module = importlib.import_module(f"studies.stages.{name}")
        try:
            if module.stored(study) is None:
                module.run(study)
        except (StudyError, ValueError) as fault:
            if (
                not isinstance(fault, (StudyError, SceneError))
                and type(fault).__name__ not in INPUT_FAULTS
            ):
                raise
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
    from studies.report.figures import Runs

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
