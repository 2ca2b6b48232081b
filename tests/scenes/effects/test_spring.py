"""Spring pushers of a scene: their numbers and their tables."""

import math

import numpy as np
import pytest

from tests.scenes.support import small, write
from tipoff.faults import SceneError
from tipoff.formats.push_table import read_push
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.laws.pushers import energy_given_up
from tipoff.scenes import launch, parse, scene_model
from tipoff.scenes.variation import Variations

SPRING = {"kind": "spring", "preload": "100 N", "rate": "2 N/mm", "stroke": "40 mm"}
TABLE = "travel [mm],force [N]\n0,100\n10,90\n40,20\n"
PAIR = {
    "kind": "springs",
    "springs": [
        {"preload": "100 N", "rate": "2 N/mm", "stroke": "40 mm", "y": "30 mm"},
        {"preload": "110 N", "rate": "2 N/mm", "stroke": "50 mm", "y": "-30 mm"},
    ],
}


def spring(**changes) -> dict:
    """A scene with one spring; a change to None leaves the key out."""
    table = {key: value for key, value in (SPRING | changes).items() if value is not None}
    return small(thrust=table)


def from_file(path, **changes) -> dict:
    """A scene with one spring whose force is in a file."""
    return spring(preload=None, rate=None, stroke=None, file=str(path), **changes)


def test_a_spring_is_a_line_of_force_over_travel():
    """Energy P s - k s2 / 2, less f s of friction."""
    described = parse(spring(friction="5 N")).thrust.describe(1.0)
    assert described["peak_N"] == pytest.approx(100.0, rel=1e-14)
    assert described["energy_J"] == pytest.approx(100.0 * 0.04 - 1e3 * 0.04**2, rel=1e-14)
    assert described["friction_J"] == pytest.approx(5.0 * 0.04, rel=1e-14)


def test_a_table_has_the_units_of_its_columns(tmp_path):
    scene = parse(from_file(write(tmp_path, "push.csv", TABLE)))
    push = scene.thrust.push()
    np.testing.assert_allclose(push.travel, [0.0, 0.01, 0.04], rtol=1e-14)
    assert push.energy()[-1] == pytest.approx(0.95 + 1.65, rel=1e-14)


def test_a_scene_counts_a_table_by_its_content(tmp_path):
    """Two files with the same points give the same hash; a file that changed is a fault."""
    first, other = (write(tmp_path, name, TABLE) for name in ("a.csv", "b.csv"))
    scene = parse(from_file(first))
    assert scene.hash == parse(from_file(other)).hash
    changed = write(tmp_path, "c.csv", TABLE.replace("20", "21"))
    assert scene.hash != parse(from_file(changed)).hash
    write(tmp_path, "a.csv", TABLE.replace("20", "21"))
    with pytest.raises(SceneError, match="thrust.file"):
        scene.replace({"payload.mass": 5.0})


SPREADSHEETS = {
    "semicolons and decimal commas": "travel [mm];force [N]\n0;60\n40,5;45,25\n100;21\n",
    "tabs and a line of units": "travel\tforce\nmm\tN\n0\t60\n40.5\t45.25\n100\t21\n",
    "a comment above": "# bench 3\ntravel [mm],force [N]\n0,60\n40.5,45.25\n100,21\n",
    "UTF-16": "travel [mm];force [N]\n0;60\n40,5;45,25\n100;21\n".encode("utf-16"),
}


@pytest.mark.parametrize("name", SPREADSHEETS)
def test_tables_of_spreadsheets_of_any_country_are_read(tmp_path, name):
    """Semicolons were refused as one column with the name of both."""
    text, path = SPREADSHEETS[name], tmp_path / "push.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    travel, force = read_push(str(path))
    assert travel == pytest.approx([0.0, 0.0405, 0.1]) and force.tolist() == [60.0, 45.25, 21.0]


