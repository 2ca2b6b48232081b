"""How far a reader goes from the command line down to the first module that imports none of ours."""

import ast
import functools

from tests.test_layers import ROOT, product

LONGEST = 35  # modules


def chain(graph: dict[str, set[str]]) -> list[str]:
    """The longest chain of imports in a graph without circles."""

    @functools.cache
    def below(name: str) -> list[str]:
        return [name, *max(map(below, graph[name]), key=len, default=[])]

    return max(map(below, graph), key=len)


def at_the_top(tree: ast.Module) -> set[str]:
    """Dotted names of what a module imports when it is loaded."""
    return {
        f"{node.module}.{alias.name}"
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_no_chain_of_imports_is_long():
    """Who adds to the longest chain imports under TYPE_CHECKING what only annotations name, or moves what
    two modules need below both. Control: a longer chain is found."""
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in product()
    }
    graph = {}
    for name, path in files.items():
        imported = at_the_top(ast.parse(path.read_text(encoding="utf-8")))
        modules = {one if one in files else one.rpartition(".")[0] for one in imported}
        graph[name] = modules & files.keys() - {name}
    longest = chain(graph)
    assert len(longest) <= LONGEST, " -> ".join(longest)
    assert len(chain(graph | {"one more": {longest[0]}})) == len(longest) + 1
