"""X19: a measured thrust curve that cannot be used is refused, every fault named."""

import pytest

from tests.scenes.support import refused, small, write
from tipoff.formats import csv_file
from tipoff.scenes import SceneError, load, parse

pytestmark = pytest.mark.case("X19")

CURVES = {
    "unsorted": ("time_s,force_N\n0,0\n2,5\n1,0\n", "increasing order (line 4)"),
    "one time": ("time_s,force_N\n0,0\n0,5\n", "at least two different times"),
    "one time thrice": ("time_s,force_N\n0,0\n1,5\n1,6\n1,7\n2,0\n", "at most two rows"),
    "one row": ("time_s,force_N\n0,0\n", "at least two different times"),
    "no rows": ("time_s,force_N\n", "at least two different times"),
    "negative times": ("time_s,force_N\n-1,0\n1,5\n", "not negative"),
    "nan": ("time_s,force_N\n0,nan\n1,5\n", "finite"),
    "nan time": ("time_s,force_N\n0,1\nnan,5\n2,1\n", "finite"),
    "text": ("time_s,force_N\n0,a\n1,5\n", "finite number"),
    "one column": ("time_s,force_N\n0\n1\n", "two numbers"),
    "three columns": ("time_s,force_N\n0,1,2\n1,5,2\n", "two numbers"),
    "no header": ("0,1\n1,5\n", "header"),
    "empty": ("", "header"),
    "wrong units": ("time_kg,force_N\n0,1\n1,5\n", "header"),
}


@pytest.mark.parametrize("name", CURVES)
def test_thrust_curves(tmp_path, name):
    text, expected = CURVES[name]
    path = write(tmp_path, "curve.csv", text)
    (fault,) = refused(small(thrust={"kind": "measured", "file": str(path)}))
    assert fault.key == "thrust.file"
    assert expected in fault.expected


def test_every_fault_of_a_curve_is_named(tmp_path):
    path = write(tmp_path, "curve.csv", "time_s,force_N\n1,inf\n-1,5\n")
    (fault,) = refused(small(thrust={"kind": "measured", "file": str(path)}))
    assert all(word in fault.expected for word in ("finite", "not negative", "increasing"))


def test_curve_files_that_are_no_text(tmp_path):
    (tmp_path / "curve.csv").write_bytes(b"\xff\xfe\x00")
    for file in (tmp_path / "curve.csv", tmp_path / "none.csv", tmp_path):
        (fault,) = refused(small(thrust={"kind": "measured", "file": str(file)}))
        assert fault.key == "thrust.file"
        assert "CSV file" in fault.expected


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


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"time_unit": None}, "thrust.points.*thrust.time_unit"),
        ({"time_unit": "kN", "thrust_unit": "ms"}, "thrust.points.*quantity in s"),
        ({"points": [[0, 0], [2, 1], [1, 1]]}, "thrust.points.*increasing order \\(point 3\\)"),
        ({"points": [[0, 0]]}, "thrust.points.*two different times"),
        ({"points": [[0, float("nan")], [1, 1]]}, "thrust.points.*finite"),
        ({"points": None}, "thrust.file.*a file, or points"),
        ({"motor": "M1670"}, "thrust.points.*without thrust.motor"),
        ({"ignition": "1 s"}, "thrust.points.*around thrust.ignition"),
    ],
)
def test_points_that_are_no_curve_are_refused(changes, words):
    table = {key: value for key, value in (POINTS | changes).items() if value is not None}
    with pytest.raises(SceneError, match=words):
        load("tiny").replace({"thrust": table})


def test_points_beside_a_file_are_refused(tmp_path):
    file = tmp_path / "thrust.csv"
    file.write_text("0,0\n1,1\n")
    with pytest.raises(SceneError, match="thrust.points.*one or the other"):
        load("tiny").replace({"thrust": POINTS | {"file": str(file)}})
