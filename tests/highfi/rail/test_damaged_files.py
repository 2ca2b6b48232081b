"""Rails given by damaged files: they are refused, and neither end this process nor take its memory."""

import resource
import subprocess
from dataclasses import replace

import meshio
import numpy as np
import pytest

from tests.highfi.support import COARSE, tiny
from tests.meshes.test_imprint import BESIDE, TOP
from tests.meshes.test_solid import drawn, drilled, scene_of
from tipoff import highfi
from tipoff.formats.meshes.memory_limit import limited
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.highfi.rail import solid_process, step_cost
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.scenes.scene import CATALOG


@pytest.fixture
def lines(tmp_path):
    """The channel of the catalogue as lines of text."""
    mesh = meshio.read(CATALOG / "channel.msh")
    meshio.gmsh.write(tmp_path / "channel.msh", mesh, "2.2", binary=False)
    return (tmp_path / "channel.msh").read_text().split("\n")


@pytest.mark.parametrize(
    "place, text, why",
    [
        (2, "2147483647 0 0 0", "no coordinates for nodes 1,"),
        (1, "999999999999", "Nodes is shorter than its counts say"),
    ],
)
def test_a_number_in_a_mesh_does_not_ask_for_all_memory(tmp_path, lines, place, text, why):
    """The number of a node, and of all nodes: gigabytes. The limit is lifted afterwards."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    lines[lines.index("$Nodes") + place] = text
    (tmp_path / "bad.msh").write_text("\n".join(lines))
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(MeshError, match=why):
        read(tmp_path / "bad.msh")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used < 2**19  # kB
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_memory_is_limited_within_the_block_alone():
    with pytest.raises(MemoryError), limited(2**28):
        np.empty(2**30, dtype=np.uint8)
    assert len(np.empty(2**30, dtype=np.uint8)) == 2**30


@pytest.fixture
def block(tmp_path):
    """A scene on a block with a hole, and the lines of its STEP file."""
    path = drawn(tmp_path / "block.step", drilled)
    scene = scene_of(path, {"contact_top": [TOP], "mount": [BESIDE]}, 0.0, 0.04)
    return scene, path, path.read_text().split("\n")


@pytest.mark.gmsh
def test_a_solid_that_ends_the_process_of_gmsh_is_refused(block):
    """A vector that others point to is missing. Control: the whole file is meshed."""
    scene, path, lines = block
    assert len(make_mesh(scene, 0.002).cells) > 0
    place = next(number for number, line in enumerate(lines) if "VECTOR('',#91,1.)" in line)
    damaged = [line for number, line in enumerate(lines) if number != place]
    other = path.with_name("damaged.step")
    other.write_text("\n".join(damaged))
    with pytest.raises(MeshError, match="cannot be used"):
        make_mesh(scene.replace({"rail.geometry": str(other)}), 0.002)


@pytest.mark.gmsh
def test_a_solid_that_keeps_gmsh_busy_without_end_is_refused(tmp_path, monkeypatch, capsys):
    """The number of a surface is no whole number. The user reads what takes so long."""
    path = drawn(tmp_path / "block.brep", lambda occ: occ.addBox(0.0, 0.0, 0.0, 40.0, 20.0, 8.0))
    text = path.read_text()
    edge = next(line for line in text.splitlines() if line.startswith("2  3 1 0 0 "))
    path.write_text(text.replace(edge, edge.replace("3 1 ", "3 1e-9 "), 1))
    monkeypatch.setattr(solid_process, "CPU_SECONDS", 8)
    scene = scene_of(path, {"contact_top": [TOP], "mount": [BESIDE]}, 0.0, 0.04)
    with pytest.raises(MeshError, match="has not meshed it after 8 s of processor time"):
        make_mesh(scene, 0.002)
    assert f"gmsh meshes {path}" in capsys.readouterr().err


@pytest.mark.gmsh
def test_an_end_by_a_signal_is_named(block, monkeypatch):
    begin, ends = subprocess.Popen, "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    monkeypatch.setattr(
        subprocess, "Popen", lambda command, **asked: begin([*command[:2], ends], **asked)
    )
    scene, *_ = block
    with pytest.raises(MeshError, match="ended with SIGSEGV"):
        make_mesh(scene, 0.008)


def test_a_run_of_hours_is_announced():
    """Under an interface stiffness of 1e22 N/m3 steps are ten thousand times as short. Control: under 1e20
    N/m3 a run takes ten minutes."""
    for stiffness, announced in (("1.8e12", False), ("1e20", False), ("1e22", True)):
        scene = tiny(contact__interface_stiffness=f"{stiffness} N/m**3")
        mesh = highfi.prepare(scene, COARSE)
        step = choose(build(scene, COARSE, mesh), scene, COARSE).dt_s
        words = step_cost.long_run(mesh, scene, step)
        assert bool(words) == announced
        assert not announced or ("steps of" in words and "on one core" in words)


def test_a_step_of_an_extrusion_takes_less():
    """Its columns have a kernel of their own. Control: the same elements with one node moved by 1 um."""
    scene = tiny()
    mesh = highfi.prepare(scene, COARSE)
    moved = mesh.points.copy()
    moved[0, 0] -= 1e-6
    step, seconds = step_cost.run_time(mesh, scene)
    other, longer = step_cost.run_time(replace(mesh, points=moved), scene)
    assert other == pytest.approx(step, rel=1e-3) and longer > 2.0 * seconds
