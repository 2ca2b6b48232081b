"""What the source of a test says: its cases, its controls, and which names are answers, not results.

A control is named in a comment or docstring by a sentence that begins with "Control:". The asserts
below such a comment, up to the next comment, belong to the control.
"""

import ast
import builtins
import io
import os
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_CONTROL = re.compile(r"\b[Cc]ontrols?[:.](?:\s+|$)")
_PLAIN = {*dir(builtins), "math", "np", "pytest", "close"}


@dataclass(frozen=True)
class Test:
    """A test function: its ``file`` below the repository, ``name``, ``cases`` and ``controls`` in
    words; ``answers`` are the names that hold inputs and closed forms alone."""

    __test__ = False

    file: str
    name: str
    cases: tuple[str, ...]
    controls: tuple[str, ...]
    control_lines: frozenset[int]
    answers: frozenset[str]
    statements: tuple[ast.stmt, ...]

    def is_control(self, line: int) -> bool:
        """Whether the assert on ``line`` belongs to a control."""
        return line in self.control_lines

    def compares_answers_alone(self, line: int) -> bool:
        """Whether the statement on ``line`` holds no name of a result: a closed form beside its
        tabulated value."""
        inside = [node for node in self.statements if node.lineno <= line <= node.end_lineno]
        if not inside:
            return False
        return _names(min(inside, key=lambda node: node.end_lineno - node.lineno)) <= (
            self.answers | _PLAIN
        )


@cache
def tests(path: Path) -> dict[str, Test]:
    """The tests of a file that are marked with a case, by their names."""
    text = path.read_text()
    tree = ast.parse(text)
    of_module = [
        mark
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark"
        for mark in _cases(node.value)
    ]
    comments = _comments(text)
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test"):
            cases = of_module + [case for mark in node.decorator_list for case in _cases(mark)]
            if cases:
                found[node.name] = _read(path, node, cases, comments, _answers(tree, node))
    return found


def all_tests() -> Iterator[Test]:
    """Every test of the repository that is marked with a case."""
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        yield from tests(path).values()


def _cases(node: ast.AST) -> list[str]:
    return re.findall(r"pytest\.mark\.case\('(\w+)'\)", ast.unparse(node))


def _comments(text: str) -> list[tuple[int, int, str]]:
    """Blocks of comments: first line, last line, words. A comment behind code is a block of one
    line with its own code."""
    blocks: list[tuple[int, int, str]] = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type != tokenize.COMMENT:
            continue
        line, words = token.start[0], token.string.lstrip("# ")
        alone = token.line.strip().startswith("#")
        if alone and blocks and blocks[-1][1] == line - 1 and blocks[-1][0] > 0:
            blocks[-1] = (blocks[-1][0], line, f"{blocks[-1][2]} {words}")
        else:
            blocks.append((line if alone else -line, line, words))
    return blocks


def _read(path, node, cases, comments, answers) -> Test:
    within = [block for block in comments if node.lineno <= abs(block[0]) <= node.end_lineno]
    lines: set[int] = set()
    controls = []
    for number, (first, last, words) in enumerate(within):
        if not re.match(r"[Cc]ontrols?\b", words):
            continue
        controls.append(_after_control(words))
        if first < 0:
            lines.add(last)
            continue
        after = [block[0] for block in within[number + 1 :] if block[0] > 0]
        lines.update(range(last + 1, after[0] if after else node.end_lineno + 1))
    said = " ".join((ast.get_docstring(node) or "").split())
    if match := _CONTROL.search(said):
        controls.append(_after_control(said[match.start() :]) or _spoken(node.name))
        if match.start() == 0:
            lines.update(range(node.lineno, node.end_lineno + 1))
    return Test(
        file=os.path.relpath(path, ROOT),
        name=node.name,
        cases=tuple(dict.fromkeys(cases)),
        controls=tuple(_sentence(words) for words in controls if words),
        control_lines=frozenset(lines),
        answers=frozenset(answers),
        statements=tuple(child for child in ast.walk(node) if isinstance(child, ast.stmt)),
    )


def _after_control(words: str) -> str:
    return re.sub(r"^[Cc]ontrols?\s*[:.]?\s*", "", words).strip()


def _spoken(name: str) -> str:
    return name.removeprefix("test_").replace("_", " ")


def _sentence(words: str) -> str:
    code = set(words.split()[0]) & set("()_.")
    first = words[0] if code else words[0].upper()
    return first + words[1:].rstrip(".") + "."


def _names(node: ast.AST) -> set[str]:
    """Names that are read, without the variables of comprehensions."""
    found = [child for child in ast.walk(node) if isinstance(child, ast.Name)]
    return {name.id for name in found if isinstance(name.ctx, ast.Load)} - {
        name.id for name in found if isinstance(name.ctx, ast.Store)
    }


def _targets(node: ast.AST) -> set[str]:
    return {child.id for child in ast.walk(node) if isinstance(child, ast.Name)}


def _answers(tree: ast.Module, function: ast.FunctionDef) -> set[str]:
    """Modules of closed forms, constants, arguments of the test, and what is computed from these
    alone. A variable that is filled later, such as a list, is none."""
    known = {argument.arg for argument in function.args.args}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            closed = (node.module or "").startswith("tests.exact")
            names = {alias.asname or alias.name for alias in node.names}
            known |= {name for name in names if closed or name.isupper()}
    filled = _filled(function)
    assignments = [
        (_targets(target) - filled, node.value)
        for scope in (tree.body, list(ast.walk(function)))
        for node in scope
        if isinstance(node, ast.Assign)
        for target in node.targets
    ]
    while True:
        new = {
            name
            for targets, value in assignments
            if _names(value) <= known | _PLAIN
            for name in targets
            if name.isupper() or _names(value) - _PLAIN
        } - known
        if not new:
            return known
        known |= new


def _filled(function: ast.FunctionDef) -> set[str]:
    """Variables that change after their first value: by an operator, an index or a method."""
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.AugAssign):
            found |= _targets(node.target)
        elif isinstance(node, ast.Assign):
            for target in node.targets:
                found |= _targets(target) if isinstance(target, ast.Subscript) else set()
        elif isinstance(node, ast.Attribute) and node.attr in ("append", "extend", "update"):
            found |= _targets(node.value)
    return found