def test_a_variation_may_not_leave_the_rail():
    """Neither by ``replace`` nor row by row in an ensemble."""
    scene = parse(spring(rate="0 N/m"))
    for vary in (scene.replace, Variations(scene).of):
        assert vary({"thrust.stroke": 0.05}).thrust.stroke == 0.05
        with pytest.raises(SceneError, match="the way to the exit"):
            vary({"thrust.stroke": 0.5})


def test_each_number_of_each_spring_can_be_varied():
    scene = parse(small(thrust=PAIR))
    changes = {"preload": 90.0, "rate": 1e3, "stroke": 0.03, "friction": 1.0, "y": 0.01, "z": 0.02}
    row = {f"thrust.springs.1.{key}": value for key, value in changes.items()}
    for varied in (scene.replace(row), Variations(scene).of(row)):
        assert varied.thrust.springs[1].model_dump(exclude={"file"}) == changes
        assert varied.thrust.springs[0] == scene.thrust.springs[0]


def test_files_of_springs_are_relative_to_the_scene_file(tmp_path):
    write(tmp_path, "push.csv", TABLE)
    text = """extends = "tiny"
[thrust]
kind = "springs"
[[thrust.springs]]
file = "push.csv"
y = "10 mm"
"""
    from tipoff.scenes import load

    scene = load(write(tmp_path, "pushed.toml", text))
    assert scene.thrust.springs[0].push().travel[-1] == pytest.approx(0.04, rel=1e-14)


def test_the_record_is_about_the_actual_mass_centre():
    """Points move with the offsets, directions with the misalignment, and travel counts from the
    nominal place."""
    scene = parse(small(thrust=PAIR)).replace(
        {
            "thrust_offset.misalignment.axial": 0.01,
            "thrust_offset.eccentricity.axial": 0.002,
            "mass_offset.eccentricity.axial": 0.001,
        }
    )
    found = scene_model.build(scene).pushers
    np.testing.assert_allclose(found.point, [[-0.1, 0.03, 0.001], [-0.1, -0.03, 0.001]], atol=1e-15)
    np.testing.assert_allclose(
        found.direction, 2 * [[math.cos(0.01), math.sin(0.01), 0.0]], rtol=1e-14
    )
    place = np.array([[-0.1, 0.03, 0.002], [-0.1, -0.03, 0.002]])
    np.testing.assert_allclose(found.origin, (place * found.direction).sum(axis=1), rtol=1e-13)


def test_the_energy_of_a_record_is_the_integral_of_its_force():
    """Beyond the stroke it is constant; before zero travel the first line goes on."""
    found = scene_model.build(parse(small(thrust=PAIR))).pushers

    def energy(s, segment=0):
        return energy_given_up(found, np.array([segment] * 2), np.array([s] * 2))

    first, second = 100.0 * 0.02 - 1e3 * 0.02**2, 110.0 * 0.02 - 1e3 * 0.02**2
    assert energy(0.02) == pytest.approx(first + second, rel=1e-13)
    assert energy(-0.001) == pytest.approx(-0.212, rel=1e-12)
    whole = 100.0 * 0.04 - 1e3 * 0.04**2 + 110.0 * 0.05 - 1e3 * 0.05**2
    assert energy(0.07, segment=1) == pytest.approx(whole, rel=1e-13)


def test_the_estimate_over_time_is_a_quarter_of_an_oscillation():
    """Without friction: time arccos(1 - s/a) / w and speed a w sin(w t), with a = P/k, w2 = k/m."""
    scene = parse(spring())
    mass, w, a = scene.payload.mass, math.sqrt(2e3 / scene.payload.mass), 0.05
    law, end = ends.over_time(launch.of_scene(scene)), math.acos(1.0 - 0.04 / a) / w
    assert thrust_law.last(law) == pytest.approx(end, rel=1e-5)
    speed = a * w * math.sin(w * end)
    assert thrust_law.impulse(law, 1.0) / mass == pytest.approx(speed, rel=1e-5)
    assert ends.exit_speed(launch.of_scene(scene)) == pytest.approx(speed, rel=1e-4)
    assert ends.spring_impulses(launch.of_scene(scene))[0] == pytest.approx(mass * speed, rel=1e-5)
