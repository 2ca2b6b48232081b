"""The first rail as a file of CalculiX and Abaqus: loads, mounts, and the answers of CalculiX."""

import shutil
import subprocess
from itertools import pairwise

import numpy as np
import pytest

from tipoff.highfi import compliance
from tipoff.highfi.statics import mounts
from tipoff.scenes import load
from tipoff.studies.mesh import deck

SIZE = 4e-3
ON_JOINTS = load("reference").replace({"rail.fillet": None})  # all elements are bricks
HELD = load("clamped")


def blocks(text: str, card: str) -> list[tuple[str, list[list[str]]]]:
    """Options and data lines of every ``card``."""
    found: list[tuple[str, list[list[str]]]] = []
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            found.append((line, []))
        else:
            found[-1][1].append(line.split(","))
    return [(head, rows) for head, rows in found if head.split(",")[0] == card]


@pytest.fixture(params=[ON_JOINTS, HELD], ids=["on joints", "held"])
def scene(request):
    return request.param


@pytest.fixture
def written(scene, tmp_path):
    path = tmp_path / "rail.inp"
    return deck.write(scene, SIZE, path), path


def test_loads_add_up_to_the_force_under_the_pad(scene, written):
    """And to its moment: the middle of the loads is the middle of a pad."""
    _, path = written
    text = path.read_text()
    ((_, nodes),) = blocks(text, "*NODE")
    ((_, loads),) = blocks(text, "*CLOAD")
    points = {row[0]: np.array(row[1:], dtype=float) for row in nodes}
    force = np.array([float(row[2]) for row in loads])
    assert len({row[1] for row in loads}) == 1
    assert abs(force.sum()) == pytest.approx(deck.FORCE, rel=1e-12)
    middle = sum(value * points[row[0]] for row, value in zip(loads, force)) / force.sum()
    assert any(np.isclose(middle[0], pad.position[0], atol=1e-12) for pad in scene.pads)


@pytest.mark.parametrize("scene", [ON_JOINTS], ids=["on joints"])
def test_springs_add_up_to_the_joints(scene, written):
    """Against the matrix of the reference. Control: springs to the ground alone, a lumped matrix."""
    _, path = written
    text, rail = path.read_text(), compliance.rails(scene, SIZE)[0]
    exact = mounts.stiffness(rail.rail.points, rail.rail.surfaces["mount"], rail.joint).toarray()
    elements = {head.split("=")[-1]: rows for head, rows in blocks(text, "*ELEMENT")}
    found, lumped = np.zeros_like(exact), np.zeros_like(exact)
    for head, (directions, (value,)) in blocks(text, "*SPRING"):
        for _, *own in elements[head.split("=")[-1]]:
            place = [3 * int(node) + int(axis) - 4 for node, axis in zip(own, directions)]
            for into in (found, lumped) if len(own) == 1 else (found,):
                into[place, place] += float(value)
            for row, column in pairwise(place):
                found[row, column] -= float(value)
                found[column, row] -= float(value)
    assert "." in value  # a number without a point is a direction to CalculiX
    np.testing.assert_allclose(found, exact, atol=1e-8 * exact.max())
    assert np.abs(lumped - exact).max() > 0.1 * exact.max()


@pytest.mark.skipif(shutil.which("ccx") is None, reason="no CalculiX")
def test_calculix_has_the_same_deflection(written):
    """Of the same elements on the same mounts. Its mass is consistent and that of the reference
    lumped, so its frequencies are a little higher."""
    answers, path = written
    subprocess.run(["ccx", "rail"], cwd=path.parent, check=True, capture_output=True)
    ((_, loads),) = blocks(path.read_text(), "*CLOAD")
    printed = path.with_suffix(".dat").read_text()
    block = printed.split("displacements", 1)[1].split("\n\n")[1]
    moved = {row[0]: row[1:] for row in map(str.split, block.splitlines())}
    work = sum(float(value) * float(moved[node][int(axis) - 1]) for node, axis, value in loads)
    assert work / deck.FORCE == pytest.approx(answers.deflection, rel=1e-6)
    output = printed.split("E I G E N V A L U E   O U T P U T", 1)[1].splitlines()
    rows = [row.split() for row in output if len(row.split()) == 5]
    there = [float(row[3]) for row in rows if row[0].isdigit()][: deck.MODES]
    assert np.divide(there, answers.frequencies) == pytest.approx(1.02, abs=0.02)


def test_free_rails_have_no_file(tmp_path):
    assert deck.write(load("tiny").replace({"contact": None}), 8e-3, tmp_path / "rail.inp") is None
    assert not (tmp_path / "rail.inp").exists()
