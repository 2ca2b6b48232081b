"""The package as a user gets it: a wheel in an environment of its own, away from the repository."""

import re
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
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


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Built from a copy, for setuptools leaves its work beside what it packs."""
    folder = tmp_path_factory.mktemp("wheel")
    leave = shutil.ignore_patterns("__pycache__")
    for name in ("tipoff", "highfi", "lowfi", "meshes", "calibrate"):
        shutil.copytree(ROOT / name, folder / "copy" / name, symlinks=True, ignore=leave)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder / "copy")
    _run(
        *(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"),
        *("--wheel-dir", folder, folder / "copy"),
    )
    (found,) = folder.glob("*.whl")
    return found


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
    for held in ("highfi/run.py", "lowfi/run.py", "calibration/run.py", "meshes/l_rail.py"):
        assert f"tipoff/{held}" in names
    assert "tipoff/scenes/catalog/reference.toml" in names


def test_the_tour_of_the_readme_runs_on_the_wheel(python, tmp_path):
    """On the small scene, which has the same conditions."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (tour,) = re.findall(r"```python\n(import tipoff\n.*?)```", text, re.DOTALL)
    assert tour.count('"reference"') == 1
    said = _run(
        *(python, "-c", tour.replace('"reference"', '"tiny"') + LOADED),
        cwd=tmp_path,
        env={"PATH": "", "HOME": str(Path.home()), "MPLBACKEND": "Agg"},
    )
    assert Path(said.split("\n")[-2]).is_relative_to(python.parents[1])


def test_the_command_runs_on_the_wheel(python, tmp_path):
    said = _run(python, "-m", "tipoff", "scenes", cwd=tmp_path)
    assert "reference" in said and "conditions" in said
