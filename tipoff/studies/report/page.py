"""The page: one section for each study, from its result file; a section without a result names
the make target of the result."""

import datetime
from collections.abc import Callable, Sequence
from pathlib import Path

from markupsafe import Markup

from tipoff.mechanics.trajectory import versions
from tipoff.scenes import plausibility
from tipoff.scenes.scene import Scene
from tipoff.studies.core import machine
from tipoff.studies.registry import sections
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart, Picture, to_files, to_html
from tipoff.studies.render.document import Caption, KeyFigures, Missing, Notice, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.report import inputs, template
from tipoff.studies.report.promises import promises, table
from tipoff.studies.report.template import Drawn
from tipoff.studies.runs.figures import Runs

_SETTLED = (
    "Settled values of the finite-element reference: means over 2 ms after exit and burnout. "
    "Velocities are in the initial scene axes, rates are inertial in payload body axes. "
    "Reference ±: the largest uncertainty by mesh, step and contact cells. Surrogate "
    "error: the largest error of compliant contact over the axes."
)
_VALIDATION = (
    "Promises are checked on the runs of this page. `docs/verification_and_validation.md` has the cases "
    "with known answers, the published measurements, and what is not validated."
)


class Page:
    """One report.

    ``documents`` are result files by stage (None where missing). ``problems`` are the reasons why a
    stage has no result.
    """

    def __init__(
        self, scene: Scene, folder: Path, documents: dict, runs: Runs, problems: dict[str, str]
    ):
        self.scene, self.folder, self.documents, self.runs, self.problems = (
            scene,
            folder,
            documents,
            runs,
            problems,
        )
        self.pictures: list[Path] = []

    def render(self) -> str:
        """The whole page as HTML. Writes every figure as PNG and SVG."""
        from plotly.offline import get_plotlyjs

        drawn = [
            self._drawn("answer", "Answer", "Velocity and rates after exit", self._answer()),
            self._drawn("scene", "Scene", "Scene", inputs.scene_tables(self.scene)),
        ]
        drawn += [
            self._drawn(item.anchor, item.link, item.title, item.draw(self)) for item in sections()
        ]
        checked = promises(self.rows(), self.documents)
        drawn += [
            self._drawn("promises", "Promises", "Promises", [table(checked), Caption(_VALIDATION)]),
            self._drawn("colophon", "Origin", "Origin of the results", self._colophon()),
        ]
        shown = [item for item in drawn if item.html]
        return template.page(
            f"tipoff: {self.scene.name}", self.scene.description, get_plotlyjs(), shown
        )

    def _drawn(self, anchor: str, link: str, title: str, parts: Sequence[Part]) -> Drawn:
        """A section of ``parts``; empty where there are none."""
        html = template.section(anchor, title, self.parts(parts)) if parts else ""
        return Drawn(anchor, link, html)

    def shown(self, result: str, body: Callable[[dict], Sequence[Part]], target: str) -> list[Part]:
        """What ``body`` makes of a ``result``; without the result, how to make it."""
        found = self.documents.get(result)
        return list(body(found)) if found else [self.missing(result, target)]

    def missing(self, stage: str, target: str) -> Notice | Missing:
        """The reason why a result is missing, or the make ``target`` that makes it."""
        if reason := self.problems.get(stage):
            return Notice(reason)
        return Missing(f"No result yet. `make {target} SCENE={self.scene.name}` makes it.")

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
        """Warnings, wall times, and the settled velocities and rates of all conditions."""
        warnings = [
            f"Implausible: {warning}" for warning in plausibility.of_all_conditions(self.scene)
        ]
        warnings += [f"{stage}: {reason}" for stage, reason in self.problems.items()]
        return [*map(Notice, warnings), KeyFigures(self._speeds()), self._settled()]

    def _speeds(self) -> list[tuple[str, str]]:
        """Wall times of one run and their ratios, each with its meaning; empty before the
        comparison of both models."""
        agreement = self.documents.get("agreement") or {}
        if not (speed := agreement.get("speedup_compliant")):
            return []
        facts = [
            (f"{speed['highfi_wall_s']:.3g} s", "one reference run"),
            (f"{1e3 * speed['lowfi_wall_s']:.3g} ms", "one surrogate run"),
            (f"{speed['ratio']:,.0f} ×", f"faster ({speed['low']:,.0f} to {speed['high']:,.0f})"),
        ]
        if equal := (self.documents.get("convergence") or {}).get("equal_accuracy"):
            bound = "" if equal["surer"] else "at least, "
            mesh = f"{1e3 * equal['element_size_m']:g} mm"
            facts.append((f"{equal['ratio']:,.0f} ×", f"{bound}at equal accuracy (mesh of {mesh})"))
        return facts

    def _settled(self) -> Table:
        agreement = self.documents.get("agreement") or {}
        compared = {row["condition"]: row for row in agreement.get("compliant", [])}
        rows = []
        for found in self.rows()["highfi"]:
            settled, errors = found["settled"] or {}, compared.get(found["condition"], {})
            rows.append(
                (
                    found["condition"],
                    found["status"],
                    settled.get("velocity_m_s", [None])[0],
                    settled.get("lateral_velocity_m_s"),
                    settled.get("direction_error_deg"),
                    *settled.get("rate_deg_s", [None] * 3),
                    errors.get("reference_uncertainty_deg_s"),
                    errors.get("settled_rate_error_deg_s"),
                )
            )
        columns: tuple[Column | str, ...] = (
            "condition",
            "status",
            Column(Markup("v<sub>x</sub> (m/s)"), form=".4f"),
            Column("lateral v", "mm/s", scale=1e3),
            Column("off axis", "deg"),
            *(Column(f"{axis} rate", "deg/s", "+.3f") for axis in ("roll", "y", "z")),
            Column("reference ±", "deg/s", ".2g"),
            Column("surrogate error", "deg/s", ".2g"),
        )
        return Table(columns, rows, notes=(_SETTLED,))

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
