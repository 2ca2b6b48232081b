"""A measured thrust curve: its file is read once, and points in the scene are one too."""

import pytest

from tests.scenes.support import small, write
from tipoff.formats import csv_file
from tipoff.scenes import load, parse


def test_the_rows_of_a_curve_are_read_once(tmp_path, monkeypatch):
    """By scene, conditions and variations; each has arrays of its own. Other content in the same
    file is read."""
    read, listed = [], csv_file.listed
    monkeypatch.setattr(csv_file, "listed", lambda *file: read.append(file) or listed(*file))
    path = write(tmp_path, "curve.csv", "time_s,force_N\n0,0\n0.004,30125\n0.009,0\n")
    scene = parse(small(thrust={"kind": "measured", "file": str(path)}))
    heavier = scene.replace({"payload.mass": "11 kg"})
    assert len(read) == 1
    scene.thrust.curve().force[1] = 0.0
    assert heavier.thrust.curve().force[1] == 30125.0
    write(tmp_path, "curve.csv", "time_s,force_N\n0,0\n0.004,30250\n0.009,0\n")
    parse(small(thrust={"kind": "measured", "file": str(path)}))
    assert len(read) == 2


POINTS = {"kind": "measured", "points": [[0, 0], [8, 1.2], [12, 5.9], [12, 3.1], [24, 0]]}
POINTS |= {"time_unit": "ms", "thrust_unit": "kN"}


def test_points_in_the_scene_are_the_curve_of_a_file(tmp_path):
    """The same scene, whichever way, also restored from its results. Other points are another scene."""
    file = tmp_path / "thrust.csv"
    file.write_text("time_s,force_N\n0,0\n0.008,1200\n0.012,5900\n0.012,3100\n0.024,0\n")
    tiny = load("tiny")
    scene = tiny.replace({"thrust": POINTS})
    assert scene.hash == tiny.replace({"thrust": {"kind": "measured", "file": str(file)}}).hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    other = scene.replace({"thrust.points": [[0, 0], [10, 1], [20, 0]]})
    assert other.thrust.requested() == pytest.approx(10.0)
