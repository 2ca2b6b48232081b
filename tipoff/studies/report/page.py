"""Putting the page together: sections in the order a reader asks, each from its own result file, or
the target that makes it."""

import base64
import datetime
from html import escape
from pathlib import Path

from tipoff.mechanics.trajectory import versions
from tipoff.scenes import plausibility
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import growth_page, rails_page
from tipoff.studies.calibration import compliance_page
from tipoff.studies.convergence import page as convergence
from tipoff.studies.core import machine
from tipoff.studies.cost import scaling_page
from tipoff.studies.question import Question
from tipoff.studies.registry import QUESTIONS
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart, Picture, to_files, to_html
from tipoff.studies.render.markup import Html, caption, code, number, paragraph, section, table
from tipoff.studies.render.style import CSS
from tipoff.studies.report import figures, inputs, tables
from tipoff.studies.report.figures import Runs
from tipoff.studies.report.promises import promises, render
from tipoff.studies.runs import stress_page

_CONTENTS = (
    ("answer", "Answer"),
    ("scene", "Scene"),
    ("mesh", "Mesh"),
    ("compliance", "Compliance"),
    ("thrust", "Thrust"),
    ("figure6", "Curves"),
    ("contact-forces", "Contact"),
    ("energy", "Energy"),
    ("stress", "Stress"),
    ("calibration", "Calibration"),
    ("agreement-section", "Agreement"),
    ("growth-section", "Growth of 1 µm"),
    ("speedup", "Speed"),
    ("rails", "Other rails"),
    ("cost", "Cost"),
    ("convergence", "Convergence"),
    ("bench", "Solvers"),
    ("stability", "Hard cases"),
    ("ablation", "Ablation"),
    *((item.name, item.link) for item in QUESTIONS),
    ("promises", "Promises"),
    ("colophon", "Origin"),
)


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

        body = "".join(
            [
                self._answer(),
                self._scene(),
                self._mesh(),
                self._compliance(),
                self._thrust(),
                self._curves(),
                self._contact(),
                self._energy(),
                self._stress(),
                self._of(
                    "calibration", "calibration", "Calibration", tables.calibration, "calibrate"
                ),
                self._of(
                    "agreement",
                    "agreement-section",
                    "Agreement with the reference",
                    tables.agreement,
                    "compare",
                ),
                self._growth(),
                self._of("agreement", "speedup", "Speed", self._speed, "compare"),
                self._rails(),
                self._of("cost_study", "cost", "What accuracy costs", self._cost, "cost"),
                self._convergence(),
                self._bench(),
                self._of("stability", "stability", "Hard cases", tables.stability, "stability"),
                self._of(
                    "ablation",
                    "ablation",
                    "Only what the scene calls for",
                    tables.ablation,
                    "ablation",
                ),
                *map(self._study, QUESTIONS),
                render(promises(self._rows(), self.documents)),
                self._colophon(),
            ]
        )
        links = " ".join(
            f'<a href="#{name}">{title}</a>' for name, title in _CONTENTS if f'id="{name}"' in body
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

    def _of(self, stage: str, identity: str, title: str, draw, target: str) -> Html:
        found = self.documents.get(stage)
        return draw(found) if found else section(identity, title, self._missing(stage, target))

    def _study(self, question: Question) -> Html:
        found = self.documents.get(question.name)
        shown = found and document.html(question.load().draw(found), self._figure)
        missing = self._missing(question.name, question.name)
        return section(question.name, question.title, shown or missing)

    def _missing(self, stage: str, target: str) -> Html:
        if reason := self.problems.get(stage):
            return Html(f'<div class="notice">{escape(reason)}</div>')
        return Html(
            f'<div class="absent">Not made yet: {code(f"make {target} SCENE={self.scene.name}")} '
            f"makes it.</div>"
        )

    def _figure(self, chart: Chart | Picture, words: str) -> Html:
        self.pictures += to_files(chart, self.folder / "figures")
        return Html(to_html(chart) + caption(words))

    def _rows(self) -> dict[str, list[dict]]:
        return {
            name: (self.documents.get(name) or {"conditions": []})["conditions"]
            for name in ("highfi", "lowfi")
        }

    def _answer(self) -> Html:
        """The settled velocities and rates, which is what the reader came for."""
        agreement = self.documents.get("agreement") or {}
        uncertain = {row["condition"]: row for row in agreement.get("compliant", [])}
        rows = []
        for found in self._rows()["highfi"]:
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

    def _mesh(self) -> Html:
        found = self.documents.get("mesh")
        if not found:
            return section("mesh", "Mesh", self._missing("mesh", "mesh"))
        path = self.folder / found["picture"]
        image = base64.b64encode(path.read_bytes()).decode()
        areas = [
            (name.replace("_", " "), item["facets"], f"{1e6 * item['area_m2']:.5g}")
            for name, item in found["surfaces"].items()
        ]
        words = (
            f"{found['elements']:,} {found['kind']}, {found['nodes']:,} nodes, elements of about "
            f"{1e3 * found['element_size_m']:g} mm; edges {1e3 * found['shortest_edge_m']:.3g} to "
            f"{1e3 * found['longest_edge_m']:.3g} mm, smallest scaled Jacobian "
            f"{found['smallest_scaled_jacobian']:.3f} (1 for "
            "a brick and for a regular tetrahedron)."
        )
        warned = "".join(f'<div class="notice">{escape(line)}</div>' for line in found["warnings"])
        return section(
            "mesh",
            "Mesh",
            Html(f'<img alt="mesh of the rails" src="data:image/png;base64,{image}">'),
            caption(words),
            table(("surface", "facets", "area (mm²)"), areas),
            warned,
        )

    def _compliance(self) -> Html:
        found = self.documents.get("compliance") or {}
        if not found.get("under_a_pad"):
            return Html("")
        words = compliance_page.WORDS.format(size=1e3 * found["element_size_m"])
        return section(
            "compliance",
            "Rail compliance",
            self._figure(compliance_page.picture(found["under_a_pad"]), words),
            compliance_page.table(found["under_a_pad"]),
        )

    def _thrust(self) -> Html:
        return section(
            "thrust",
            "Thrust",
            self._figure(figures.thrust_curve(self.scene), "Thrust as both models apply it."),
            inputs.thrust_facts(self.scene),
        )

    def _curves(self) -> Html:
        names = [name for name in self.scene.agreement.fitted if name in self.runs.highfi] or list(
            self.runs.highfi
        )[:5]
        if not names:
            return section("figure6", "Velocity and rates", self._missing("highfi", "highfi"))
        words = (
            "The paper's Figure 6 for this scene. Broad pale lines: finite elements. Thin lines: "
            "compliant contact. Dashed: "
            "springs, calibrated. Dotted: springs before calibration. Rates are inertial, in "
            "payload body axes. " + ("" if self.runs.calibrated else "Springs are missing.")
        )
        return section(
            "figure6",
            "Velocity and rates, all models",
            self._figure(figures.figure6(self.runs, names), words),
        )

    def _condition(self) -> str | None:
        preferred = [*self.scene.agreement.refined, *self.scene.agreement.fitted, *self.runs.highfi]
        return next((name for name in preferred if name in self.runs.highfi), None)

    def _contact(self) -> Html:
        name = self._condition()
        if name is None:
            return section("contact-forces", "Contact forces", self._missing("highfi", "highfi"))
        chart = figures.contact_forces(self.scene, self.runs, name)
        if not chart.panels:
            return section(
                "contact-forces",
                "Contact forces",
                paragraph(f"No pad carries more than 1 N on {name}."),
            )
        return section(
            "contact-forces",
            "Contact forces",
            self._figure(
                chart, f"Magnitude of the force on each pad that is touched, condition {name}."
            ),
        )

    def _energy(self) -> Html:
        name = self._condition()
        if name is None:
            return section("energy", "Energy", self._missing("highfi", "highfi"))
        return section(
            "energy",
            "Energy ledgers",
            self._figure(
                figures.energy_ledgers(self.runs, name),
                f"Condition {name}. The transverse ledger leaves out the axial motion, "
                "so that its hundreds of joules cannot hide the millijoules that decide the rates. "
                "The dashed residual should lie on "
                "zero.",
            ),
        )

    def _stress(self) -> Html:
        """Peak stresses of all conditions; pictures of those that `make view` was made for."""
        rows = self._rows()["highfi"]
        if not rows:
            return section("stress", "Stress of the rails", self._missing("highfi", "highfi"))
        return stress_page.shown(
            rows, self.documents.get("view") or [], self.folder, self.scene.name
        )

    def _speed(self, found: dict) -> Html:
        return tables.speedups(
            found, (self.documents.get("convergence") or {}).get("equal_accuracy")
        )

    def _rails(self) -> Html:
        """Other scenes with results beside these; nothing without any."""
        found = self.documents.get("rails")
        return section("rails", "Other rails", rails_page.table(found)) if found else Html("")

    def _cost(self, found: dict) -> Html:
        return section(
            "cost",
            "What accuracy costs",
            self._figure(
                figures.cost_picture(found),
                f"Condition {found['condition']}. Error against the finest finite-element mesh, "
                f"whose own "
                "uncertainty is the band: an error inside it cannot be told from zero, and counts "
                "as the band where the front of the "
                "best is drawn; the finest mesh stands at it. Right: what a tighter tolerance can "
                "still buy. Labels: element size, "
                "tolerance.",
            ),
            tables.cost(found),
            Html("<h3>How cost grows</h3>"),
            self._figure(
                scaling_page.picture(found["scaling"]),
                scaling_page.WORDS.format(condition=found["condition"]),
            ),
            scaling_page.tables(found["scaling"]),
        )

    def _growth(self) -> Html:
        """How 1 um grows, where anything touches; agreement reminds of its own stage."""
        found = (self.documents.get("agreement") or {}).get("growth")
        if not found:
            return Html("")
        return section(
            "growth-section",
            "How 1 µm grows",
            self._figure(growth_page.picture(found), growth_page.WORDS),
            growth_page.tables(found),
        )

    def _bench(self) -> Html:
        """Both solvers against the loops one would write today, where a benchmark was run."""
        found = self.documents.get("bench")
        return tables.bench(found["rows"], found["lowfi"]) if found else Html("")

    def _convergence(self) -> Html:
        """Nothing without its result, and no reminder either: only `make full-report` spends the
        minutes it takes."""
        found = self.documents.get("convergence")
        if not found:
            return Html("")
        chart = convergence.picture(found)
        drawn = (
            self._figure(chart, convergence.WORDS.format(condition=found["condition"]))
            if chart.panels
            else ""
        )
        return section(
            "convergence", "Error of the reference itself", drawn, convergence.tables(found)
        )

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
