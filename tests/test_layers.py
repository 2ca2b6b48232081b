"""The rules of the house that a machine can check: who may import whom, how long a file may be,
what a kernel may hold.

Imports are checked twice. A fresh interpreter sees what a package really pulls in, also through
others; the sources show an import that hides inside a function.
"""

import ast
import functools
import importlib
import statistics
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from tipoff import sources as digests

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = (
    *("kernels", "mechanics", "formats", "scenes", "results", "comparison", "meshes"),
    *("highfi", "lowfi"),
    *("calibration", "workspace", "studies"),
)
# a kernel, a law and an estimate need no parser of input
_BELOW_SCENES = {"pydantic", "pint", "gmsh", "matplotlib"}
FORBIDDEN = {
    "kernels": {*PACKAGES[1:], *_BELOW_SCENES},
    "mechanics": {*PACKAGES[2:], *_BELOW_SCENES},
    # what a file says is the same whatever it is used for
    "formats": {*PACKAGES, "pydantic", "gmsh", "matplotlib"} - {"formats"},
    "scenes": {*PACKAGES[4:], "gmsh", "matplotlib"},
    "results": {*PACKAGES[5:], "gmsh", "matplotlib"},
    "comparison": {*PACKAGES[6:], "gmsh", "matplotlib"},
    "meshes": set(PACKAGES) - {"meshes"},
    "highfi": {"lowfi", "comparison", *PACKAGES[9:]},
    "lowfi": {"highfi", "meshes", "comparison", *PACKAGES[9:], "skfem", "gmsh"},
    "calibration": {*PACKAGES[10:]},
    "workspace": {"studies"},
}
SERIALISERS = {"pickle", "cPickle", "dill", "cloudpickle", "joblib", "marshal", "shelve"}
COMPILERS = {"njit", "jit", "vectorize", "guvectorize", "cfunc", "stencil"}
# Libraries that every layer may load are loaded once; each package is loaded in a process of its own.
IMPORT_EVERYTHING = """
import importlib, os, pkgutil, sys
import numba, scipy.optimize, scipy.sparse.linalg, xarray
for name in sys.argv[1:]:
    child = os.fork()
    if child == 0:
        package = importlib.import_module(name)
        for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
        print(*sorted({part(name) for name in sys.modules}), flush=True)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0, name
""".replace("part(name)", "'.'.join(name.split('.')[: 1 + name.startswith('tipoff.')])")


def sources(*folders: str) -> list[Path]:
    """Every Python file below the folders of the repository."""
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def product() -> list[Path]:
    """Every Python file of the package; the links in ``tipoff`` are followed once."""
    return [path for package in (*PACKAGES, "") for path in _below(package)]


def _below(package: str) -> list[Path]:
    folder = ROOT / "tipoff" / package
    return sorted(folder.rglob("*.py") if package else folder.glob("*.py"))


