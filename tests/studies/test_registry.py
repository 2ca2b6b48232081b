"""A study of one's own: a folder and one entry of the registry are all it takes."""

import importlib
import json
import sys

import pytest
import typer
from typer.testing import CliRunner

from tipoff import scenes
from tipoff.studies import registry
from tipoff.studies.report import stage as report
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

STAGE = """
from dataclasses import dataclass

from tipoff.scenes.faults import Fault, SceneError
from tipoff.workspace.stage import Stage


@dataclass(frozen=True)
class Options:
    times: int = 2


def run(study, options=Options()):
    if options.times < 1:
        raise SceneError([Fault("--times", "value", str(options.times), "1 or more")])

    def make():
        mass = options.times * study.scene.payload.mass
        return {"asked": STAGE.plain(options), "mass_kg": mass}, []

    return STAGE.run(study, options, make)


STAGE = Stage("heavier", "tipoff.workspace.stage", Options)
"""
PAGE = """
def draw(found):
    return [f"It weighs {found['mass_kg']:g} kg."]
"""
COMMAND = '''
from tipoff.studies.commands.request import scene_command
from tipoff.studies.commands.running import Output


@scene_command()
def heavier(request, times: int = 2):
    """A payload that is heavier."""
    from heavier import stage

    found = stage.run(request.study(), stage.Options(times))
    return Output(found, lambda found: [f"{found['mass_kg']:g} kg"])
'''
ENTRY = """
from heavier import command
from tipoff.studies.question import Parts, Question


def _load():
    from heavier import page, stage

    return Parts(stage.run, stage.STAGE.stored, page.draw)


QUESTION = Question("heavier", "A heavier payload", "Heavier", command.heavier, _load)
"""


@pytest.fixture
def entry(tmp_path, monkeypatch):
    folder = tmp_path / "code" / "heavier"
    folder.mkdir(parents=True)
    texts = {"stage": STAGE, "page": PAGE, "command": COMMAND, "__init__": ENTRY}
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(folder.parent))
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

    assert call(entry, study, "--times", "3").stdout == f"{mass:g} kg\n"
    written = json.loads(study.path("heavier.json").read_text())
    assert written["asked"] == {"times": 3} and written["mass_kg"] == mass

    report.run(study)
    shown = page.read_text()
    assert 'href="#heavier"' in shown and f"It weighs {mass:g} kg." in shown


def test_the_report_makes_it_with_every(entry, study, monkeypatch):
    monkeypatch.setattr(report, "results", lambda: list(entry.load().results))
    monkeypatch.setattr(registry, "QUESTIONS", (entry,))
    report.run(study, every=True)
    assert (
        f"It weighs {2.0 * study.scene.payload.mass:g} kg." in study.path("report.html").read_text()
    )


def test_bad_options_are_bad_input(entry, study):
    found = call(entry, study, "--times", "0")
    assert found.exit_code == 2 and "expected 1 or more" in found.stderr
    assert not study.folder.exists()
