"""Launch lugs on a round rod: pads, play and rod follow from a few numbers, and the rocket moves as by hand."""

import math
import tomllib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.exact import pivot
from tests.scenes.test_parts import ROCKET
from tipoff import lowfi
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.results import hand_calculation
from tipoff.scenes import SceneError, guides, load, parse, scene_model, uncertainty
from tipoff.scenes.variation import Variations

ROD, INNER, LONG = 6.35e-3, 6.9e-3, 30e-3  # m
REAR, FRONT = -0.3, 0.1  # m, lugs from the mass centre
TEXT = """
name = "mine"
origin = "tail"
contact = { law = "impact" }
gravity = { inclination = "85 deg" }
thrust = { kind = "constant", force = "20 N", duration = "1 s", reaction = "exhaust" }
payload = { mass = "0.4 kg", length = "0.9 m", diameter = "50 mm", mass_centre = "0.4 m" }
rail.start = "0 m"
rail.end = "1.2 m"
rail.mounts = [{ start = "0 m", end = "40 mm" }]
rail.section = { shape = "rod", diameter = "6.35 mm" }
[[lugs]]
place = "0.1 m"
inner_diameter = "6.9 mm"
length = "30 mm"
material = "nylon"
[[lugs]]
place = "0.5 m"
"""
TABLES = tomllib.loads(TEXT)
# contact of which the penetration is small beside the play
STIFF = {
    "contact.stiffness": "5e5 N/mm**1.5",
    "contact.damping": "100 N*s/mm",
    "contact.damping_depth": "1 um",
}


def rocket(**tables):
    return parse({**TABLES, **tables})


def single(length: str):
    """A rocket on one lug at the mass centre."""
    return rocket(lugs=[{**TABLES["lugs"][0], "place": "0.4 m", "length": length}])


def test_lugs_are_faces_at_both_ends_around_the_rod_one_play_off():
    scene = rocket()
    play, axis = 0.5 * (INNER - ROD), -(25e-3 + 0.5 * INNER + 1e-3)
    assert scene.contact.gaps() == pytest.approx((play,) * 3, abs=1e-12)
    assert scene.rail.at == pytest.approx((0.0, axis), abs=1e-12)
    outline = scene.rail.outline().at(scene.rail.at)
    away = max(y for loop in outline.loops for y, _ in loop)  # of the sides along Y and Z
    bands = {x + side * 0.5 * (LONG - 4e-3) for x in (REAR, FRONT) for side in (-1, 1)}
    found = {(pad.normals[0], *np.round(pad.position, 9)) for pad in scene.pads}
    assert len(found) == len(scene.pads) == 16
    for x in bands:
        for normal, y, z in (("-z", 0, 1), ("+z", 0, -1), ("-y", 1, 0), ("+y", -1, 0)):
            place = (x, y * (away + play), axis + z * (away + play))
            assert (normal, *np.round(place, 9)) in found
    assert [guide.name for guide in guides.from_pads(scene.pads)] == ["lug 1", "lug 2"]
    assert scene.pads[0].foot == pytest.approx((REAR, 0.0, -25e-3))
    assert parse(scene.written_out()).hash == scene.hash


def test_the_play_is_exact_along_both_axes_and_larger_between_them():
    """Of a lug round a rod it is the same in every direction. The four faces let a lug move by 1 / max(|cos|,
    |sin|) of it: sqrt 2 at most, 4 / pi asinh 1 = 1.122 in the mean."""
    faces = scene_model.built(rocket()).nominal
    angles = np.linspace(0.0, 2.0 * np.pi, 3601)[:-1]
    direction = np.array([np.cos(angles), np.sin(angles)])
    own = np.arange(4)
    normal = np.zeros((4, 2))
    normal[own, faces.axis[:4] - 1] = faces.sign[:4]
    gap = faces.sign[:4] * (faces.wall[:4] - faces.centre[own, faces.axis[:4]])
    toward = normal @ direction
    reach = np.where(toward > 1e-12, gap[:, None] / np.maximum(toward, 1e-12), np.inf).min(axis=0)
    share = reach / (0.5 * (INNER - ROD))
    assert share[::900] == pytest.approx([1.0] * 4, rel=1e-9)
    assert share.max() == pytest.approx(math.sqrt(2.0), rel=1e-6)
    assert share.mean() == pytest.approx(4.0 / math.pi * math.asinh(1.0), rel=1e-5)


