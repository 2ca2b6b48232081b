"""Putting the page together: sections in the order a reader asks, each from its own result file, or
the target that makes it."""

import datetime
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

from tipoff.mechanics.trajectory import versions
from tipoff.scenes import plausibility
from tipoff.scenes.scene import Scene
from tipoff.studies.core import machine
from tipoff.studies.registry import sections
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart, Picture, to_files, to_html
from tipoff.studies.render.document import Part
from tipoff.studies.render.markup import Html, caption, code, number, section, table
from tipoff.studies.render.style import CSS
from tipoff.studies.report import inputs
from tipoff.studies.report.promises import promises, render
from tipoff.studies.runs.figures import Runs


class Page:
    """One report: ``documents`` are result files by stage (None where missing), ``problems`` why a
    stage has none."""

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
        """The whole page; writes every figure as PNG and SVG on the way."""
        from plotly.offline import get_plotlyjs

        known = sections()
        body = "".join(
            [
                self._answer(),
                self._scene(),
                *(item.draw(self) for item in known),
                render(promises(self.rows(), self.documents)),
                self._colophon(),
            ]
        )
        listed = [
            ("answer", "Answer"),
            ("scene", "Scene"),
            *((item.anchor, item.link) for item in known),
            ("promises", "Promises"),
            ("colophon", "Origin"),
        ]
        links = " ".join(
            f'<a href="#{name}">{words}</a>' for name, words in listed if f'id="{name}"' in body
        )
        title = f"tipoff: {escape(self.scene.name)}"
        return (
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
            f'<meta name="viewport" content="width=device-width, '
            f'initial-scale=1"><style>{CSS}</style>'
            f"<script>{get_plotlyjs()}</script></head><body><header><h1>{title}</h1>"
            f'<p class="lead">{escape(self.scene.description)}</p><nav>{links}</nav></header>'
            f"<main>{body}</main></body></html>"
        )

    def section(
        self, result: str, anchor: str, title: str, body: Callable[[dict], Html], target: str
    ) -> Html:
        """A section whose ``body`` shows a ``result``; without it, the make ``target`` that makes
        it, or why it is missing."""
        found = self.documents.get(result)
        return section(anchor, title, body(found) if found else self.missing(result, target))

    def missing(self, stage: str, target: str) -> Html:
        """Why a result is missing, or what makes it."""
        if reason := self.problems.get(stage):
            return Html(f'<div class="notice">{escape(reason)}</div>')
        return Html(
            f'<div class="absent">Not made yet: {code(f"make {target} SCENE={self.scene.name}")} '
            f"makes it.</div>"
        )

    def figure(self, chart: Chart | Picture, words: str) -> Html:
        """A chart with a caption; writes it as PNG and SVG too."""
        self.pictures += to_files(chart, self.folder / "figures")
        return Html(to_html(chart) + caption(words))

    def parts(self, parts: Sequence[Part]) -> Html:
        """The parts of a document as HTML."""
        return Html(document.html(parts, self.figure))

    def rows(self) -> dict[str, list[dict]]:
        """Conditions of both models, as their result files have them."""
        return {
            name: (self.documents.get(name) or {"conditions": []})["conditions"]
            for name in ("highfi", "lowfi")
        }

    def _answer(self) -> Html:
        """The settled velocities and rates, which is what the reader came for."""
        agreement = self.documents.get("agreement") or {}
        uncertain = {row["condition"]: row for row in agreement.get("compliant", [])}
        rows = []
        for found in self.rows()["highfi"]:
            settled, row = found["settled"], uncertain.get(found["condition"], {})
            rate = settled and settled["rate_deg_s"]
            rows.append(
                (
                    found["condition"],
                    found["status"],
                    settled and f"{settled['velocity_m_s'][0]:.4f}",
                    settled and f"{1e3 * settled['lateral_velocity_m_s']:.3g}",
                    settled and f"{settled['direction_error_deg']:.3g}",
                    *([f"{value:+.3f}" for value in rate] if rate else [None] * 3),
                    number(row.get("reference_uncertainty_deg_s"), 2),
                    number(row.get("settled_rate_error_deg_s"), 2),
                )
            )
        boxes = ""
        if speed := agreement.get("speedup_compliant"):
            facts: tuple[tuple[str, str], ...] = (
                (f"{speed['highfi_wall_s']:.3g} s", "one reference run"),
                (f"{1e3 * speed['lowfi_wall_s']:.3g} ms", "one surrogate run"),
                (
                    f"{speed['ratio']:,.0f} ×",
                    f"faster ({speed['low']:,.0f} to {speed['high']:,.0f})",
                ),
            )
            if equal := (self.documents.get("convergence") or {}).get("equal_accuracy"):
                facts += (
                    (
                        f"{equal['ratio']:,.0f} ×",
                        f"{'' if equal['surer'] else 'at least, '}at equal accuracy (mesh of "
                        f"{1e3 * equal['element_size_m']:g} mm)",
                    ),
                )
            boxes = (
                '<div class="figures">'
                + "".join(
                    f"<div><b>{value}</b><span>{words}</span></div>" for value, words in facts
                )
                + "</div>"
            )
        notices = "".join(
            f'<div class="notice">Implausible: {escape(words)}</div>'
            for words in plausibility.of_all_conditions(self.scene)
        )
        notices += "".join(
            f'<div class="notice">{escape(stage)}: {escape(words)}</div>'
            for stage, words in self.problems.items()
        )
        return section(
            "answer",
            "What the payload leaves with",
            notices,
            boxes,
            table(
                (
                    "condition",
                    "status",
                    Html("v<sub>x</sub> (m/s)"),
                    "lateral v (mm/s)",
                    "off axis (deg)",
                    "roll rate (deg/s)",
                    "y rate (deg/s)",
                    "z rate (deg/s)",
                    "reference ± (deg/s)",
                    "surrogate error (deg/s)",
                ),
                rows,
            ),
            caption(
                "Settled values of the finite-element reference: means over 2 ms after exit and "
                "burnout, "
                "velocity in initial scene axes, rates inertial in payload body axes. Reference ± "
                "is what refining mesh, step or "
                "penalty still changes; surrogate error the largest axis error of compliant "
                "contact on the same "
                "condition."
            ),
        )

    def _scene(self) -> Html:
        return section("scene", "Scene", inputs.scene_tables(self.scene))

    def _colophon(self) -> Html:
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
            ("scene hash", code(self.scene.hash)),
        ]
        keys = [
            (stage, code(found["key"]))
            for stage, found in self.documents.items()
            if found and stage not in ("view", "rails")
        ]
        return section(
            "colophon",
            "Where these numbers come from",
            table(("", ""), facts),
            table(
                ("result file", "key: hash of scene, code and numerics"),
                [(f"{stage}.json", key) for stage, key in keys],
            ),
        )
