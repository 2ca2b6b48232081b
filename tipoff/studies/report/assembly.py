"""The whole page: one section for each study, from its result file; a section without a result names
the make target of the result."""

import datetime
from collections.abc import Sequence

from tipoff.results.trajectory import versions
from tipoff.scenes import implausible
from tipoff.studies.agreement import stage as compare
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.question import Section
from tipoff.studies.registry import sections
from tipoff.studies.render.document import Caption, Missing, Notice, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.report import answer, inputs, template
from tipoff.studies.report.page import Page
from tipoff.studies.report.promises import promises, table
from tipoff.studies.report.template import Drawn, Group
from tipoff.workspace import machine
from tipoff.workspace.attempt import attempt
from tipoff.workspace.stage import Made

_VALIDATION = (
    "Promises are checked on the runs of this page. `docs/verification_and_validation.md` has the cases "
    "with known answers, the published measurements, and what is not validated."
)
_TIMES = (
    "Wall time and number of runs when the result was made; runs that were stored by then are not counted. "
    "Compilation is included."
)
_EVIDENCE, _STUDIES = "Evidence", "Studies"
_GROUPS = {
    "Motion": ("thrust", "figure6", "contact-forces", "energy", "stress"),
    _EVIDENCE: (
        "agreement-section",
        "growth-section",
        "speedup",
        "cost",
        "convergence",
        "blind",
        "calibration",
        "compliance",
        "mesh",
        "ablation",
        "rails",
    ),
}


def render(page: Page) -> str:
    """The whole ``page`` as HTML. Writes every figure as PNG and SVG.

    A section that raises an exception is shown as failed, with its reason; ``page.failures`` has
    them.
    """
    drawn: dict[str, list[Drawn]] = {title: [] for title in (*_GROUPS, _STUDIES)}
    order = [name for names in _GROUPS.values() for name in names]
    ranked = {name: place for place, name in enumerate(order)}
    for item in sorted(sections(), key=lambda item: ranked.get(item.anchor, len(order))):
        group = next((title for title, names in _GROUPS.items() if item.anchor in names), _STUDIES)
        drawn[group].append(_drawn(page, item))
    drawn[_EVIDENCE].append(_drawn(page, Section("promises", "Promises", _promises, "Promises")))
    last = [
        _drawn(page, Section("scene", "Inputs", _inputs, "Inputs")),
        _drawn(page, Section("colophon", "Origin", _colophon, "Origin of the results")),
    ]
    answered = Section("answer", "Answer", answer.draw, "Velocity and rates after exit")
    # Drawn last, because it names the failures of the other sections.
    first = _drawn(page, answered, [Notice(text) for text in _warnings(page)])
    groups = [
        Group("", [first]),
        *(Group(title, [item for item in found if item.html]) for title, found in drawn.items()),
        Group("Appendix", last, page.parts(_not_made(page))),
    ]
    shown = [group for group in groups if group.sections or group.end]
    return template.page(f"tipoff: {page.scene.name}", page.scene.description, shown)


def _warnings(page: Page) -> list[str]:
    """Warnings that the reader must know before the answer."""
    found = [f"Implausible: {warning}" for warning in implausible.of_all_conditions(page.scene)]
    found += [f"{stage}: {reason}" for stage, reason in page.problems.items()]
    return found + [f"Section {name} failed: {reason}" for name, reason in page.failures.items()]


def _drawn(page: Page, item: Section, before: Sequence[Part] = ()) -> Drawn:
    """A section, with the parts ``before`` it below its heading; empty if there is nothing to show,
    the reason if it fails."""

    def made() -> str:
        parts = item.draw(page)
        if all(isinstance(part, Missing) for part in parts):
            return ""
        return template.section(item.anchor, item.title, page.parts([*before, *parts]))

    html, reason = attempt(f"section {item.anchor}", made)
    if html is None:
        page.failures[item.anchor] = reason
        failed = page.parts([*before, Notice(f"This section failed: {reason}")])
        html = template.section(item.anchor, item.title, failed)
    return Drawn(item.anchor, item.link, html)


def _promises(page: Page) -> list[Part]:
    agreement, calibration = page.result(compare.STAGE), page.result(calibrate.STAGE)
    return [table(promises(page.rows(), agreement, calibration)), Caption(_VALIDATION)]


def _inputs(page: Page) -> list[Part]:
    return inputs.scene_tables(page.scene)


def _not_made(page: Page) -> list[Part]:
    """One line on the studies without a result, with the command as the user would type it."""
    if not page.lacking:
        return []
    names = ", ".join(dict.fromkeys(page.lacking))
    return [
        Missing(
            f"Not made: {names}. `{page.command('NAME')}` makes the one whose name replaces NAME."
        )
    ]


def _colophon(page: Page) -> list[Part]:
    here = machine.describe()
    facts = [
        ("made", datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")),
        (
            "machine",
            f"{here['processor']}, {here['cores']} cores, {here['memory_gib']} GiB, "
            f"{here['system']}",
        ),
        ("Python", here["python"]),
        *versions().items(),
        ("scene hash", f"`{page.scene.hash}`"),
    ]
    made = {name: found for name, found in page.results.items() if isinstance(found, Made)}
    rows = [
        (
            f"{name}.json",
            found.took.get("wall_s"),
            found.took.get("runs"),
            machine.stated(found.state),
            f"`{found.key}`",
        )
        for name, found in made.items()
    ]
    heads = (
        "result file",
        Column("made in", "s", ",.0f"),
        "runs made",
        "made by",
        "key: hash of scene, code and numerics",
    )
    return [Table(("", ""), facts), Table(heads, rows, notes=(_TIMES,))]
