"""A study of one's own: a folder and one entry of the registry are all it takes."""

import importlib
import json
import sys

import pytest
import typer
from typer.testing import CliRunner

from tipoff import scenes
from tipoff.studies import registry
from tipoff.studies.question import Result
from tipoff.studies.report import assembly
from tipoff.studies.report import stage as report
from tipoff.workspace.settings import defaults
from tipoff.workspace.stage import Made
from tipoff.workspace.study import Study

OPTIONS = """
from dataclasses import dataclass
from typing import Annotated

import typer

from tipoff.workspace.options import between


@dataclass(frozen=True)
class Options:
    times: Annotated[int, between(1), typer.Option(metavar="N", help="How many payloads.")] = 2
"""
STAGE = """
from dataclasses import dataclass
from typing import Annotated

from heavier.options import Options
from tipoff.studies.render.column import Column
from tipoff.workspace.stage import Stage


@dataclass(frozen=True)
class Row:
    number: Annotated[int, Column("payloads")]
    mass_kg: Annotated[float, Column("mass", "kg", ".4g")]
    place_m: Annotated[tuple[float, float, float] | None, Column("place x, y, z", "m")] = None


@dataclass(frozen=True)
class Heavier:
    mass_kg: float
    rows: tuple[Row, ...]


def run(study, options=Options()):
    def make():
        mass = study.scene.payload.mass
        rows = tuple(Row(number + 1, (number + 1) * mass) for number in range(options.times))
        return Heavier(rows[-1].mass_kg, rows), []

    return STAGE.run(study, options, make)


STAGE = Stage("heavier", "tipoff.workspace.stage", Options, result=Heavier)
"""
PAGE = """
from tipoff.studies.render.table import Table


def draw(found):
    return [f"It weighs {found.mass_kg:g} kg.", Table.of_records(found.rows)]
"""
ENTRY = '''
"""A payload that is heavier."""

from heavier.options import Options
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "A heavier payload", "Heavier", Options)
'''


@pytest.fixture
def entry(tmp_path, monkeypatch):
    folder = tmp_path / "code" / "heavier"
    folder.mkdir(parents=True)
    texts = {"options": OPTIONS, "stage": STAGE, "page": PAGE, "__init__": ENTRY}
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(folder.parent))
    importlib.invalidate_caches()
    yield importlib.import_module("heavier").QUESTION
    for name in [name for name in sys.modules if name.partition(".")[0] == "heavier"]:
        del sys.modules[name]


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path / "out" / "tiny", defaults("tiny"))


def call(entry, study, *arguments):
    app = typer.Typer()
    app.callback()(lambda: None)
    for command in entry.commands:
        app.command()(command)
    place = ["--scene", "tiny", "--out", str(study.folder.parent)]
    return CliRunner().invoke(app, ["heavier", *place, *arguments], catch_exceptions=False)


def test_a_new_study_has_a_command_a_result_and_a_section(entry, study, monkeypatch):
    monkeypatch.setattr(registry, "QUESTIONS", (*registry.QUESTIONS, entry))
    assert [item.anchor for item in registry.sections()][-1] == "heavier"
    # the comparison of both models takes minutes
    own = [item for item in registry.results() if item.name == "heavier"]
    monkeypatch.setattr(report, "results", lambda: own)
    page, mass = study.path("report.html"), 3.0 * study.scene.payload.mass

    report.run(study)
    assert (
        f"heavier. <code>tipoff NAME --scene tiny --out {study.folder.parent}" in page.read_text()
    )

    said = call(entry, study, "--times", "3").stdout
    assert said.startswith(f"It weighs {mass:g} kg.\n") and "mass (kg)" in said
    assert said.endswith("heavier.json\n  " + str(study.path("heavier.csv")) + "\n")
    written = json.loads(study.path("heavier.json").read_text())
    assert written["asked"] == {"times": 3} and written["mass_kg"] == mass
    assert study.path("heavier.csv").read_text() == (
        f"number,mass_kg,place_m\n1,{mass / 3.0},\n2,{2.0 * mass / 3.0},\n3,{mass},\n"
    )

    report.run(study)
    shown = page.read_text()
    assert 'href="#heavier"' in shown and f"It weighs {mass:g} kg." in shown


def test_a_study_without_a_page_shows_its_tables(entry, study, tmp_path):
    (tmp_path / "code" / "heavier" / "page.py").unlink()
    importlib.invalidate_caches()
    said = call(entry, study, "--times", "3").stdout
    assert "It weighs" not in said and "mass (kg)" in said and "place x, y, z (m)" in said
    with pytest.raises(ImportError):
        importlib.import_module("heavier.page")


def test_the_report_makes_it_with_every(entry, study, monkeypatch):
    monkeypatch.setattr(report, "results", lambda: list(entry.load().results))
    monkeypatch.setattr(registry, "QUESTIONS", (entry,))
    report.run(study, every=True)
    assert (
        f"It weighs {2.0 * study.scene.payload.mass:g} kg." in study.path("report.html").read_text()
    )


def test_the_page_is_written_as_results_arrive(study, monkeypatch):
    """It names what is still being made. Control: of results that take a moment, only the whole page is
    written."""
    names, seen, lasting = ("nominal", "agreement", "cost", "stability"), [], {"cost": 1.0}
    page, now = study.path("report.html"), [0.0]

    def made(name):
        def make(study):
            seen.append(page.read_text() if page.exists() else None)
            now[0] += lasting.get(name, 11.0)
            return Made(None, {"key": name, "failed": []})

        return Result(name, make)

    monkeypatch.setattr(report.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(report, "results", lambda: [made(name) for name in names])
    monkeypatch.setattr(assembly, "render", lambda page: f"made {', '.join(page.problems)}.")
    for name in ("_answer", "_verdict"):
        monkeypatch.setattr(report, name, lambda found: "")
    study.folder.mkdir(parents=True)
    for name in names:
        study.path(f"{name}.json").write_text("{}")
    report.run(study)
    early = "made agreement, cost, stability."
    assert seen == [None, early, "made cost, stability.", "made cost, stability."]
    assert page.read_text() == "made ."

    page.unlink()
    seen.clear()
    lasting.update(dict.fromkeys(names, 1.0))
    report.run(study)
    assert seen == [None] * 4
