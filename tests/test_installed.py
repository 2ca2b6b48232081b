"""The package as a user gets it: a wheel in an environment of its own, away from the repository."""

import ast
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import venv
import zipfile
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tests.docs import pages

ROOT = Path(__file__).resolve().parent.parent
# Pages whose programs run on the wheel, with the scene that each names.
PAGES = {"README.md": "reference", "docs/tutorials/surrogate_and_reference.md": "tiny"}
MARK = "-----"
# The command ``tipoff scenes``, with marks before and after what it prints.
SCENES = f"""
import runpy, sys
print({MARK!r})
sys.argv = ["tipoff", "scenes"]
try:
    runpy.run_module("tipoff", run_name="__main__", alter_sys=True)
except SystemExit as end:
    assert not end.code, end.code
print({MARK!r})
"""
# Every module by its file: one that was loaded under two names stands there twice.
LOADED = """
import os, sys
files = [os.path.realpath(item.__file__) for item in list(sys.modules.values())
         if getattr(item, "__file__", None)]
own = [file for file in files if os.sep + "tipoff" + os.sep in file]
assert len(own) == len(set(own)) > 50, len(own)
assert not {"highfi", "lowfi", "calibrate", "meshes", "scenes", "studies"} & set(sys.modules)
print(sys.modules["tipoff"].__file__)
"""


# Libraries that a dependency brings by its own metadata, and those of extras, without which a
# command says what to install.
BROUGHT = {"llvmlite": "numba", "PIL": "matplotlib", "pydantic_core": "pydantic"}
OPTIONAL = {"distributed", "exudyn", "mujoco", "pyvista"}


# One process for both, each of a copy, for setuptools leaves its work beside what it packs.
BUILD = """
import os, sys
from setuptools import build_meta
folder, *copies = sys.argv[1:]
for copy, build in zip(copies, (build_meta.build_wheel, build_meta.build_sdist)):
    os.chdir(copy)
    build(folder)
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder with a wheel and a source distribution."""
    folder = tmp_path_factory.mktemp("built")
    copies = [_copy(folder / name) for name in ("for wheel", "for source")]
    _run(sys.executable, "-c", BUILD, folder, *copies)
    return folder


@pytest.fixture(scope="module")
def wheel(built):
    (found,) = built.glob("*.whl")
    return found


def _copy(folder: Path) -> Path:
    leave = shutil.ignore_patterns("__pycache__")
    for name in ("tipoff", "highfi", "lowfi", "meshes", "calibrate", "docs"):
        shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=leave)
    for name in ("pyproject.toml", "MANIFEST.in", "README.md", "LICENSE", "CITATION.cff"):
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture(scope="module")
def python(wheel, tmp_path_factory):
    """An environment that holds the wheel, and finds the libraries where this one has them."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bin" / "python"


def _run(*command, **options) -> str:
    done = subprocess.run(
        [str(item) for item in command], capture_output=True, text=True, timeout=540, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_wheel_puts_one_name_into_an_environment(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {"tipoff"}
    for held in (
        "highfi/simulation.py",
        "lowfi/simulation.py",
        "calibration/run.py",
        "meshes/l_rail.py",
    ):
        assert f"tipoff/{held}" in names
    assert "tipoff/scenes/catalog/reference.toml" in names


def _imported() -> set[str]:
    """Names of the libraries that any module of the package imports, at its top or later."""
    trees = [ast.parse(path.read_text()) for path in _modules()]
    nodes = [node for tree in trees for node in _statements(tree)]
    names = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
    names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom) and not node.level}
    return {name.partition(".")[0] for name in names} - set(sys.stdlib_module_names) - {"tipoff"}


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Every statement of a module, those in functions and branches too: imports are statements."""
    for field in ("body", "orelse", "finalbody", "handlers", "cases"):
        for inner in getattr(node, field, ()):
            yield inner
            yield from _statements(inner)


def _modules() -> list[Path]:
    folders = [ROOT / name for name in ("tipoff", "highfi", "lowfi", "meshes", "calibrate")]
    return [path for folder in folders for path in folder.rglob("*.py")]