def pitch(scene) -> float:
    """Angle (rad) at which a thrust beside the mass centre presses the payload against its rod."""
    beside = {"axial": "5 mm", "radial": "0 deg"}
    asked = scene.replace(
        STIFF | {"thrust_offset.eccentricity": beside, "gravity": None, "output.interval": "1 ms"}
    )
    run = lowfi.run(asked, "springs")
    last = np.searchsorted(run.time, 0.8 * min(g.leaves_s for g in run.guides if g.leaves_s))
    return abs(Rotation.from_quat(run.quaternion[last], scalar_first=True).as_rotvec()[1])


@pytest.mark.case("O92")
@pytest.mark.parametrize(
    "scene, spacing",
    [
        (rocket(), FRONT - REAR + LONG - 4e-3),
        (single("120 mm"), 0.116),
        (rocket(rail={**TABLES["rail"], "section": {"shape": "rod", "diameter": "6.6 mm"}}), 0.426),
    ],
)
def test_the_angle_of_the_play_is_the_play_over_the_spacing(scene, spacing):
    """(D - d) / s between the middles of the outermost faces. Control: the spacing of the lugs' middles."""
    rod = scene.rail.section.diameter
    assert pitch(scene) == pytest.approx((INNER - rod) / spacing, rel=0.015)
    # Control:
    other = FRONT - REAR if len(scene.pads) == 16 else 0.120
    assert abs(pitch(scene) * other / (INNER - rod) - 1.0) > 0.02


@pytest.mark.case("O81")
@pytest.mark.parametrize("angle", ["85 deg", "70 deg"])
def test_the_rear_lug_is_a_pin_after_the_front_one_left(angle):
    """Short lugs without play. The rocket hangs below its rod, so it turns the other way than on a rail.
    Control: without the share of the thrust, which acts along the rocket, the rate is too small."""
    short = [
        {**TABLES["lugs"][0], "length": "1 mm", "inner_diameter": "6.35 mm"},
        {"place": "0.5 m"},
    ]
    scene = rocket(lugs=short, gravity={"inclination": angle}).replace(STIFF)
    run = lowfi.run(scene, "springs")
    mass, inertia = scene.payload.mass, scene.payload.inertia.yy
    push = 20.0 / mass + scene.gravity.x
    first, last = (math.sqrt(2.0 * (0.8 - x) / push) for x in (FRONT, REAR))
    exact = pivot.rate((mass, inertia), -REAR, scene.gravity.z, 20.0, last - first)
    assert run.outcome.exit_rate[1] == pytest.approx(-exact, rel=5e-3) and exact > 0.05
    assert run.outcome.exit_time == pytest.approx(last, abs=2.0 * EXIT_WINDOW)
    # Control:
    start = pivot.start((mass, inertia), -REAR, scene.gravity.z, last - first)
    assert abs(start / exact - 1.0) > 0.02
    by_hand = hand_calculation.pinned(scene, run)
    assert not isinstance(by_hand, str) and "rear lug" in by_hand.words
    assert by_hand.rate_rad_s == pytest.approx((0.0, -start, 0.0), rel=2e-3, abs=1e-12)


