"""A rocket from a few numbers: its rail, its clamps, its buttons or lugs, and its motor."""

import math
from dataclasses import replace

import pytest

from tests.studies.new_scene.test_template import call
from tipoff import highfi, lowfi, scenes
from tipoff.results import unfinished
from tipoff.scenes import plausibility, provenance, uncertainty


@pytest.mark.parametrize("rail", ["1 m", "3.9 m", "11 m", "14 m"])
def test_a_rail_of_any_length_is_held_near_its_open_end(tmp_path, monkeypatch, rail):
    """Control: with 0.6 m more it is not."""
    monkeypatch.chdir(tmp_path)
    assert call("new", "own.toml", "--rocket", "--rail-length", rail).exit_code == 0
    scene = scenes.load("own.toml")
    assert plausibility.warnings(scene) == []
    file = tmp_path / "own.toml"
    file.write_text(
        file.read_text().replace(f'end = "{rail}"', f'end = "{float(rail[:-2]) + 0.6:g} m"')
    )
    assert "are not held" in str(plausibility.warnings(scenes.load("own.toml")))


def test_a_rocket_has_the_given_numbers_and_the_motor_of_the_catalogue_beside_it(
    tmp_path, monkeypatch
):
    """In 30 lines or fewer, in words of the hardware. Without numbers the buttons are those of the scene
    ``rocket_rail`` on its rail, and the errors are about its numbers."""
    monkeypatch.chdir(tmp_path)
    asked = (
        "--mass",
        "6 kg",
        "--clearance",
        "0.3 mm",
        "--size",
        "2 m, 10 cm",
        "--rail-length",
        "3 m",
    )
    made = call("new", "own.toml", "--rocket", *asked)
    assert made.exit_code == 0, made.output
    text = (tmp_path / "own.toml").read_text()
    assert len(text.splitlines()) <= 30 and "pads]]" not in text
    scene, own = scenes.load("own.toml"), scenes.load("rocket_rail")
    assert scene.payload.mass == 6.0 and scene.payload.size == pytest.approx((2.0, 0.1, 0.1))
    assert scene.payload.inertia.yy == pytest.approx(6.0 * (0.75 * 0.1**2 + 4.0) / 12.0)
    assert scene.contact.gaps() == pytest.approx(3 * [0.3e-3])
    assert scene.rail.end - scene.rail.start == pytest.approx(3.0)
    stated = ("payload.mass", "payload.size", "rail.end", "contact.clearance")
    assert all(scene.provenance[key] == "given to tipoff new" for key in stated)
    assert provenance.nearest(scene.provenance, "payload.inertia.xx").startswith("assumed")
    assert (tmp_path / "j360_start.csv").exists() and scene.warnings == []
    # the errors of the catalogue are about 5 kg and 0.25 to 0.5 mm
    drawn = uncertainty.of_scene(scene).vary
    assert drawn["payload.mass"].ppf(0.5) == pytest.approx(6.0)
    assert drawn["contact.clearance"].ppf(0.5) == pytest.approx(0.45e-3)
    assert drawn["gravity.inclination"].ppf(0.5) == pytest.approx(math.radians(85.0))
    assert call("new", "same.toml", "--rocket").exit_code == 0
    same = scenes.load("same.toml")
    for pad, other in zip(same.pads, own.pads):
        assert pad.position == pytest.approx(other.position, abs=1e-12)
        assert (pad.normals, pad.length) == (other.normals, other.length)
        assert pad.width == pytest.approx(other.width, rel=1e-12)
    assert same.rail.at == pytest.approx(own.rail.at) and same.rail.section == own.rail.section
    assert (same.gravity.x, same.gravity.z) == pytest.approx(
        (own.gravity.x, own.gravity.z), rel=1e-3
    )


