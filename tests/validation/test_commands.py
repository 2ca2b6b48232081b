"""The command line of the evidence, in a process of its own: it adds studies to those of the package."""

import subprocess
import sys
from pathlib import Path

import pytest

from tipoff.studies import registry
from tipoff.studies.commands import running
from validation import STUDIES

NAMES = (
    *("montecarlo", "paper", "recovery", "ripple", "scaling", "stability"),
    *("bench", "peers", "flights"),
)


def call(module: str, *arguments: str) -> subprocess.CompletedProcess:
    root = Path(__file__).resolve().parents[2]
    line = [sys.executable, "-m", module, *arguments]
    return subprocess.run(line, cwd=root, capture_output=True, text=True, timeout=120)


def test_the_evidence_is_beside_the_commands_of_the_package():
    shown, of_package = call("validation", "--help"), call("tipoff", "--help")
    for name in (*NAMES, "report", "run"):
        assert f"│ {name} " in shown.stdout, shown.stderr
    for name in NAMES:
        assert f"│ {name} " not in of_package.stdout


@pytest.mark.parametrize("name", NAMES)
def test_a_bad_option_is_refused(name):
    found = call("validation", name, "--scene", "no_such_scene")
    assert found.returncode == 2
    assert "no_such_scene" in found.stderr or "No such option" in found.stderr


def test_options_without_effect_are_refused():
    """Every one of them."""
    words = ["montecarlo", "--scene", "tiny", "--finer", "5", "--interface", "--model", "springs"]
    found = call("validation", *words)
    assert found.returncode == 2 and "--finer: " in found.stderr and "--interface: " in found.stderr
    file = call(
        "validation", "montecarlo", "--scene", "tiny", "--vary", "paper", "--reading", "half"
    )
    assert file.returncode == 2 and "--vary: " in file.stderr


def test_added_studies_are_on_the_page(monkeypatch):
    monkeypatch.setattr(registry, "ADDED", [])
    monkeypatch.setattr(running, "PROGRAMS", programs := {})
    monkeypatch.setattr(registry, "PROGRAMS", programs)
    before = [section.anchor for section in registry.sections()]
    registry.add(*STUDIES, program="python -m validation")
    registry.add(*STUDIES, program="python -m validation")
    after = [section.anchor for section in registry.sections()]
    assert after[: len(before)] == before
    assert running.program("paper --scene tiny") == "python -m validation"
    assert running.program("run --all") == "tipoff"
    assert after[len(before) :] == ["montecarlo", "tails", *NAMES[1:-1]]
