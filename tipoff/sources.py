"""Digests of code: the code on which a module depends, without docstrings and comments.

A module depends on itself and on every module of the project that it imports, at its top or inside
a function; their imports count too. `from package import name` depends on the module `package.name`
if it exists, else on `package`. Imports only for the type checker do not count.
"""

import ast
import contextlib
import functools
import hashlib
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from tipoff import cache
from tipoff.files import content_hash

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = "tipoff"
WITH_CODE = (PACKAGE, "tests", "validation")  # the last two also have kernels
LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "scikit-fem")  # they may change last bits
# Modules, and packages with all of their modules, that determine no number of a run: they read files to
# values, which the hash of a scene has, or make words of a scene or of a run.
READERS = (
    "tipoff.faults",
    *(f"tipoff.formats.{name}" for name in ("csv_file", "instrument_table", "sections", "thrusts")),
    *(
        f"tipoff.scenes.{name}"
        for name in (
            *(
                "faults",
                "names",
                "pads",
                "plausibility",
                "plausible_ranges",
                "provenance",
                "reading",
            ),
            *("roles", "shown", "sinking", "suggestions", "thrust_plausibility", "unchanged"),
        )
    ),
    *("tipoff.results.guides", "tipoff.results.hand_over", "tipoff.results.shown"),
)
# A module that imports this function depends on all modules of its folder.
_LISTS_A_FOLDER = "tipoff.formats.declared.declared"
# Inputs of a Source besides its file: syntax trees differ between versions of Python.
_RULES = content_hash(sys.version_info[:2], Path(__file__).read_text(encoding="utf-8"))
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def cache_folder() -> Path:
    """Folder of compiled kernels and digests of sources: ``NUMBA_CACHE_DIR`` if it is set, else
    ``tipoff`` in the user's cache folder."""
    chosen, caches = os.environ.get("NUMBA_CACHE_DIR"), os.environ.get("XDG_CACHE_HOME")
    return _folder(chosen or os.path.join(caches or os.path.expanduser("~/.cache"), PACKAGE))


_folder = functools.cache(Path)  # a call of the surrogate asks several times


class Source(NamedTuple):
    """The code and the imports of one file."""

    code: str  # hexadecimal SHA-256 of its syntax tree without docstrings
    imports: tuple[str, ...]  # dotted names, of modules or of names in modules


@functools.cache
def digest(*modules: str, without: tuple[str, ...] = ()) -> str:
    """Hexadecimal SHA-256 of the code on which ``modules`` (dotted names) depend, as ``closure``."""
    parts = [f"{name} {source(name).code}" for name in closure(*modules, without=without)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def program(*modules: str, libraries: Sequence[str] = ()) -> str:
    """Hexadecimal SHA-256 of everything that determines the numbers of ``modules`` (dotted names)
    besides their inputs: the code, and the versions of ``LIBRARIES`` and of further
    ``libraries``."""
    return content_hash(digest(*modules), [version(name) for name in (*LIBRARIES, *libraries)])


def of_runs(*modules: str, libraries: Sequence[str] = ()) -> str:
    """``program`` of modules that make runs of scenes. ``READERS`` do not count, because the hash of a
    scene has what they read."""
    code = digest(*modules, without=READERS)
    return content_hash(code, [version(name) for name in (*LIBRARIES, *libraries)])


@functools.cache  # reading the metadata takes longer than a run of the surrogate
def version(library: str) -> str:
    """Version of an installed ``library``, or ``not installed``."""
    from importlib import metadata

    try:
        return metadata.version(library)
    except metadata.PackageNotFoundError:
        return "not installed"


def closure(*modules: str, without: tuple[str, ...] = ()) -> list[str]:
    """Dotted names of ``modules`` and of all modules of the project on which they depend, in
    alphabetical order. Those in ``without``, those in packages in it, and what only they need, are left
    out. Raises
    ModuleNotFoundError for a module that the project does not have."""
    found: set[str] = set()
    left_out = tuple(f"{name}." for name in without)
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name in found or name.startswith(left_out) or f"{name}." in left_out:
            continue
        if path(name) is None:
            raise ModuleNotFoundError(f"the project has no module {name}")
        found.add(name)
        waiting += used_by(name)
    return sorted(found)


@functools.cache
def used_by(module: str) -> frozenset[str]:
    """Dotted names of the modules of the project that ``module`` imports directly, also by the list of a
    folder."""
    imports = source(module).imports
    found = {used for used in map(_module, imports) if used}
    if _LISTS_A_FOLDER in imports:
        package, file = module.rpartition(".")[0], path(module)
        assert file is not None
        found |= {f"{package}.{each.stem}" for each in file.parent.glob("[!_]*.py")} - {module}
    return frozenset(found)


@functools.cache  # digests of commands ask for each file many times
def path(module: str) -> Path | None:
    """File of a ``module`` of the project, or None."""
    if module.split(".")[0] not in WITH_CODE:
        return None
    place = ROOT.joinpath(*module.split("."))
    for file in (place.with_suffix(".py"), place / "__init__.py"):
        if file.is_file():
            return file
    return None


def _module(name: str) -> str | None:
    """The module with this dotted ``name``, or that contains it; None outside the project."""
    if path(name):
        return name
    parent = name.rpartition(".")[0]
    return parent if parent and path(parent) else None


_KEPT: cache.Cache[Source] = cache.documents(
    Source._asdict, lambda found: Source(found["code"], tuple(found["imports"]))
)


@functools.cache
def source(module: str) -> Source:
    """The source of ``module``. It is stored with the kernels, because parsing all files takes a
    second."""
    code = path(module)
    assert code is not None
    content = code.read_bytes()
    key = content_hash(_RULES, hashlib.sha256(content).hexdigest())
    kept = cache.file(cache_folder() / "sources", module, key, ".json")
    if (found := _KEPT.get(kept, key, "it is made again")) is None:
        tree = ast.parse(content)
        imports = tuple(sorted(set(_imports(tree))))
        found = Source(hashlib.sha256(_code(tree).encode()).hexdigest(), imports)
        with contextlib.suppress(OSError):
            _KEPT.put(kept, key, found)
    return found


def _code(tree: ast.Module) -> str:
    for node in ast.walk(tree):
        if isinstance(node, _DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            node.body[:1] = [] if len(node.body) > 1 else [ast.Pass()]
    return ast.dump(tree)


def _imports(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
        for other in node.orelse:
            yield from _imports(other)
        return
    if isinstance(node, ast.Import):
        yield from (part for name in node.names for part in (name.name, name.name.split(".")[0]))
    elif isinstance(node, ast.ImportFrom) and node.module:
        yield from (f"{node.module}.{name.name}" for name in node.names)
    for child in ast.iter_child_nodes(node):
        yield from _imports(child)
