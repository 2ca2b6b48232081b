"""The whole page: one section for each study, from its result file; a section without a result names
the make target of the result."""

import datetime
from collections.abc import Sequence

from tipoff.mechanics.trajectory import versions
from tipoff.scenes import plausibility
from tipoff.studies.core import machine
from tipoff.studies.registry import sections
from tipoff.studies.render.document import Caption, Missing, Notice, Part
from tipoff.studies.render.table import Table
from tipoff.studies.report import answer, inputs, template
from tipoff.studies.report.page import Page
from tipoff.studies.report.promises import promises, table
from tipoff.studies.report.template import Drawn, Group

_VALIDATION = (
    "Promises are checked on the runs of this page. `docs/verification_and_validation.md` has the cases "
    "with known answers, the published measurements, and what is not validated."
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
        "stability",
        "ablation",
        "rails",
        "bench",
    ),
}


def render(page: Page) -> str:
    """The whole ``page`` as HTML. Writes every figure as PNG and SVG."""
    from plotly.offline import get_plotlyjs

    drawn: dict[str, list[Drawn]] = {title: [] for title in (*_GROUPS, _STUDIES)}
    order = [name for names in _GROUPS.values() for name in names]
    ranked = {name: place for place, name in enumerate(order)}
    for item in sorted(sections(), key=lambda item: ranked.get(item.anchor, len(order))):
        group = next((title for title, names in _GROUPS.items() if item.anchor in names), _STUDIES)
        parts = item.draw(page)
        if not (parts and all(isinstance(part, Missing) for part in parts)):
            drawn[group].append(_drawn(page, item.anchor, item.link, item.title, parts))
    kept = table(promises(page.rows(), page.documents))
    drawn[_EVIDENCE].append(
        _drawn(page, "promises", "Promises", "Promises", [kept, Caption(_VALIDATION)])
    )
    first = _drawn(page, "answer", "Answer", "Velocity and rates after exit", _answer(page))
    last = [
        _drawn(page, "scene", "Inputs", "Inputs", inputs.scene_tables(page.scene)),
        _drawn(page, "colophon", "Origin", "Origin of the results", _colophon(page)),
    ]
    groups = [
        Group("", [first]),
        *(Group(title, [item for item in found if item.html]) for title, found in drawn.items()),
        Group("Appendix", last, page.parts(_not_made(page))),
    ]
    shown = [group for group in groups if group.sections or group.end]
    return template.page(
        f"tipoff: {page.scene.name}", page.scene.description, get_plotlyjs(), shown
    )


def _answer(page: Page) -> list[Part]:
    """Warnings, then the answer, and the launcher with its axes."""
    warnings = [f"Implausible: {warning}" for warning in plausibility.of_all_conditions(page.scene)]
    warnings += [f"{stage}: {reason}" for stage, reason in page.problems.items()]
    return [*map(Notice, warnings), *answer.draw(page)]


def _drawn(page: Page, anchor: str, link: str, title: str, parts: Sequence[Part]) -> Drawn:
    """A section of ``parts``; empty where there are none."""
    html = template.section(anchor, title, page.parts(parts)) if parts else ""
    return Drawn(anchor, link, html)


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
    keys = [
        (f"{stage}.json", f"`{found['key']}`")
        for stage, found in page.documents.items()
        if found and stage not in ("view", "rails")
    ]
    return [
        Table(("", ""), facts),
        Table(("result file", "key: hash of scene, code and numerics"), keys),
    ]
