"""Data for the sections of the page: the results and their scene."""

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup

from tipoff.scenes.scene import Scene
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.commands.running import program
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart, Picture, to_files
from tipoff.studies.render.document import Caption, Missing, Notice, Part
from tipoff.studies.render.palette import themed
from tipoff.studies.runs import stage as runs
from tipoff.studies.runs.figures import Runs
from tipoff.studies.runs.results import ConditionRun
from tipoff.workspace.stage import Made, Stage

_Result = TypeVar("_Result")


class Page:
    """One report: its results, and the tools for its sections.

    ``results`` by name: ``Made`` of a stage, None where missing. ``problems`` are the reasons why a
    stage has no result. ``limits`` are the limits of rates from the user.
    """

    def __init__(
        self,
        scene: Scene,
        folder: Path,
        results: Mapping[str, Any],
        runs: Runs,
        problems: dict[str, str],
        limits: Sequence[Limit] = (),
    ):
        self.scene, self.folder, self.results = scene, folder, results
        self.runs, self.problems = runs, problems
        self.limits = limits
        self.lacking: list[str] = []  # commands of results that are missing
        self.failures: dict[str, str] = {}  # reasons of sections that failed, by anchor
        self.pictures: list[Path] = []

    def shown(
        self, stage: Stage[_Result], body: Callable[[_Result], Sequence[Part]], target: str
    ) -> list[Part]:
        """The parts that ``body`` makes of the result of a ``stage``; without the result, the command
        that makes it."""
        found = self.result(stage)
        return list(body(found)) if found else [self.missing(stage.name, target)]

    def result(self, stage: Stage[_Result]) -> _Result | None:
        """The result of a stage; None where it is missing."""
        found: Made[_Result] | None = self.results.get(stage.name)
        return found.result if found else None

    @property
    def equal_accuracy(self) -> EqualAccuracy | None:
        """The speed-up at equal accuracy; None if the convergence study did not measure it."""
        found = self.result(convergence.STAGE)
        return found.equal_accuracy if found else None

    def missing(self, stage: str, target: str) -> Notice | Missing:
        """The reason why a result is missing, or the command ``target`` that makes it."""
        if reason := self.problems.get(stage):
            return Notice(reason)
        target = runs.EVERY.get(target, target)
        self.lacking.append(target)
        return Missing(f"No result yet. `{self.command(target)}` makes it.")

    def command(self, name: str) -> str:
        """The command ``name`` for this scene and folder, as the user would type it."""
        scene, out = map(shlex.quote, (self.scene.source, str(self.folder.parent)))
        return f"{program(name)} {name} --scene {scene} --out {out}"

    def figure(self, chart: Chart | Picture, words: str) -> Markup:
        """A chart with a caption as HTML. Writes the chart as PNG and SVG."""
        png, svg = to_files(chart, self.folder / "figures")
        self.pictures += [png, svg]
        drawn = themed(svg.read_text(encoding="utf-8"), f"chart-{chart.name}", words)
        return Markup(f'<div class="wide">{drawn}</div>') + self.parts([Caption(words)])

    def parts(self, parts: Sequence[Part]) -> Markup:
        """The parts of a document as HTML."""
        return document.html(parts, self.figure)

    def rows(self) -> dict[str, Sequence[ConditionRun]]:
        """Conditions of both models."""
        return {
            name: found.conditions if (found := self.result(stage)) else ()
            for name, stage in runs.STAGES.items()
        }
