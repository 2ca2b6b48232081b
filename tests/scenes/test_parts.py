"""Buttons, origin and body of a rocket are the pads, places and inertia that they stand for."""

import tomllib

import pytest
from typer.testing import CliRunner

import tipoff.toml
from tipoff.scenes import drawing, load, parse, provenance
from tipoff.scenes.variation import Variations
from tipoff.studies.cli import app

ROCKET = tomllib.loads("""
name = "mine"
origin = "tail"
contact.law = "impact"
gravity.inclination = "84 deg"
initial.settled = true
friction = { static = 0.2, dynamic = 0.2 }
thrust = { kind = "constant", force = "3 kN", duration = "3 s", reaction = "exhaust" }
payload = { mass = "24 kg", length = "3.7 m", diameter = "152 mm", mass_centre = "1.71 m" }
rail = { start = "0 m", end = "11 m", mounts = [{ start = "1 m", end = "1.1 m" }] }
[[buttons]]
place = "0.305 m"
profile = "1515"
material = "acetal"
[[buttons]]
place = "1.646 m"
""")
# the button of the scene rocket_rail, whose pads were written by hand: place across, normal, width (mm)
BY_HAND = [
    ((5.75, -43.0), "-z", 3.0),
    ((-5.75, -43.0), "-z", 3.0),
    ((5.75, -48.0), "+z", 3.0),
    ((-5.75, -48.0), "+z", 3.0),
    ((3.75, -45.5), "+y", 4.0),
    ((-3.75, -45.5), "-y", 4.0),
]


def rocket(**tables):
    return parse({**ROCKET, **tables})


def test_buttons_of_the_catalogue_are_the_pads_that_were_written_by_hand():
    scene = load("rocket_rail")
    wanted = [
        ((x, 1e-3 * y, 1e-3 * z), (normal,), 8e-3, 1e-3 * width)
        for x in (-0.65, 0.0)
        for (y, z), normal, width in BY_HAND
    ]
    found = [(pad.position, pad.normals, pad.length, pad.width) for pad in scene.pads]
    assert len(found) == len(wanted)
    for pad, other in zip(found, wanted):
        assert pad[1] == other[1]
        assert (*pad[0], *pad[2:]) == pytest.approx((*other[0], *other[2:]), rel=1e-15, abs=1e-18)
    assert scene.rail.at == pytest.approx((0.0, -63.25e-3), rel=1e-15)
    assert scene.contact.gaps() == (0.25e-3, 0.25e-3, 0.25e-3)


def test_places_are_counted_from_the_tail_or_from_the_nose():
    """Both are the same rocket. The nozzle is at the tail."""
    scene = rocket()
    assert (scene.rail.start, scene.rail.end) == pytest.approx((-1.71, 9.29), abs=1e-12)
    assert scene.rail.mounts[0].start == pytest.approx(1.0, abs=1e-12)
    assert sorted({pad.position[0] for pad in scene.pads}) == pytest.approx([-1.405, -0.064])
    assert scene.thrust.arm == pytest.approx(1.71, abs=1e-12)
    nose = rocket(
        origin="nose",
        payload={**ROCKET["payload"], "mass_centre": "1.99 m"},
        rail={"start": "3.7 m", "end": "-7.3 m", "mounts": [{"start": "2.7 m", "end": "2.6 m"}]},
        buttons=[{**ROCKET["buttons"][0], "place": "3.395 m"}, {"place": "2.054 m"}],
    )
    for name in ("pads", "rail", "thrust"):
        assert getattr(nose, name) == getattr(scene, name)


def test_a_body_of_few_numbers_is_a_slender_cylinder_and_says_so():
    scene = rocket()
    inertia = scene.payload.inertia
    assert inertia.xx == pytest.approx(0.5 * 24.0 * 0.076**2, rel=1e-12)
    assert inertia.yy == pytest.approx(24.0 * (3 * 0.076**2 + 3.7**2) / 12.0, rel=1e-12)
    for key in ("payload.inertia.yy", "pads.3.width", "contact.stiffness", "rail.material.density"):
        assert provenance.nearest(scene.provenance, key).startswith("assumed"), key
    assert provenance.nearest(scene.provenance, "payload.mass") is None


