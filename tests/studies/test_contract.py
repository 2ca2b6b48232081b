"""What each study promises, over the registry: a typed result, a text that is kept, options that are
checked before anything is run."""

import dataclasses
import json
import typing

import pytest
import typer
from typer.testing import CliRunner

from tests.studies import kept
from tipoff.faults import SceneError
from tipoff.scenes import halving
from tipoff.studies import registry
from tipoff.studies.cli import app
from tipoff.studies.runs import stage as runs
from tipoff.workspace import options as rules
from tipoff.workspace.errors import StudyError
from validation import STUDIES

ENTRIES = (*registry.COMPARISON, *registry.ON_DEMAND, *registry.QUESTIONS, *STUDIES)
COMMANDS = [
    command for entry in ENTRIES for command in entry.commands if getattr(command, "options", None)
]
TEXTS = kept.texts()
# what every result file has beside the result
ENVELOPE = {
    "stage",
    "scene",
    "format",
    "quantities",
    "made",
    "key",
    "sha256",
    "files",
    "implausible",
    "state",
    "took",
}


def ruled(kind, path=()):
    """(path, flag, rule) of each option of a dataclass that has one."""
    for name, hint in typing.get_type_hints(kind, include_extras=True).items():
        if dataclasses.is_dataclass(hint):
            yield from ruled(hint, (*path, name))
        else:
            for rule in rules.rules(hint):
                yield (*path, name), rules.flag(name, hint), rule


def beyond(rule):
    """A number that breaks a rule."""
    return next(value for value in (-1, 0, 10**12) if not rule.holds(value))


def changed(options, path, value):
    """``options`` with another ``value`` at a ``path`` of names."""
    if len(path) > 1:
        value = changed(getattr(options, path[0]), path[1:], value)
    return dataclasses.replace(options, **{path[0]: value})


CASES = [
    pytest.param(command, path, flag, beyond(rule), rule.words, id=f"{command.__name__} {flag}")
    for command in COMMANDS
    for path, flag, rule in ruled(command.options)
]


def test_there_are_options_with_rules():
    """Control: the next test is not empty."""
    assert len(COMMANDS) >= 10 and len(CASES) >= 18  # one for each option with a rule


@pytest.mark.parametrize("command, path, flag, value, words", CASES)
def test_an_option_beyond_its_rule_is_bad_input(command, path, flag, value, words, tmp_path):
    out = tmp_path / "out"
    app = typer.Typer()
    app.command()(command)
    asked = ["--scene", "tiny", "--out", str(out), f"{flag}={value}"]
    found = CliRunner().invoke(app, asked, catch_exceptions=False)
    assert found.exit_code == 2 and flag in found.stderr, found.output
    assert not out.exists()
    with pytest.raises(SceneError) as fault:
        rules.require(changed(command.options(), path, value))
    assert [(one.source, one.expected) for one in fault.value.faults] == [(flag, words)]


@pytest.mark.parametrize(
    "stage",
    [*(stage for _, stage in kept.modules()), *runs.STAGES.values()],
    ids=lambda one: one.name,
)
def test_a_result_has_the_fields_of_its_type(stage):
    """Read and written again, a result is the same, and has nothing that its type does not know.
    Control: a result without one of its fields is refused."""
    found = json.loads((kept.FOLDER / f"{stage.name}.json").read_text())
    read = stage.read(found)
    again = stage.content(read)
    own = {name: value for name, value in found.items() if name in again}
    assert json.loads(json.dumps(again)) == own
    assert set(found) - set(again) <= ENVELOPE | {stage.field}
    for needed in stage.schema().get("required", [])[:1]:
        with pytest.raises(ValueError, match=needed):
            stage.read({name: value for name, value in found.items() if name != needed})


# of commands that are not named as their folder
WORDS = {
    "agreement": ["compare"],
    "blind": ["compare", "--blind", "8"],
    "sweeps": ["sensitivity", "--sweep", "8"],
    "mesh": ["view", "--mesh"],
}
PRINTED = [
    pytest.param(module, stage, id=stage.name)
    for module, stage in kept.modules()
    # `calibrate` has several results and reads its own curves
    if f"terminal/{stage.name}.txt" in TEXTS and stage.name != "calibration"
]


@pytest.mark.parametrize("module, stage", PRINTED)
def test_a_command_prints_the_text_or_the_result(module, stage, tmp_path, monkeypatch):
    """Of a result that is there. Whatever is printed is the kept text, and the files."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    found = json.loads((kept.FOLDER / f"{stage.name}.json").read_text())
    monkeypatch.setattr(module, "run", lambda *_: stage.made(found))
    folder = module.__package__.rpartition(".")[2]
    asked = [*WORDS.get(folder, [folder]), "--scene", "tiny", "--out", "out"]
    said = CliRunner().invoke(app, asked, catch_exceptions=False)
    shown = "\n".join(map(str.rstrip, said.stdout.splitlines()))
    assert said.exit_code == 0 and TEXTS[f"terminal/{stage.name}.txt"].strip() in shown
    assert str(kept.OUT / f"{stage.name}.json") in said.stdout
    told = CliRunner().invoke(app, [*asked, "--json"], catch_exceptions=False)
    assert json.loads(told.stdout) == found


@pytest.mark.parametrize("module, stage", PRINTED)
def test_changes_of_the_scene_are_refused_where_the_result_would_ignore_them(
    module, stage, tmp_path, monkeypatch
):
    """Control: every other command takes them."""

    def run(*_):
        raise StudyError("not made here")

    monkeypatch.setattr(module, "run", run)
    folder = module.__package__.rpartition(".")[2]
    asked = [*WORDS.get(folder, [folder]), "--scene", "tiny", "--out", str(tmp_path)]
    asked += ["--set", "payload.mass=9 kg"]
    said = CliRunner().invoke(app, asked)
    refused = said.exit_code == 2 and "1 fault in the options" in said.stderr
    assert refused != stage.of_scene
    assert not refused or "scenes and elements of their own" in said.stderr


def test_each_study_with_a_section_has_kept_results():
    shown = {name.partition("/")[2] for name in TEXTS if name.startswith("page/")}
    assert {f"{section.anchor}.md" for section in registry.sections()} == shown


@pytest.mark.parametrize("name", sorted(TEXTS))
def test_a_text_is_as_it_was(name):
    """`python -m tests.studies.kept` writes the texts again."""
    assert (kept.TEXTS / name).read_text(encoding="utf-8") == TEXTS[name]


def test_no_text_is_left_of_what_is_gone():
    assert {str(path.relative_to(kept.TEXTS)) for path in kept.TEXTS.rglob("*.*")} == set(TEXTS)


def test_each_result_with_errors_of_a_file_prints_their_sizes():
    """Of all kept results: in the terminal, beside the name of the file."""
    found = {path.stem: json.loads(path.read_text()) for path in kept.FOLDER.glob("*.json")}
    drawn = {name for name, result in found.items() if "errors" in result}
    assert drawn == {"blind", "flight", "measured"}
    for name in drawn:
        text = " ".join((kept.TEXTS / "terminal" / f"{name}.txt").read_text().split())
        sizes = found[name]["sizes"]
        assert len(sizes) == 3
        assert halving.with_sizes(found[name]["errors"], sizes) in text
