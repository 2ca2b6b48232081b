"""The docstrings of what ``import tipoff`` offers: every parameter is described, and every example
runs. The names are those of the page of reference."""

import doctest
import inspect
import pkgutil
import re
from pathlib import Path

import numpy as np
import pytest

import tipoff

PAGE = Path(__file__).resolve().parent.parent / "docs" / "reference" / "python.md"
FLAGS = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL
CONTACT = {"contact.stiffness": 7e7}


def _listed() -> dict[str, object]:
    """Functions and classes of the page by dotted name, and the methods that it lists."""
    text, found = PAGE.read_text(encoding="utf-8"), {}
    for name, options in re.findall(r"auto\w+:: tipoff\.([\w.]+)\n((?:   :.*\n)*)", text):
        if "Numerics" in name:
            continue
        owner = pkgutil.resolve_name(f"tipoff.{name}")
        found[name] = owner
        members = re.search(r":members: (.*)", options)
        for member in members[1].split(", ") if members else ():
            if callable(getattr(owner, member, None)):
                found[f"{name}.{member}"] = getattr(owner, member)
    return found


LISTED = _listed()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the file that ``tipoff calibrate`` writes."""
    unknown = [[]] * 6
    tipoff.Calibration(CONTACT, *unknown, np.zeros((0, 0)), [], {}, ["phi15"], 0.0).save(
        tmp_path / "calibration.toml"
    )
    monkeypatch.chdir(tmp_path)


def test_every_name_is_on_the_page():
    assert set(tipoff.__all__) <= set(LISTED)


def _undescribed(function) -> list[str]:
    """What the docstring of a function leaves out."""
    text = inspect.getdoc(function) or ""
    signature = inspect.signature(function)
    wanted = [f"{name}: " for name in signature.parameters if name not in ("self", "cls")]
    if signature.return_annotation not in (None, "None"):
        wanted.append("Returns:")
    return [words for words in [*wanted, "Example:"] if words not in text]


@pytest.mark.parametrize("name", [name for name, it in LISTED.items() if not inspect.isclass(it)])
def test_every_parameter_and_result_is_described(name):
    assert _undescribed(LISTED[name]) == []


def test_what_is_not_described_is_found():
    """The control of the test above."""

    def odd(length: float) -> float:
        """Twice the length."""
        return 2.0 * length

    assert _undescribed(odd) == ["length: ", "Returns:", "Example:"]


def _failed(item: object, name: str) -> int:
    """How many lines of the examples of ``item`` do not print what they state; at least one line
    must be there."""
    tests = [
        test
        for test in doctest.DocTestFinder(recurse=False).find(item, name, globs={"tipoff": tipoff})
        if test.examples
    ]
    assert tests, f"{name}: no example"
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    return sum(runner.run(test).failed for test in tests)


@pytest.mark.parametrize("name", ["tipoff", *LISTED])
def test_every_example_runs(name, folder):
    assert _failed(tipoff if name == "tipoff" else LISTED[name], name) == 0


def test_a_wrong_example_fails(capsys):
    """The control of the test above."""

    def odd():
        """>>> 1 + 1
        3
        """

    assert _failed(odd, "odd") == 1