def test_every_library_of_the_package_is_a_dependency():
    """zarr and SALib were extras, and a wheel without them failed in its main commands."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    installed = {re.match(r"[\w-]+", line)[0].lower() for line in declared}
    owners = packages_distributions()
    imported = _imported()
    assert imported >= {"zarr", "SALib", "numba", "pyvista"}  # those of functions too
    missing = {
        name
        for name in imported - OPTIONAL
        if not {owner.lower() for owner in owners.get(BROUGHT.get(name, name), ())} & installed
    }
    assert not missing


def test_the_citation_is_of_this_version():
    metadata = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {metadata['version']}\n" in cited
    assert f"\nlicense: {metadata['license']}\n" in cited
    assert all(author["name"] in cited for author in metadata["authors"])


def test_a_source_distribution_gives_the_same_wheel(built, wheel, tmp_path):
    (source,) = built.glob("*.tar.gz")
    with tarfile.open(source) as archive:
        held = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    assert {"CITATION.cff", "docs/index.md", "docs/ejection.png"} <= held
    _run(
        *(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"),
        *("--wheel-dir", tmp_path, source),
    )
    (again,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(again) as one, zipfile.ZipFile(wheel) as other:
        assert sorted(one.namelist()) == sorted(other.namelist())


@pytest.fixture(scope="module")
def said(python, tmp_path_factory):
    """What one process prints on the wheel: the Python of pages, the command that lists scenes, and
    the place of the package. The pages are on the small scene, which has the same conditions, and with
    fewer cases."""
    programs = []
    for page, scene in PAGES.items():
        programs.append("\n".join(pages.of_language(page, "python")) + "\n")
        assert programs[-1].startswith("import tipoff\n")
        assert programs[-1].count(f'"{scene}"') == 1
    text = _run(
        *(python, "-c", "".join(map(pages.smaller, programs)) + SCENES + LOADED),
        cwd=tmp_path_factory.mktemp("elsewhere"),
        env={"PATH": "", "HOME": str(Path.home()), "MPLBACKEND": "Agg"},
    )
    return text.split(MARK)


def test_the_python_of_pages_runs_on_the_wheel(python, said):
    of_pages, _, place = said
    assert "time_limit" in of_pages or "exited" in of_pages
    assert Path(place.strip()).is_relative_to(python.parents[1])


def test_the_command_runs_on_the_wheel(said):
    _, listed, _ = said
    assert "reference" in listed and "conditions" in listed


def test_a_scene_is_run_on_the_wheel(python, tmp_path):
    """One that is written by the user, and files of results beside it."""
    (tmp_path / "mine.toml").write_text(
        'extends = "tiny"\nname = "mine"\n[payload]\nmass = "8 kg"\n'
    )
    said = _run(
        *(python, "-m", "tipoff", "run", "--scene", "mine.toml", "--condition", "phi15"),
        *("--model", "springs"),
        cwd=tmp_path,
    )
    assert said.startswith("mine / phi15, model springs, with the scene's constants: exited")
    assert list((tmp_path / "out" / "mine" / "lowfi").glob("phi15-*.nc"))


def test_make_targets_are_phony():
    """Folders are named like targets; without .PHONY `make calibrate` would find the folder and do
    nothing."""
    text = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([a-z][a-z-]*):", text, re.MULTILINE))
    phony = set(re.search(r"^\.PHONY: (.*)$", text, re.MULTILINE).group(1).split())
    assert {"report", "test", "calibrate"} <= targets
    assert targets == phony


def test_lock_holds_every_dependency():
    """The project is installed with --no-deps, so what the lock forgets is missing in a fresh
    clone."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    asked = project["dependencies"] + extras["test"] + extras["cluster"]
    pinned = set(
        re.findall(r"^([A-Za-z0-9_.-]+)==", (ROOT / "requirements.lock").read_text(), re.MULTILINE)
    )
    normal = {re.sub(r"[-_.]+", "-", name).lower() for name in pinned}
    assert {re.match(r"[A-Za-z0-9_.-]+", name).group().lower() for name in asked} <= normal
    # Each of the other extras has a lock of its own, beside the first one.
    for extra in ("view", "check", "docs", "examples", "peers"):
        lock = (ROOT / f"requirements-{extra}.lock").read_text()
        added = set(re.findall(r"^([A-Za-z0-9_.-]+)==", lock, re.MULTILINE))
        wanted = {re.match(r"[A-Za-z0-9_.-]+", name).group() for name in extras[extra]}
        assert {name.replace("-", "_") for name in wanted} <= {
            name.replace("-", "_") for name in added
        }
        assert not added & pinned