@pytest.mark.parametrize(
    "change, moved",
    [
        ({"lugs.0.inner_diameter": 7e-3}, lambda s: s.contact.gaps()[1] == pytest.approx(0.325e-3)),
        ({"rail.section.diameter": 6.5e-3}, lambda s: s.rail.clearance == pytest.approx(0.2e-3)),
        ({"lugs.0.length": 0.05}, lambda s: s.pads[0].position[0] == pytest.approx(-0.323)),
        ({"lugs.1.place": 0.6}, lambda s: s.pads[8].position[0] == pytest.approx(0.187)),
        ({"lugs.0.height": 6e-3}, lambda s: s.rail.at[1] == pytest.approx(-0.031)),
        ({"gravity.inclination": 1.2}, lambda s: s.gravity.z > rocket().gravity.z + 1.0),
    ],
)
def test_what_hangs_on_a_lug_moves_with_it(change, moved):
    scene = rocket().replace(change)
    assert moved(scene) and not moved(rocket())
    assert Variations(rocket()).of(change).hash == scene.hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash


def test_a_file_of_errors_varies_the_play(tmp_path):
    path = tmp_path / "vary.toml"
    path.write_text(
        'cases = 2\n[vary."lugs.0.inner_diameter"]\ndistribution = "uniform"\nlow = "6.7 mm"\nhigh = "7 mm"\n'
    )
    key, spread = next(iter(uncertainty.load(path, rocket()).vary.items()))
    varied = Variations(rocket())
    for share in (0.1, 0.9):
        inner = float(spread.ppf(share))
        gaps = varied.of({key: inner}).contact.gaps()
        assert gaps == pytest.approx((0.5 * (inner - ROD),) * 3, abs=1e-12)


@pytest.mark.parametrize(
    "tables, keys",
    [
        ({"pads": [{"position": ["0 m"] * 3, "normals": ["+y"]}]}, ["pads"]),
        ({"buttons": [{"place": "0 m", "profile": "1515"}]}, ["lugs", "rail.section"]),
        ({"lugs": []}, ["lugs"]),
        ({"lugs": [{"place": "0.1 m"}]}, ["lugs.0.inner_diameter", "lugs.0.length"]),
        (
            {"lugs": [{**TABLES["lugs"][0], "inner_diameter": "9 mm"}, {"place": "1 kg"}]},
            ["lugs.1.place"],
        ),
        (
            {
                "lugs": [
                    {**TABLES["lugs"][0], "inner_diameter": "6 mm"},
                    {"place": "0.5 m", "inner_diameter": "9 mm"},
                ]
            },
            ["lugs.0.inner_diameter", "lugs.1.inner_diameter"],
        ),
        (
            {"lugs": [*TABLES["lugs"], {"place": "0.7 m", "inner_diameter": "7 mm"}]},
            ["lugs.2.inner_diameter"],
        ),
        ({"rail": {"start": "0 m", "end": "1 m", "mounts": []}}, ["rail.section"]),
    ],
)
def test_every_fault_of_a_lug_is_listed(tables, keys):
    with pytest.raises(SceneError) as caught:
        rocket(**tables)
    found = [fault.key for fault in caught.value.faults]
    assert set(keys) <= set(found), found
    assert len(found) == len(set(found))


def test_a_shoe_is_a_long_button_with_faces_at_both_ends():
    """One shoe alone holds the pitch, as two buttons at its ends do."""
    rear = {**ROCKET["buttons"][0], "length": "120 mm"}
    one = parse({**ROCKET, "buttons": [{**rear, "place": "1.71 m"}]})
    assert len(one.pads) == 12
    assert sorted({pad.position[0] for pad in one.pads}) == pytest.approx([-0.056, 0.056])
    assert {pad.length for pad in one.pads} == {8e-3}
    assert [guide.name for guide in guides.from_pads(one.pads)] == ["button 1"]
    ends = [{**rear, "place": place, "length": "8 mm"} for place in ("1.654 m", "1.766 m")]
    two = parse({**ROCKET, "buttons": ends})
    for found, wanted in zip(one.pads, two.pads):
        assert found.position == pytest.approx(wanted.position, abs=1e-12)


def test_faces_at_an_angle_are_refused_with_what_to_use():
    """Three rods at 120 deg."""
    pads = [{"position": ["0 m", "43 mm", "25 mm"], "normals": ["30 deg"]}]
    with pytest.raises(SceneError, match="three rods at 120 deg.*four walls"):
        load("tiny").replace({"pads": pads})
