"""Stage ``report``: the stages that compare both models, then one page of their results, and of
what is there already: the error of the reference, a benchmark, and the studies that answer an
engineer's questions."""

from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash, write_text
from tipoff.scenes.faults import InputError
from tipoff.studies.agreement import stage as compare
from tipoff.studies.core.progress import say
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study, StudyError
from tipoff.studies.question import Result
from tipoff.studies.registry import results
from tipoff.studies.runs import stage as runs


def run(study: Study, every: bool = False) -> dict:
    """Runs what is missing and writes report.html; ``failed`` repeats what failed in any stage.
    With ``every``, each study that has no present result is made too; one that the scene gives no
    occasion for says so on the page."""
    documents: dict[str, dict | None] = {}
    problems: dict[str, str] = {}
    known = results()
    for name, make_result, stored in known:
        if make_result is None or stored is not None:
            continue
        try:
            documents[name] = make_result(study)
        except StudyError as fault:
            documents[name], problems[name] = None, str(fault)
    absent = _made(study, known) if every else {}
    there = {name: stored(study) for name, _, stored in known if stored is not None}

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


def _made(study: Study, known: list[Result]) -> dict[str, str]:
    """Make every optional result that is not present; why not, by name, where the scene or its
    settings do not allow it."""
    reasons = {}
    for name, make, stored in known:
        if make is None or stored is None:
            continue
        try:
            if stored(study) is None:
                make(study)
        except (StudyError, InputError) as fault:
            reasons[name] = str(fault)
            say(f"{name}: not made\n{fault}")
    return reasons


def _failed(documents: dict, problems: dict[str, str]) -> list[str]:
    inside = [
        f"{name}: {line}"
        for name, found in documents.items()
        if found
        for line in found.get("failed", [])
    ]
    return inside + [f"{name}: {reason}" for name, reason in problems.items()]


def _trajectories(study: Study, documents: dict):
    from tipoff.studies.runs.figures import Runs

    asked = [runs.requests(study, fidelity) for fidelity in ("highfi", "lowfi")]
    if documents.get("agreement"):
        plain, calibrated, *_ = compare.candidates(study)
        asked += [
            {name: candidate.request(study, name) for name in study.conditions}
            for candidate in (calibrated, plain)
        ]
    return Runs(*(_stored(study, wanted) for wanted in asked))


def _stored(study: Study, asked: dict[str, Run]) -> dict:
    """Only what is there: the page shows results and makes none."""
    return {
        name: found for name, run in asked.items() if (found := study.store.load(run)) is not None
    }
