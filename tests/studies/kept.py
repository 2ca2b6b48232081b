"""Results of all studies of scene ``tiny``, and the texts that the program makes of them.

    python -m tests.studies.kept               write the texts again; git shows what changed
    python -m tests.studies.kept OUT/tiny      take over the results in a folder first

The results are those of ``tipoff report`` and of each study with few cases. A text is the Markdown of a
section of the page, what the terminal shows of a result, or the help of a command. ``test_contract``
compares the texts.
"""

import json
import os
import shutil
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest import mock

import typer
from typer.testing import CliRunner

from tipoff import scenes
from tipoff.files import read_json
from tipoff.studies import cli, registry
from tipoff.studies.render import document
from tipoff.studies.report.page import Page
from tipoff.studies.runs import stage as runs
from tipoff.studies.runs.figures import Runs
from tipoff.workspace.settings import defaults
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

FOLDER = Path(__file__).parent / "kept" / "tiny"
TEXTS = FOLDER.parent / "texts"
OUT = Path("out/tiny")
# their stages; those without a section have no text
STAGES = (
    "ablation.stage",
    "agreement.stage",
    "blind.stage",
    "calibration.compliance",
    "calibration.stage",
    "convergence.stage",
    "cost.stage",
    "curves.stage",
    "measured.stage",
    "flight.stage",
    "limits.stage",
    "mesh.stage",
    "nominal.stage",
    "sensitivity.stage",
    "sweeps.stage",
)
WITHOUT_COMMAND = ("nominal",)


def modules() -> Iterator[tuple[ModuleType, Stage]]:
    """(module, its stage) for each of STAGES."""
    for name in STAGES:
        module = import_module(f"tipoff.studies.{name}")
        yield module, module.STAGE


def result(stage: Stage) -> Any:
    """The result of a stage of ``tiny``, for tests that change a part of it."""
    return stage.read(read_json(FOLDER / f"{stage.name}.json"))


def study() -> Study:
    """The study of ``tiny`` whose folder has the results."""
    return Study(scenes.load("tiny"), FOLDER, defaults("tiny"))


def results() -> dict[str, Any]:
    """The results by the names that the page has for them, whatever code made them."""

    def of_any_key(study: Study, name: str, key: Any) -> dict | None:
        path = study.path(f"{name}.json")
        return read_json(path) if path.exists() else None

    here = study()
    stages = {stage.name: stage for _, stage in modules()} | runs.STAGES

    def made(name: str) -> Made | None:
        found = of_any_key(here, name, None)
        return found and stages[name].made(found)

    with mock.patch.object(Study, "stored", of_any_key):
        return {
            result.name: (result.stored(here) if result.stored else made(result.name))
            for result in registry.results()
        }


@mock.patch.dict(os.environ, COLUMNS="120")
def texts() -> dict[str, str]:
    """All texts, by the names of their files."""
    page = Page(study().scene, OUT, results(), Runs({}, {}), {})
    found = {
        f"page/{section.anchor}.md": document.markdown([*_heading(section), *section.draw(page)])
        for section in registry.sections()
    }
    for module, stage in modules():
        if module.__name__.endswith(".stage") and stage.name not in WITHOUT_COMMAND:
            draw = import_module(f"{module.__package__}.page").draw
            result = page.results[stage.name].result
            found[f"terminal/{stage.name}.txt"] = document.terminal(draw(result))
    group: Any = typer.main.get_command(cli.app)
    for name in sorted(group.commands):
        asked = CliRunner().invoke(cli.app, [name, "--help"])
        found[f"help/{name}.txt"] = "\n".join(map(str.rstrip, asked.output.splitlines()))
    return {name: text.strip() + "\n" for name, text in found.items() if text.strip()}


def _heading(section) -> list[str]:
    return [f"## {section.title}"]


def main(folder: str | None = None) -> None:
    """Take results over from a ``folder``, and write the texts."""
    if folder is not None:
        FOLDER.mkdir(parents=True, exist_ok=True)
        names = {stage.name for _, stage in modules()} | {"highfi", "lowfi", "cost_study"}
        for name in sorted(names):
            if (path := Path(folder) / f"{name}.json").exists():
                json.loads(path.read_text(encoding="utf-8"))
                shutil.copyfile(path, FOLDER / path.name)
    shutil.rmtree(TEXTS, ignore_errors=True)
    for name, text in texts().items():
        path = TEXTS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
