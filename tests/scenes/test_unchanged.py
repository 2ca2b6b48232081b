"""A file that changes after its scene was read gives no variation with another content."""

import os

import pytest

from tests.scenes.support import small
from tipoff.scenes import SceneError, load, parse
from tipoff.scenes.variation import Variations

MASS = {"payload.mass": "9 kg"}


def written(path, force):
    path.write_text(f"time_s,force_N\n0,0\n0.004,{force}\n0.009,0\n", encoding="utf-8")
    os.utime(path, (1.0, 1.0))  # the content counts, not the time


def test_a_variation_has_the_curve_of_its_scene(tmp_path):
    """Control: the curve back in place, and a file that the variation names itself."""
    path, other = tmp_path / "curve.csv", tmp_path / "other.csv"
    written(path, 30e3)
    written(other, 40e3)
    scene = load("tiny").replace(
        {"thrust": {"kind": "measured", "file": str(path), "arm": "0.1 m"}}
    )
    written(path, 33e3)
    for change in (MASS, {"thrust.arm": 0.11}):
        with pytest.raises(SceneError, match="thrust.file.*read the scene again"):
            scene.replace(change)
    with pytest.raises(SceneError, match="thrust.file.*read the scene again"):
        Variations(scene).of({"thrust.arm": 0.11})
    assert scene.replace({"thrust.file": str(other)}).thrust.curve().force[1] == 40e3
    written(path, 30e3)
    assert scene.replace(MASS).thrust.curve().force[1] == 30e3


def test_a_variation_has_the_rail_of_its_scene(tmp_path):
    path = tmp_path / "rail.msh"
    path.write_text("first", encoding="utf-8")
    material = small()["rail"]["material"]
    rail = {"mesh": str(path), "start": "0 m", "end": "1 m", "material": material}
    scene = parse(small() | {"rail": rail})
    assert scene.replace(MASS).rail.contents() == scene.rail.contents()
    path.write_text("second", encoding="utf-8")
    with pytest.raises(SceneError, match="rail.mesh.*read the scene again"):
        scene.replace(MASS)