def test_an_installed_package_holds_every_module_and_data_file():
    """The project is used from its folder here, where nothing is missing; a wheel holds what is
    listed and no more."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    assert settings["packages"]["find"]["include"] == ["tipoff*"]
    assert all((path.parent / "__init__.py").is_file() for path in product())
    listed = {
        path
        for package, patterns in settings["package-data"].items()
        for pattern in patterns
        for path in (ROOT / package.replace(".", "/")).glob(pattern)
    }
    data = {
        path
        for package in PACKAGES
        for path in (ROOT / "tipoff" / package).rglob("*.*")
        if path.suffix in (".toml", ".csv", ".msh", ".json", ".txt")
        and "__pycache__" not in path.parts
    }
    assert listed - data == {
        ROOT / "tipoff" / "py.typed"
    }  # its types are for the users' checkers too
    assert data <= listed


def imported(tree: ast.AST) -> set[str]:
    """Packages that the source imports, wherever the statement stands: ``numpy``, and those of the
    project as ``tipoff.scenes``."""
    names = set()
    for node in _nodes(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__"):
            names |= {
                argument.value for argument in node.args if isinstance(argument, ast.Constant)
            }
    return {
        ".".join(name.split(".")[: 1 + name.startswith("tipoff.")])
        for name in names
        if isinstance(name, str)
    }


@functools.cache
def _nodes(tree: ast.AST) -> list[ast.AST]:
    """The nodes that a rule looks at: a source has many times as many others."""
    kinds = (ast.Import, ast.ImportFrom, ast.Call, ast.keyword, ast.Attribute, ast.FunctionDef)
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


def breaches(tree: ast.AST) -> list[str]:
    """What a source may not hold: fast maths, code from data, compilation outside `kernels.jit`,
    output in a kernel."""
    found = [f"imports {name}" for name in sorted(imported(tree) & SERIALISERS)]
    for node in _nodes(tree):
        if (
            isinstance(node, ast.keyword)
            and node.arg in ("fastmath", "allow_pickle")
            and not _is_false(node.value)
        ):
            found.append(f"{node.arg} on line {node.value.lineno}")
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("eval", "exec")
        ):
            found.append(f"{node.func.id} on line {node.lineno}")
        elif isinstance(node, ast.ImportFrom) and node.module == "numba":
            found += [
                f"numba.{alias.name} on line {node.lineno}"
                for alias in node.names
                if alias.name in COMPILERS
            ]
        elif (
            isinstance(node, ast.Attribute)
            and node.attr in COMPILERS
            and getattr(node.value, "id", "") in ("numba", "nb")
        ):
            found.append(f"numba.{node.attr} on line {node.lineno}")
        elif isinstance(node, ast.FunctionDef) and _is_kernel(node):
            inner = [inside for inside in ast.walk(node) if isinstance(inside, ast.Call)]
            found += [
                f"{_called(call)} in kernel {node.name}"
                for call in inner
                if _called(call) in ("print", "open")
            ]
    return found


def _called(call: ast.Call) -> str:
    return getattr(call.func, "id", getattr(call.func, "attr", ""))


def _is_false(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and value.value is False


def _is_kernel(function: ast.FunctionDef) -> bool:
    plain = [
        decorator.func if isinstance(decorator, ast.Call) else decorator
        for decorator in function.decorator_list
    ]
    names = [getattr(name, "id", getattr(name, "attr", "")) for name in plain]
    return any("jit" in name or name in ("kernel", "inlined") for name in names)


@functools.cache
def _parsed(path: Path) -> ast.AST:
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def forbidden(package: str) -> set[str]:
    """What a package may not load, as ``imported`` names it."""
    return {f"tipoff.{name}" if name in PACKAGES else name for name in FORBIDDEN[package]}


@pytest.fixture(scope="module")
def loaded():
    """Names of all modules of a process that loads a package alone, of every package."""
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_EVERYTHING, *(f"tipoff.{name}" for name in FORBIDDEN)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return {name: set(line.split()) for name, line in zip(FORBIDDEN, done.stdout.splitlines())}


@pytest.mark.parametrize("package", FORBIDDEN)
def test_fresh_interpreter_loads_no_higher_layer(package, loaded):
    names = loaded[package]
    assert f"tipoff.{package}" in names
    assert not names & forbidden(package)


@pytest.mark.parametrize("package", FORBIDDEN)
def test_sources_name_no_higher_layer(package):
    paths = _below(package)
    assert paths
    wrong = {
        str(path.relative_to(ROOT)): found
        for path in paths
        if (found := imported(_parsed(path)) & forbidden(package))
    }
    assert not wrong


def test_the_python_interface_needs_no_study():
    used = digests.closure("tipoff", "tipoff.front")
    assert "tipoff.workspace.run" in used
    assert [name for name in used if name.startswith("tipoff.studies")] == []


def test_no_module_has_two_names():
    """The folders at the top are parts of the package, and are imported by that name alone."""
    for path in [*product(), *sources("tests", "validation")]:
        assert not imported(_parsed(path)) & {"highfi", "lowfi", "meshes", "calibrate"}, path


def test_no_imports_in_a_circle():
    graph = {name: digests.used_by(name) for name in digests.closure(*map(_name, product()))}
    # a package's own file hands on names of its modules, and no module of it needs them
    circles = [circle for circle in _components(graph) if len(circle) > 1]
    assert circles == []


def test_types_are_imported_in_no_circle():
    """Also where an import is for the type checker alone. A class may have methods that show it as
    text, whose functions lie in a file of their own and name the class."""
    files = {_name(path): path for path in product()}
    graph = {
        name: {found for found in map(_found_in(files), _named(_parsed(path))) if found} - {name}
        for name, path in files.items()
    }
    shown = [
        ["hand_calculation", "shown", "trajectory", "unfinished"],
        ["scene", "shown"],
    ]
    circles = [circle for circle in _components(graph) if len(circle) > 1]
    assert sorted([name.split(".")[-1] for name in circle] for circle in circles) == shown


def _named(tree: ast.AST) -> set[str]:
    """Dotted names of all imports."""
    return {
        f"{node.module}.{alias.name}"
        for node in _nodes(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def _found_in(files: dict[str, Path]) -> Callable[[str], str | None]:
    """The module that a dotted name is, or is found in."""
    return lambda name: next(
        (module for module in (name, name.rpartition(".")[0]) if module in files), None
    )


def _name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def _components(graph: dict[str, set[str]]) -> list[list[str]]:
    """Strongly connected components."""
    names = sorted(graph)
    place = {name: number for number, name in enumerate(names)}
    edges = np.zeros((len(names), len(names)), dtype=bool)
    for name, others in graph.items():
        edges[place[name], [place[other] for other in others]] = True
    count, label = connected_components(csr_array(edges), connection="strong")
    return [[names[at] for at in np.flatnonzero(label == part)] for part in range(count)]


@pytest.mark.parametrize(
    "package", ["formats", "highfi", "lowfi", "mechanics", "scenes", "studies"]
)
def test_no_folder_imports_back(package):
    """Folders of a package have an order: none needs one that needs it."""
    graph: dict[str, set[str]] = {}
    for path in _below(package):
        own = _folder(_name(path))
        used = {name for name in digests.used_by(_name(path)) if f"tipoff.{package}." in name}
        graph.setdefault(own, set()).update(map(_folder, used))
    assert any(others - {name} for name, others in graph.items())
    assert [circle for circle in _components(graph) if len(circle) > 1] == []


def _folder(module: str) -> str:
    """The folder of a module of a package, or the module that lies in none."""
    return module.split(".")[2] if module.count(".") > 1 else ""


@pytest.mark.parametrize(
    ("graph", "circles"),
    [
        ({"a": {"b"}, "b": {"a"}, "c": {"a"}}, [["a", "b"]]),
        ({"a": {"b"}, "b": {"c"}, "c": set()}, []),
    ],
)
def test_a_circle_is_found(graph, circles):
    """Control."""
    assert [circle for circle in _components(graph) if len(circle) > 1] == circles


def test_doctor_needs_only_the_standard_library():
    """-S hides every installed package, as on a machine where the install failed: then the doctor
    must still speak."""
    run = subprocess.run(
        [sys.executable, "-S", "-m", "tipoff.studies.doctor"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert run.returncode == 1
    assert "Traceback" not in run.stderr
    assert "numpy does not load" in run.stderr


def test_commands_of_the_tests_load():
    """No test imports them, so a name that is gone would be found by nobody."""
    for name in ("digests", "loops", "warm"):
        importlib.import_module(f"tests.{name}")


def test_files_are_short():
    lengths = {
        str(path.relative_to(ROOT)): len(path.read_text().splitlines())
        for path in [*product(), *sources("tests", "validation")]
    }
    assert {name: size for name, size in lengths.items() if size > 400} == {}
    assert statistics.median(lengths.values()) < 150


def test_sources_keep_the_house_rules():
    jit = ROOT / "tipoff" / "kernels" / "jit.py"
    paths = [path for path in [*product(), *sources("tests", "validation")] if path != jit]
    wrong = {
        str(path.relative_to(ROOT)): found for path in paths if (found := breaches(_parsed(path)))
    }
    assert wrong == {}


@pytest.mark.parametrize(
    "source",
    [
        "import pickle",
        "def late():\n    from dill import dumps",
        "numpy.load(path, allow_pickle=True)",
        "njit(fastmath=True)",
        "njit(fastmath={'nnan'})",
        "eval(text)",
        "from numba import njit",
        "@numba.njit(cache=True)\ndef step(x):\n    return x",
        "@njit\ndef step(x):\n    print(x)",
        "@kernel\ndef step(x):\n    print(x)",
        "@inlined\ndef step(x):\n    open(x)",
    ],
)
def test_every_house_rule_can_fail(source):
    """Control: each rule finds the breach it is there for."""
    assert breaches(ast.parse(source))


@pytest.mark.parametrize(
    "source",
    [
        "def late():\n    import tipoff.lowfi.step",
        "from tipoff.lowfi import run",
        "from tipoff import lowfi",
        "importlib.import_module('tipoff.lowfi.run')",
    ],
)
def test_import_check_sees_hidden_imports(source):
    assert "tipoff.lowfi" in imported(ast.parse(source))