@pytest.mark.parametrize(
    "change, moved",
    [
        ({"buttons.0.neck_to_slot": 0.3e-3}, lambda s: s.contact.gaps()[1] == 0.3e-3),
        ({"buttons.0.neck_to_slot": 0.3e-3}, lambda s: s.rail.clearance == 0.3e-3),
        ({"buttons.0.head_to_lip": 0.5e-3}, lambda s: s.rail.at[1] < rocket().rail.at[1] - 2e-4),
        ({"buttons.1.place": 1.7}, lambda s: s.pads[6].position[0] == pytest.approx(-0.01)),
        ({"payload.mass_centre": 1.8}, lambda s: s.rail.end == pytest.approx(9.2)),
        (
            {"payload.mass": 48.0},
            lambda s: s.payload.inertia.yy > 1.99 * rocket().payload.inertia.yy,
        ),
        ({"gravity.inclination": 1.5}, lambda s: s.gravity.z > rocket().gravity.z + 0.3),
        ({"pads.3.length": 5e-3}, lambda s: [p.length for p in s.pads[2:5]] == [8e-3, 5e-3, 8e-3]),
        ({"contact": None}, lambda s: s.contact is None),
    ],
)
def test_what_hangs_on_a_part_moves_with_it(change, moved):
    scene = rocket().replace(change)
    assert moved(scene) and not moved(rocket())
    assert Variations(rocket()).of(change).hash == scene.hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    condition = parse({**ROCKET, "conditions": {"one": change}}, bare_numbers_are_si=True)
    restored = parse(condition.resolved(), bare_numbers_are_si=True)
    assert restored.condition("one").hash == scene.hash


def test_variations_of_one_key_after_another():
    varied = Variations(rocket())
    for mass in (23.0, 24.0, 25.0):
        for row in ({"payload.mass": mass}, {"thrust_offset.misalignment.axial": 1e-3 * mass}):
            row |= {"thrust_offset.misalignment.radial": 0.0}
            assert varied.of(row).hash == rocket().replace(row).hash


def test_parts_written_out_are_the_same_scene_by_hand():
    scene = rocket()
    by_hand = scene.written_out()
    assert len(by_hand["pads"]) == 12 and not {"buttons", "origin"} & set(by_hand)
    assert parse(by_hand).hash == scene.hash


def test_the_command_writes_out_and_draws_a_file(tmp_path):
    """As a file that is the same scene; one of the catalogue stays as it was written."""
    path, picture = tmp_path / "mine.toml", tmp_path / "mine.png"
    path.write_text(tipoff.toml.dumps(ROCKET))
    found = CliRunner().invoke(app, ["scenes", "--show", str(path)])
    assert found.exit_code == 0, found.output
    raw = tomllib.loads(found.stdout)
    assert len(raw["pads"]) == 12 and "buttons" not in raw and len(raw["pads"][0]["foot"]) == 3
    by_hand = tmp_path / "by_hand.toml"
    by_hand.write_text(found.stdout)
    assert load(by_hand).hash == rocket().hash
    found = CliRunner().invoke(app, ["scenes", "--show", "rocket_rail"])
    assert "buttons" in tomllib.loads(found.stdout)
    found = CliRunner().invoke(app, ["scenes", "--show", str(path), "--draw", str(picture)])
    assert found.exit_code == 0 and picture.read_bytes().startswith(b"\x89PNG")
    for wrong, words in (
        (["--draw", "a.png"], "--show"),
        (["--show", "tiny", "--draw", "a.txt"], ".png"),
        (["--pads"], "no longer one: --show FILE.toml writes out"),
    ):
        found = CliRunner().invoke(app, ["scenes", *wrong])
        assert found.exit_code == 2 and words in found.stderr


def test_a_rocket_is_drawn_from_its_tail_to_its_nose_beside_its_rail():
    """Its mass centre is not in the middle. Control: a body without an origin has it there."""
    scene = rocket()
    tail, nose = drawing.ends(scene)
    assert nose - tail == pytest.approx(scene.payload.length)
    assert tail == pytest.approx(-scene.thrust.arm)  # the nozzle is at the tail
    assert drawing.height(scene) == 2 and drawing.height(load("reference")) == 1
    low, high = drawing.ends(load("rocket_rail"))
    assert low == -high
    figure = scene.plot()
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert {"button 1", "button 2", "mass centre", "thrust", "Z"} <= set(texts)
    assert any(words.startswith("play of each pad") for words in texts)
    with pytest.raises(ValueError, match="expected launcher or thrust"):
        scene.plot("rail")
