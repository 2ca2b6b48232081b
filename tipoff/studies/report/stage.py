"""Stage ``report``: makes the stages that compare both models, then one page of their results and of
all other stored results."""

from collections.abc import Sequence
from pathlib import Path

from tipoff import sources
from tipoff.files import content_hash, write_text
from tipoff.scenes.faults import InputError
from tipoff.studies.agreement import stage as compare
from tipoff.studies.core.progress import say
from tipoff.studies.core.run import Run
from tipoff.studies.core.study import Study, StudyError
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.question import Result
from tipoff.studies.registry import results
from tipoff.studies.runs import stage as runs


def run(study: Study, every: bool = False, limits: Sequence[Limit] = ()) -> dict:
    """Make missing results and write report.html; ``verdict`` is one sentence on the agreement of
    both models, ``failed`` contains the failures of all stages.

    With ``every``, each study without a present result is made too; the page gives the reason where
    the scene does not allow one. The page says whether the rates are within ``limits``.
    """
    documents: dict[str, dict | None] = {}
    problems: dict[str, str] = {}
    listed = results()
    for name, make_result, stored in listed:
        if make_result is None or stored is not None:
            continue
        try:
            documents[name] = make_result(study)
        except StudyError as fault:
            documents[name], problems[name] = None, str(fault)
    absent = _made(study, listed) if every else {}
    there = {name: stored(study) for name, _, stored in listed if stored is not None}

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.report.assembly import render
        from tipoff.studies.report.page import Page

        page = Page(
            study.scene,
            study.folder,
            documents | there,
            _trajectories(study, documents),
            problems | absent,
            limits,
        )
        path = study.path("report.html")
        write_text(path, render(page))
        found = {
            "report": study.relative(path),
            "verdict": _verdict(documents.get("agreement")),
            "failed": _failed(documents, problems),
        }
        return found, [path, *page.pictures]

    keys = {name: found and found["key"] for name, found in documents.items()}
    made_at = {
        name: study.path(f"{name}.json").read_text() for name, found in documents.items() if found
    }
    drawn = sources.digest("tipoff.studies.report.assembly")
    shown = study.key(__name__, drawn, study.scene.resolved().get("flight"), list(limits))
    key = content_hash(keys, content_hash(made_at), content_hash(there), problems | absent, shown)
    return study.stage("report", key, make)


def _verdict(agreement: dict | None) -> str:
    """How many conditions agree, and the speed-up; empty where both models were not compared."""
    if not agreement:
        return ""
    from tipoff.studies.agreement import page

    found = f"Compliant contact against finite elements: {page.summary(agreement['compliant'])}"
    speed = agreement.get("speedup_compliant")
    return found + (f"; {speed['ratio']:,.0f} times faster." if speed else ".")


def _made(study: Study, listed: list[Result]) -> dict[str, str]:
    """Make every missing optional result. Returns the reasons, by name, where the scene or its
    settings do not allow one."""
    reasons = {}
    for name, make, stored in listed:
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

    requested = [runs.requests(study, fidelity) for fidelity in ("highfi", "lowfi")]
    if documents.get("agreement"):
        plain, calibrated, *_ = compare.candidates(study)
        requested += [
            {name: candidate.request(study, name) for name in study.conditions}
            for candidate in (calibrated, plain)
        ]
    return Runs(*(_stored(study, wanted) for wanted in requested))


def _stored(study: Study, requested: dict[str, Run]) -> dict:
    """The stored runs: the page makes none."""
    return {
        name: found
        for name, run in requested.items()
        if (found := study.store.load(run)) is not None
    }
