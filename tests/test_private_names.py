"""Tests use the public names of the product alone, so that they survive a change of its inside."""

import ast
import re
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parent
NAMED_TUPLES = {"_asdict", "_fields", "_make", "_replace"}  # of their public interface


def private_names(source: str) -> list[str]:
    """Private names of other modules and objects that a source reads, imports or replaces."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) not in ("self", "cls"):
            names = [node.attr]
        elif isinstance(node, ast.ImportFrom):
            names = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
        elif isinstance(node, ast.Call) and re.search(
            r"(get|set|del)attr$", ast.unparse(node.func)
        ):
            texts = [part.value for part in node.args if isinstance(part, ast.Constant)]
            names = [name for text in texts if isinstance(text, str) for name in text.split(".")]
        else:
            continue
        found += [
            f"{name} on line {node.lineno}"
            for name in names
            if re.match(r"_[^_]", name) and name not in NAMED_TUPLES
        ]
    return found


def test_no_test_uses_a_private_name():
    """What a test needs is made public, with a docstring."""
    wrong = {
        str(path.relative_to(TESTS)): found
        for path in sorted(TESTS.rglob("*.py"))
        if (found := private_names(path.read_text(encoding="utf-8")))
    }
    assert wrong == {}


@pytest.mark.parametrize(
    "source",
    [
        "run._advance(3)",
        "from tipoff.meshes.l_rail import _depths",
        "monkeypatch.setattr(stage, '_fitted', None)",
        "monkeypatch.setattr('tipoff.studies.view.stage._key', None)",
        "getattr(loop, '_kick')",
    ],
)
def test_a_private_name_is_found(source):
    """Control."""
    assert private_names(source)


@pytest.mark.parametrize("source", ["self._rows", "row._replace(a=1)", "module.__name__"])
def test_other_names_are_left_alone(source):
    """Control."""
    assert not private_names(source)