def test_a_rocket_on_a_rod_has_lugs(tmp_path, monkeypatch):
    """In 30 lines or fewer. Its play is that of the option, and the rod is held at its foot alone."""
    monkeypatch.chdir(tmp_path)
    asked = ("--rod", "12.7 mm", "--clearance", "0.3 mm", "--rail-length", "1.2 m")
    made = call("new", "own.toml", "--rocket", *asked)
    assert made.exit_code == 0, made.output
    text = (tmp_path / "own.toml").read_text()
    assert len(text.splitlines()) <= 30 and text.count("[[lugs]]") == 2 and "hangs" in text
    scene = scenes.load("own.toml")
    assert scene.contact.gaps() == pytest.approx(3 * [0.3e-3])
    assert scene.rail.section.diameter == pytest.approx(12.7e-3) and len(scene.rail.mounts) == 1
    assert scene.gravity.z > 0.0
    assert provenance.nearest(scene.provenance, "rail.section") == "given to tipoff new"
    assert uncertainty.of_scene(scene).vary["payload.mass"].ppf(0.5) == pytest.approx(5.0)
    for options, words in (([], "--rocket beside it"), (["--deployer", "3u"], "none beside --")):
        made = call("new", "other.toml", *options, "--rod", "6 mm")
        assert made.exit_code == 2 and words in made.stderr


def strangers(mass: str, rail: str, folder) -> scenes.Scene:
    """The scene of a rocket whose buttons, mass centre and angle are edited lines of the file, in the present
    ``folder``."""
    (folder / "motor.csv").write_text("time_s,force_N\n0,0\n0.05,1500\n3,1500\n3.1,0\n")
    asked = ("--mass", mass, "--size", "3.7 m, 152 mm", "--rail-length", rail)
    made = call("new", "mine.toml", "--rocket", *asked, "--thrust-curve", "motor.csv")
    assert made.exit_code == 0, made.output
    text = (folder / "mine.toml").read_text()
    for line, own in (
        ('place = "0.23125 m"', 'place = "0.305 m"'),
        ('place = "1.73438 m"', 'place = "1.646 m"'),
        ('mass_centre = "1.73438 m"', 'mass_centre = "1.71 m"'),
        ('"85 deg"', '"84 deg"'),
    ):
        assert line in text
        text = text.replace(line, own)
    (folder / "mine.toml").write_text(text)
    return scenes.load("mine.toml")


@pytest.mark.parametrize("mass, rail", [("24 kg", "11 m"), ("35 kg", "3.9 m")])
def test_a_stranger_has_an_answer_without_editing_pads(mass, rail, tmp_path, monkeypatch):
    """The speed is that of the motion along the rail, but for the rise of the thrust in 50 ms."""
    monkeypatch.chdir(tmp_path)
    scene = strangers(mass, rail, tmp_path).replace(
        {"thrust_offset": None, "friction": None, "initial": None}
    )
    run = lowfi.run(scene, "springs")
    assert run.status == "exited", unfinished.advice(scene, run)
    speed = float(run.outcome.exit_velocity[0])
    weight = float(scene.payload.mass) * 9.80665 * math.sin(math.radians(84.0))
    way = float(rail.removesuffix(" m")) - 0.305
    assert speed == pytest.approx(
        math.sqrt(2.0 * (1500.0 - weight) / scene.payload.mass * way), rel=0.02
    )


@pytest.mark.slow
def test_all_modes_vibrate_on_a_soft_end(tmp_path, monkeypatch):
    """A rail that is not held over its last 1.1 m, as that of 11 m. Control: where friction drags the walls but not
    the modes, the run diverges before the exit."""
    monkeypatch.chdir(tmp_path)
    scene = strangers("24 kg", "11 m", tmp_path)
    mounts = [{"start": start, "end": start + 0.06} for start in (0.0, 1.2, 2.46)]
    scene = scene.replace({"rail.mounts": mounts, "rail.end": 2.52 + 1.1})
    walls = highfi.condense(scene, 20e-3)
    every, control = (
        lowfi.run(scene, compliance=each, numerics=lowfi.Numerics(modes=20))
        for each in (walls, replace(walls, dragged_shape=None))
    )
    assert every.status == "exited", every.message
    assert every.outcome.exit_velocity[0] > 15.0
    assert control.status == "diverged" and control.time[-1] < every.outcome.exit_time


def test_a_rocket_takes_a_motor_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "motor.csv").write_text("time_s,force_N\n0,0\n0.05,400\n2.5,380\n2.6,0\n")
    made = call("new", "own.toml", "--rocket", "--thrust-curve", "motor.csv")
    assert made.exit_code == 0, made.output
    assert scenes.load("own.toml").thrust.file == str(tmp_path / "motor.csv")
    assert not (tmp_path / "j360_start.csv").exists()
    for wrong in (("--thrust", "3 N"), ("--deployer", "3u"), ("--pads", "8")):
        made = call("new", "other.toml", "--rocket", *wrong)
        assert made.exit_code == 2 and "expected none beside --" in made.stderr
