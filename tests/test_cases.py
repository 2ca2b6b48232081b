"""The table of verification cases and the marks of tests agree."""

import ast
import re
from pathlib import Path

TESTS = Path(__file__).resolve().parent
# O52 runs the reference on nine rails; X8 adds a force to the equations before they are compiled, so
# it compiles kernels of its own
ONLY_SLOW = {"O52", "X8"}


def marked(source: str) -> dict[str, bool]:
    """Cases that the tests of a file are marked with, and whether one of them is not slow."""
    found: dict[str, bool] = {}
    tree = ast.parse(source)
    of_module = [
        ast.unparse(mark)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark"
        for mark in (node.value.elts if isinstance(node.value, ast.List) else [node.value])
    ]
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test"):
            marks = of_module + [ast.unparse(mark) for mark in node.decorator_list]
            for mark in marks:
                if case := re.fullmatch(r"pytest\.mark\.case\('(\w+)'\)", mark):
                    fast = "pytest.mark.slow" not in marks
                    found[case[1]] = found.get(case[1], False) or fast
    return found


def test_table_and_marks_agree():
    table = re.findall(r"^\| ([OX]\d+) \|", (TESTS / "CASES.md").read_text(), re.MULTILINE)
    assert len(set(table)) == len(table)
    fast: dict[str, bool] = {}
    for path in sorted(TESTS.rglob("test_*.py")):
        for case, quick in marked(path.read_text()).items():
            fast[case] = fast.get(case, False) or quick
    assert set(fast) == set(table)
    assert {case for case, quick in fast.items() if not quick} == ONLY_SLOW


def test_a_case_of_slow_tests_alone_is_seen():
    """Control."""
    slow = '@pytest.mark.slow\n@pytest.mark.case("O1")\ndef test():\n    pass\n'
    assert marked(slow) == {"O1": False}
    assert marked(slow + slow.replace("@pytest.mark.slow\n", "")) == {"O1": True}
