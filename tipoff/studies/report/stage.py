"""Stage ``report``: makes the stages that compare both models, then one page of their results and of
all other stored results."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic_core import to_jsonable_python

from tipoff import sources
from tipoff.faults import InputError
from tipoff.files import content_hash, write_text
from tipoff.studies.agreement import stage as compare
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.question import Result
from tipoff.studies.registry import results
from tipoff.studies.runs import stage as runs
from tipoff.workspace.attempt import attempt
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made
from tipoff.workspace.study import NotAsked, Study, StudyError

if TYPE_CHECKING:
    from tipoff.studies.nominal.stage import Nominal

_EARLY = 10.0  # s since the page was written, after which it is written with what is there


def run(study: Study, every: bool = False, limits: Sequence[Limit] = ()) -> dict:
    """Make missing results and write report.html; ``answer`` has the rates of the scene itself as lines
    of text, ``verdict`` is one sentence on the agreement of both models, ``failed`` contains the
    failures of all stages and sections.

    The page has all other results and sections if one fails, or if the scene does not allow one. The
    comparison of both models is made if the scene asks for it. While results are made, the page is
    written with those that are there, the first time with the answer of the scene itself.
    Raises InputError, before a result is made, if the scene does not allow a required one. With
    ``every``, each study without a present result is made too; the page gives the reason if the
    scene does not allow a study. The page states whether the rates are within ``limits``.
    """
    asked = tuple(limit.asked for limit in limits)
    made: dict[str, Made | None] = {}
    problems: dict[str, str] = {}
    listed = results()
    waiting = [name for name, make_result, stored, _ in listed if make_result and stored is None]
    written = time.monotonic()
    for name, make_result, stored, _ in listed:
        if make_result is None or stored is not None:
            continue
        if name == compare.STAGE.name and every:
            make_result = compare.run  # with as many neighbours as the settings have
        if made and time.monotonic() - written > _EARLY:
            _draw_early(study, made, waiting[waiting.index(name) :], limits)
            written = time.monotonic()
        passing = NotAsked if any(made.values()) else InputError
        try:
            made[name], reason = attempt(name, partial(make_result, study), passing)
            problems |= {name: reason} if reason else {}
        except NotAsked:
            made[name] = None
            say(f"{name}: not made, since the scene has no [agreement] with fitted conditions")
    absent, failed = _made(study, listed, asked) if every else ({}, {})
    problems |= failed
    there: dict[str, Any] = {}
    for name, _, stored, _ in listed:
        if stored is not None:
            there[name], reason = attempt(f"the stored result of {name}", partial(stored, study))
            problems |= {name: reason} if reason else {}
    runs_, reason = attempt("stored runs", lambda: _trajectories(study, made))
    problems |= {"stored runs": reason} if reason else {}

    def drawn() -> tuple[dict, list[Path]]:
        from tipoff.studies.report.assembly import render
        from tipoff.studies.report.page import Page
        from tipoff.studies.runs.figures import Runs

        page = Page(
            study.scene,
            study.folder,
            made | there,
            runs_ or Runs({}, {}),
            problems | absent,
            limits,
        )
        path = study.path("report.html")
        write_text(path, render(page))
        found = {
            "report": study.relative(path),
            "answer": _answer(made.get("nominal")),
            "verdict": _verdict(made.get("agreement")),
            "failed": _failed(made, problems)
            + [f"section {name}: {reason}" for name, reason in page.failures.items()],
        }
        return found, [path, *page.pictures]

    keys = {name: found and found.key for name, found in made.items()}
    files = {name: study.path(f"{name}.json").read_text() for name, found in made.items() if found}
    program = sources.digest("tipoff.studies.report.assembly")
    shown = study.key(__name__, program, study.scene.resolved().get("flight"), asked)
    key = content_hash(
        keys,
        content_hash(files),
        content_hash(
            {
                name: found.document if isinstance(found, Made) else to_jsonable_python(found)
                for name, found in there.items()
            }
        ),
        problems | absent,
        shown,
    )
    return study.stage("report", key, drawn)


def _draw_early(
    study: Study, made: dict[str, Made | None], waiting: Sequence[str], limits: Sequence[Limit]
) -> None:
    """Write the page with the results that are there; it names those that are still being made."""
    from tipoff.studies.report.assembly import render
    from tipoff.studies.report.page import Page
    from tipoff.studies.runs.figures import Runs

    def write() -> None:
        again = "being made; this page is written again when they are there"
        found, _ = attempt("stored runs", lambda: _trajectories(study, made))
        problems = {", ".join(waiting): again}
        page = Page(study.scene, study.folder, made, found or Runs({}, {}), problems, limits)
        write_text(path, render(page))
        say(f"{path}: a page without {', '.join(waiting)}")

    path = study.path("report.html")
    attempt("the first page", write)


def _answer(nominal: "Made[Nominal] | None") -> list[str]:
    """The answer of the scene itself with its range; empty if it could not be made."""
    if not nominal:
        return []
    from tipoff.studies.nominal import page
    from tipoff.studies.render import document

    return document.terminal(page.draw(nominal.result)).splitlines()


def _verdict(agreement: Made[compare.Agreement] | None) -> str:
    """How many conditions agree, and the speed-up; empty if the models were not compared."""
    if not agreement:
        return ""
    from tipoff.studies.agreement import page

    found = agreement.result
    return (
        f"Compliant contact against finite elements: {page.summary(found.compliant)}; "
        f"{found.speedup_compliant.ratio:,.0f} times faster."
    )


def _made(
    study: Study, listed: list[Result], limits: tuple[str, ...]
) -> tuple[dict[str, str], dict[str, str]]:
    """Make every missing optional result, with ``limits`` of rates where it depends on them. Returns
    reasons by name for results that the scene or its settings do not allow, and for those that
    failed."""
    refused: dict[str, str] = {}
    failed: dict[str, str] = {}
    for name, make, stored, within in listed:
        if make is None or stored is None:
            continue
        wanted = make if within is None or not limits else partial(_within, within, limits)
        try:
            missing = partial(_missing, study, wanted, stored)
            _, reason = attempt(name, missing, (StudyError, InputError))
            failed |= {name: reason} if reason else {}
        except (StudyError, InputError) as fault:
            refused[name] = str(fault)
            say(f"{name}: not made\n{fault}")
    return refused, failed


def _within(
    make: Callable[[Study, tuple[str, ...]], Made], limits: tuple[str, ...], study: Study
) -> Made:
    return make(study, limits)


def _missing(
    study: Study, make: Callable[[Study], Made], stored: Callable[[Study], Any]
) -> Made | None:
    """The new result of a stage; None if there is a stored one."""
    return make(study) if stored(study) is None else None


def _failed(made: dict[str, Made | None], problems: dict[str, str]) -> list[str]:
    inside = [
        f"{name}: {line}"
        for name, found in made.items()
        if found
        for line in found.document.get("failed", [])
    ]
    return inside + [f"{name}: {reason}" for name, reason in problems.items()]


def _trajectories(study: Study, made: dict[str, Made | None]):
    from tipoff.studies.runs.figures import Runs

    requested = [runs.requests(study, fidelity) for fidelity in ("highfi", "lowfi")]
    if made.get(compare.STAGE.name):
        plain, calibrated, *_ = compare.candidates(study)
        requested += [
            {name: candidate.request(study, name) for name in study.conditions}
            for candidate in (calibrated, plain)
        ]
    return Runs(*(_stored(study, wanted) for wanted in requested))


def _stored(study: Study, requested: dict[str, Run]) -> dict:
    """The stored runs; the page makes no new ones."""
    return {
        name: found
        for name, run in requested.items()
        if (found := study.store.load(run)) is not None
    }
