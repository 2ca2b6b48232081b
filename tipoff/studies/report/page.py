"""The page: one section for each study, from its result file; a section without a result names
the make target of the result."""

import datetime
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path

from markupsafe import Markup

from tipoff.mechanics.trajectory import versions
from tipoff.scenes import plausibility
from tipoff.scenes.scene import Scene
from tipoff.studies.core import machine
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.registry import sections
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart, Picture, to_files
from tipoff.studies.render.document import Caption, Missing, Notice, Part
from tipoff.studies.render.interactive import to_html
from tipoff.studies.render.table import Table
from tipoff.studies.report import answer, inputs, template
from tipoff.studies.report.promises import promises, table
from tipoff.studies.report.template import Drawn, Group
from tipoff.studies.runs.figures import Runs

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


class Page:
    """One report.

    ``documents`` are result files by stage (None where missing). ``problems`` are the reasons why a
    stage has no result. ``limits`` are those of the rates that the user gave.
    """

    def __init__(
        self,
        scene: Scene,
        folder: Path,
        documents: dict,
        runs: Runs,
        problems: dict[str, str],
        limits: Sequence[Limit] = (),
    ):
        self.scene, self.folder, self.documents, self.runs, self.problems = (
            scene,
            folder,
            documents,
            runs,
            problems,
        )
        self.limits, self._missing = limits, list[str]()
        self.pictures: list[Path] = []

    def render(self) -> str:
        """The whole page as HTML. Writes every figure as PNG and SVG."""
        from plotly.offline import get_plotlyjs

        drawn: dict[str, list[Drawn]] = {title: [] for title in (*_GROUPS, _STUDIES)}
        order = [name for names in _GROUPS.values() for name in names]
        ranked = {name: place for place, name in enumerate(order)}
        for item in sorted(sections(), key=lambda item: ranked.get(item.anchor, len(order))):
            group = next(
                (title for title, names in _GROUPS.items() if item.anchor in names), _STUDIES
            )
            parts = item.draw(self)
            if not (parts and all(isinstance(part, Missing) for part in parts)):
                drawn[group].append(self._drawn(item.anchor, item.link, item.title, parts))
        kept = table(promises(self.rows(), self.documents))
        drawn[_EVIDENCE].append(
            self._drawn("promises", "Promises", "Promises", [kept, Caption(_VALIDATION)])
        )
        first = self._drawn("answer", "Answer", "Velocity and rates after exit", self._answer())
        last = [
            self._drawn("scene", "Inputs", "Inputs", inputs.scene_tables(self.scene)),
            self._drawn("colophon", "Origin", "Origin of the results", self._colophon()),
        ]
        groups = [
            Group("", [first]),
            *(
                Group(title, [item for item in found if item.html])
                for title, found in drawn.items()
            ),
            Group("Appendix", last, self.parts(self._not_made())),
        ]
        shown = [group for group in groups if group.sections or group.end]
        return template.page(
            f"tipoff: {self.scene.name}", self.scene.description, get_plotlyjs(), shown
        )

    def _not_made(self) -> list[Part]:
        """One line on the studies without a result, with the command as the user would type it."""
        if not self._missing:
            return []
        names = ", ".join(dict.fromkeys(self._missing))
        return [
            Missing(
                f"Not made: {names}. `{self.command('NAME')}` makes the one whose name replaces NAME."
            )
        ]

    def _drawn(self, anchor: str, link: str, title: str, parts: Sequence[Part]) -> Drawn:
        """A section of ``parts``; empty where there are none."""
        html = template.section(anchor, title, self.parts(parts)) if parts else ""
        return Drawn(anchor, link, html)

    def shown(self, result: str, body: Callable[[dict], Sequence[Part]], target: str) -> list[Part]:
        """What ``body`` makes of a ``result``; without the result, how to make it."""
        found = self.documents.get(result)
        return list(body(found)) if found else [self.missing(result, target)]

    def missing(self, stage: str, target: str) -> Notice | Missing:
        """The reason why a result is missing, or the command ``target`` that makes it."""
        if reason := self.problems.get(stage):
            return Notice(reason)
        self._missing.append(target)
        return Missing(f"No result yet. `{self.command(target)}` makes it.")

    def command(self, name: str) -> str:
        """The command ``name`` for this scene and folder, as the user would type it."""
        scene, out = map(shlex.quote, (self.scene.origin, str(self.folder.parent)))
        return f"tipoff {name} --scene {scene} --out {out}"

    def figure(self, chart: Chart | Picture, words: str) -> Markup:
        """A chart with a caption as HTML. Writes the chart as PNG and SVG."""
        self.pictures += to_files(chart, self.folder / "figures")
        return Markup(to_html(chart)) + self.parts([Caption(words)])

    def parts(self, parts: Sequence[Part]) -> Markup:
        """The parts of a document as HTML."""
        return document.html(parts, self.figure)

    def rows(self) -> dict[str, list[dict]]:
        """Conditions of both models, as their result files have them."""
        return {
            name: (self.documents.get(name) or {"conditions": []})["conditions"]
            for name in ("highfi", "lowfi")
        }

    def _answer(self) -> list[Part]:
        """Warnings, then the answer, and the launcher with its axes."""
        warnings = [
            f"Implausible: {warning}" for warning in plausibility.of_all_conditions(self.scene)
        ]
        warnings += [f"{stage}: {reason}" for stage, reason in self.problems.items()]
        return [*map(Notice, warnings), *answer.draw(self)]

    def _colophon(self) -> list[Part]:
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
            ("scene hash", f"`{self.scene.hash}`"),
        ]
        keys = [
            (f"{stage}.json", f"`{found['key']}`")
            for stage, found in self.documents.items()
            if found and stage not in ("view", "rails")
        ]
        return [
            Table(("", ""), facts),
            Table(("result file", "key: hash of scene, code and numerics"), keys),
        ]
