"""Meanings of the fields of a class: the ``#:`` comments above them in its source."""

import ast
import functools
import inspect
import textwrap

from tipoff.scenes.table import Table

MARK = "#:"


def meanings(table: type[Table]) -> dict[str, str]:
    """Text by field, those of base classes included. Raises LookupError, naming every field
    without a meaning."""
    found: dict[str, str] = {}
    for base in reversed(table.__mro__):
        if issubclass(base, Table) and base is not Table:
            found |= _own(base)
    missing = [name for name in table.model_fields if not found.get(name)]
    if missing:
        raise LookupError(
            f"{table.__module__}.{table.__qualname__}: no comment '{MARK} ...' above "
            + ", ".join(missing)
        )
    return {name: found[name] for name in table.model_fields}


@functools.cache
def _own(table: type) -> dict[str, str]:
    source = textwrap.dedent(inspect.getsource(table))
    lines = [line.strip() for line in source.splitlines()]
    (tree,) = ast.parse(source).body
    assert isinstance(tree, ast.ClassDef)
    found = {}
    for node in tree.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            first = node.lineno - 1
            while first and lines[first - 1].startswith(MARK):
                first -= 1
            above = lines[first : node.lineno - 1]
            found[node.target.id] = " ".join(line.removeprefix(MARK).strip() for line in above)
    return found
