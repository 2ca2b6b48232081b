"""A machine without the graphics libraries that gmsh is linked against: only a solid calls for
them, and says so in one line."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tipoff.meshes import generator
from tipoff.scenes.scene import CATALOG

ROOT = Path(__file__).resolve().parents[2]
SOLID = """
[rail]
geometry = "rails.step"
start = "-88 mm"
end = "132 mm"
[rail.material]
density = "2810 kg/m**3"
youngs_modulus = "72 GPa"
poisson_ratio = 0.33
[[rail.surfaces.contact_y]]
low = ["-88 mm", "80 mm", "80 mm"]
high = ["132 mm", "105 mm", "105 mm"]
[[rail.surfaces.mount]]
low = ["-88 mm", "104 mm", "80 mm"]
high = ["132 mm", "105 mm", "105 mm"]
"""
# The command ``mesh`` on two scenes, one after the other, and its exit codes.
BOTH = """
import runpy, sys
*scenes, out = sys.argv[1:]
codes = []
for scene in scenes:
    sys.argv = ["tipoff", "view", "--mesh", "--scene", scene, "--out", out]
    try:
        runpy.run_module("tipoff.studies.cli", run_name="__main__")
        codes.append(0)
    except SystemExit as end:
        codes.append(end.code or 0)
print(codes)
"""


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """Runs a module where the loader finds a library of gmsh's that is no library."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the loader of Linux is asked to fail")
    hidden = tmp_path_factory.mktemp("hidden")
    (hidden / "libGL.so.1").touch()

    def call(*arguments):
        return subprocess.run(
            [sys.executable, *map(str, arguments)],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=300,
            env=os.environ | {"LD_LIBRARY_PATH": str(hidden)},
        )

    # Control: it does not load there. Which library the loader misses first is another one where
    # none is installed.
    assert re.search(r"OSError: \S*lib\w+\.so", call("-c", "import gmsh").stderr)
    return call


def test_set_up_misses_nothing(bare):
    said = bare("-m", "tipoff.studies.doctor")
    assert said.returncode == 0 and said.stderr == "" and "everything" in said.stdout


def test_a_solid_says_what_is_missing_and_a_built_in_rail_is_meshed(bare, tmp_path):
    (tmp_path / "rails.step").write_text("ISO-10303-21;")
    scene = tmp_path / "drawn.toml"
    scene.write_text('extends = "tiny"\nname = "drawn"\n' + SOLID)
    said = bare("-c", BOTH, scene, CATALOG / "tiny.toml", tmp_path / "out")
    assert said.stdout.splitlines()[-1] == "[1, 0]" and "Traceback" not in said.stderr
    (line,) = [line for line in said.stderr.splitlines() if line.startswith("tipoff: ")]
    assert re.search(r"lacks the system library \S*lib\w+\.so", line) and line.endswith(
        generator.SYSTEM_INSTALL
    )
    assert (tmp_path / "out" / "tiny" / "mesh.json").is_file()


def test_the_documentation_asks_for_system_libraries_on_the_page_of_solids_alone():
    pages = {path.relative_to(ROOT) for path in (ROOT / "docs").rglob("*.md")} | {Path("README.md")}
    asking = {page for page in pages if "apt-get" in (ROOT / page).read_text(encoding="utf-8")}
    assert asking == {Path("docs/howto/rail_from_cad.md")}
    assert generator.SYSTEM_INSTALL in (ROOT / "docs/howto/rail_from_cad.md").read_text()
