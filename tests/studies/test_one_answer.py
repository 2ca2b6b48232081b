"""One question has one answer: numbers of a command do not depend on the commands before it in the same
folder."""

import json

import pytest
from typer.testing import CliRunner

from tipoff.studies.cli import app

# Each has the compliance of the rails, or a population on it.
QUICK = {
    "run": ["--condition", "phi15", "--modes", "0"],
    "run, all": ["--all"],
    "run, wider": ["--condition", "phi15", "--modes", "0", "--set", "contact.clearance=1 mm"],
}
OTHER = "run, other elements"
SLOW = QUICK | {
    OTHER: ["--condition", "phi15", "--modes", "0", "--set", "studies.element_size=16 mm"],
    "ensemble": ["--cases", "4"],
    "measured": ["--cases", "50"],
    "sensitivity": ["--points", "64"],
    "calibrate": ["--model", "compliant"],
}
# of the machine and of the folder, not of the question
_BESIDE = {"wall_s", "compile_s", "cpu_s", "kernel_s", "cost", "run", "hardware", "agreement"}
_BESIDE |= {"key", "files", "file", "store", "trajectory", "made"}


def numbers(value, key=""):
    """All numbers of a result by key, without times and places."""
    if isinstance(value, dict):
        for name, item in value.items():
            if name not in _BESIDE:
                yield from numbers(item, f"{key}.{name}")
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from numbers(item, f"{key}.{place}")
    elif isinstance(value, (int, float)):
        yield key, value


def asked(name, options, out):
    command = name.partition(",")[0]
    given = [command, "--scene", "tiny", "--out", str(out), "--json", *options]
    found = CliRunner().invoke(app, given, catch_exceptions=False)
    assert found.exit_code == 0, found.output
    return dict(numbers(json.loads(found.stdout)))


def check_every_order(commands, tmp_path):
    """Each command in a fresh folder, then all in one folder and all in another in reverse: each comes
    once after each other one."""
    fresh = {name: asked(name, options, tmp_path / name) for name, options in commands.items()}
    for folder, order in (("forwards", list(commands)), ("backwards", list(commands)[::-1])):
        for place, name in enumerate(order):
            again = asked(name, commands[name], tmp_path / folder)
            assert again == fresh[name], (name, "after", order[:place])
    return fresh


def rates(found):
    return [value for key, value in found.items() if ".settled.rate_deg_s." in key]


def test_answers_do_not_depend_on_what_was_run_before(tmp_path):
    """Control: another clearance has another answer."""
    fresh = check_every_order(QUICK, tmp_path)
    assert len(rates(fresh["run"])) == 3 and rates(fresh["run"]) != rates(fresh["run, wider"])


def test_one_condition_has_the_same_answer_among_all(tmp_path):
    """Both choose their modes. The mesh of the compliance was once that of what was stored."""
    one = asked("run", ["--condition", "phi15"], tmp_path / "a")
    every = asked("run", ["--all"], tmp_path / "b")
    for axis in range(3):
        key = f".settled.rate_deg_s.{axis}"
        assert one[key] == every[f".conditions.0{key}"]


@pytest.mark.slow
@pytest.mark.timeout(3000)  # 24 commands
def test_answers_of_more_commands_do_not_depend_on_what_was_run_before(tmp_path):
    """Control: other elements of the rail compliance have another answer."""
    fresh = check_every_order(SLOW, tmp_path)
    assert rates(fresh["run"]) != rates(fresh[OTHER])
