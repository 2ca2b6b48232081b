"""Valid values that look like an error of units are named, on both sides of each bound."""

import math

import numpy as np
import pytest

from tests.scenes.support import CONTACT, small
from tipoff.scenes import SceneError, catalog, implausible, load, parse, sinking, uncertainty
from tipoff.scenes.variation import Variations

DENSITY = 2810.0


@pytest.mark.parametrize(
    "speed, warned", [(99.0, True), (101.0, False), (9_990.0, False), (10_010.0, True)]
)
def test_wave_speed(speed, warned):
    scene = parse(small(rail__material__youngs_modulus=f"{DENSITY * speed**2!r} Pa"))
    found = [text for text in scene.warnings if "wave speed" in text]
    assert len(found) == warned
    assert all(
        "rail.material.youngs_modulus" in text and "rail.material.density" in text for text in found
    )


@pytest.mark.parametrize(
    "mass, warned", [(0.9, False), (0.07, True), (0.09, False), (159.0, False), (161.0, True)]
)
def test_payload_density(mass, warned):
    scene = parse(small(payload__mass=f"{mass} kg", payload__size=["0.2 m", "0.2 m", "0.2 m"]))
    found = [text for text in scene.warnings if "mean density" in text]
    assert len(found) == warned
    assert all("payload.mass" in text and "payload.size" in text for text in found)


def test_slips_of_units_are_seen():
    """72 MPa for GPa, and 2.81 kg/m3 for g/cm3: both leave a valid scene."""
    for slip in (
        {"rail__material__youngs_modulus": "0.72 MPa"},
        {"rail__material__density": "2.81 kg/m**3"},
    ):
        assert any("wave speed" in text for text in parse(small(**slip)).warnings)


def test_without_a_size_density_is_not_judged():
    assert not any("density" in text for text in parse(small(payload__mass="1e6 kg")).warnings)


@pytest.mark.parametrize(
    "key, slip, right, meant",
    [
        ("contact.stiffness", "70000 N/m**1.5", "70000 N/mm**1.5", "in mm instead of m"),
        ("contact.stiffness", "70 N/mm**1.5", "70 kN/mm**1.5", "in kN instead of N"),
        ("contact.stiffness", "70 N/m**1.5", "70 kN/mm**1.5", "in kN and mm instead of N and m"),
        ("contact.interface_stiffness", "1800 N/m**3", "1800 N/mm**3", "in mm instead of m"),
        ("contact.interface_stiffness", "1.8 N/mm**3", "1.8 kN/mm**3", "in kN instead of N"),
    ],
)
def test_a_stiffness_in_another_unit_sinks_too_far(key, slip, right, meant):
    scene = load("reference")
    (text,) = scene.replace({key: slip}).warnings
    assert text.startswith(f"{key}: under {slip} a pad sinks ")
    assert f"; {meant} it would be " in text
    assert scene.replace({key: right}).warnings == []


def test_sink_is_that_of_the_law_under_the_load_of_the_scene():
    """0.1 deg of 6 kN across the axis, and its moment on an arm of 0.1 m borne 0.16 m apart; then
    weight alone; then no load."""
    scene = load("reference").replace({"contact.stiffness": "70000 N/m**1.5"})
    force = 6000.0 * math.sin(math.radians(0.1)) * (1.0 + 0.1 / 0.16)
    assert sinking.load(scene) == pytest.approx(force, rel=1e-12)
    assert (
        f"sinks {1e3 * (force / 70000.0) ** (1.0 / 1.5):.3g} mm at a static load of {force:.3g} N"
        in scene.warnings[0]
    )
    heavy = scene.replace({"thrust_offset": None, "gravity": {"z": -9.81}})
    assert sinking.load(heavy) == pytest.approx(9.9 * 9.81, rel=1e-12)
    assert scene.replace({"thrust_offset": None}).warnings == []


@pytest.mark.parametrize("side, warned", [(0.99, True), (1.01, False)])
def test_a_sink_is_judged_by_the_clearance(side, warned):
    """Both sides of the bound; a linear spring sinks by load over stiffness."""
    scene = load("reference").replace(
        {"contact": {"law": "linear", "clearance": "0.25 mm", "stiffness": "1 N/m"}}
    )
    stiffness = side * sinking.load(scene) / 0.25e-3
    assert (
        any(
            "contact.stiffness" in text
            for text in scene.replace({"contact.stiffness": stiffness}).warnings
        )
        == warned
    )


def test_a_small_clearance_is_no_slip_of_units():
    """Springs that deflect by 4 um beside a clearance of 1 um, or none, are a tight fit."""
    scene = load("reference")
    assert (
        scene.replace({"contact.clearance": "1 um"}).warnings
        == scene.replace({"contact.clearance": 0.0}).warnings
        == []
    )


@pytest.mark.parametrize(
    "mass, warned", [("50 kg", True), ("12 kg", False), ("9 kg", False), ("2 kg", True)]
)
def test_an_inherited_inertia_that_does_not_fit_the_mass(mass, warned):
    """A box of even density, 0.35 x 0.20 x 0.20 m, of 9.9 kg has 0.066 kg m2 about X."""
    texts = load("reference").replace({"payload.mass": mass}).warnings
    assert bool(texts) == warned and all(
        "payload.inertia.xx" in text and "payload.size" in text for text in texts
    )


@pytest.mark.parametrize("factor, warned", [(0.99, False), (1.01, True)])
def test_no_body_in_a_box_has_more_inertia_than_mass_at_its_corners(factor, warned):
    """Eight points at the corners: m (b^2 + c^2) / 4, the bound itself, for a body of any mass and
    box."""
    mass, sides = 5.0, (0.3, 0.2, 0.4)
    largest = [
        mass * sum(side**2 for other, side in enumerate(sides) if other != axis) / 4.0
        for axis in range(3)
    ]
    inertia = {
        name: f"{factor * value!r} kg*m**2" for name, value in zip(("xx", "yy", "zz"), largest)
    }
    scene = parse(
        small(payload={"mass": "5 kg", "size": [f"{side} m" for side in sides], "inertia": inertia})
    )
    assert bool(scene.warnings) == warned


def test_without_a_size_pads_give_the_width_of_the_payload():
    scene = load("reference").replace({"payload.size": None})
    assert scene.warnings == []
    # 9.9 kg at most 0.1 m off the axis in y and z: 0.198
    (text,) = scene.replace({"payload.inertia.xx": 0.25}).warnings
    assert "payload.inertia.xx" in text and "pads" in text
    # it may be long
    assert scene.replace({"payload.inertia.yy": 0.9, "payload.inertia.zz": 0.9}).warnings == []


@pytest.mark.parametrize("end, warned", [("159 mm", False), ("161 mm", True), ("0.5 m", True)])
def test_inherited_mounts_that_leave_the_end_of_a_longer_rail_free(end, warned):
    """The widest gap is 72 mm: 36 mm beyond the last mount, which ends at 124 mm, are eight times
    as soft as its middle."""
    texts = load("reference").replace({"rail.end": end}).warnings
    assert bool(texts) == warned and all(
        "rail.mounts" in text and "open end" in text for text in texts
    )


def test_a_free_rear_end_and_a_single_mount():
    texts = (
        load("reference").replace({"rail.mounts": [{"start": "100 mm", "end": "120 mm"}]}).warnings
    )
    assert [end for text in texts for end in ("rear end", "open end") if end in text] == [
        "rear end",
        "open end",
    ]
    joined = [{"start": 0.0, "end": "110 mm"}, {"start": "110 mm", "end": "220 mm"}]
    assert load("reference").replace({"rail.mounts": joined}).warnings == []


def test_inherited_mounts_off_a_shorter_rail_are_refused():
    with pytest.raises(
        SceneError, match="rail.mounts: .*spans that lie on the rail, which is 0.188 m long"
    ):
        load("reference").replace({"rail.end": "100 mm"})


@pytest.mark.parametrize("name", catalog())
def test_no_condition_of_the_catalogue_is_implausible(name):
    scene = load(name)
    found = {condition: scene.condition(condition).warnings for condition in scene.conditions}
    assert not any(found.values())


def test_an_implausible_condition_is_reported_once():
    """Load comes with the conditions here: without them nothing presses a pad."""
    slip = small(
        contact=CONTACT | {"stiffness": "70000 N/m**1.5"},
        payload__inertia={"xx": 0.1, "yy": 0.1, "zz": 0.1},
        conditions={
            "a": {"thrust_offset.misalignment.axial": "0.002 rad"},
            "b": {"thrust_offset.misalignment.axial": "0.010 rad"},
        },
    )
    scene = parse(slip, bare_numbers_are_si=True)
    assert scene.warnings == []
    (text,) = implausible.of_all_conditions(scene)
    assert text.startswith("contact.stiffness: ") and text.endswith("(condition a)")


@pytest.mark.parametrize("stiffness, warned", [("1.8e12", False), ("9e15", False), ("1e20", True)])
def test_an_interface_stiffer_than_any_is_named(stiffness, warned):
    scene = parse(small(contact=CONTACT | {"interface_stiffness": f"{stiffness} N/m**3"}))
    found = [text for text in scene.warnings if "steps of the reference" in text]
    assert len(found) == warned


def test_the_motion_of_a_platform_that_is_not_there_is_named():
    """Control: with a platform, or without motion, nothing is said."""
    moving = {"initial": {"platform_velocity": {"x": 0.1}, "platform_rate": {"z": 0.01}}}
    found = load("tiny").replace(moving | {"platform": None}).warnings
    said = [words.partition(":")[0] for words in found if "no effect" in words]
    assert said == ["initial.platform_velocity", "initial.platform_rate"]
    assert not any("no effect" in words for words in load("tiny").replace(moving).warnings)
    rest = {"initial": {"velocity": {"x": 0.1}}, "platform": None}
    assert not any("no effect" in words for words in load("tiny").replace(rest).warnings)


@pytest.mark.parametrize(
    "way, outside", [(0.062, True), (0.058, False), (-0.018, True), (-0.014, False)]
)
def test_pads_that_begin_beyond_an_end_of_the_rail(way, outside):
    """Of 16 mm, with the middle 52 mm before the open end and 8 mm from the other one. Control: the same
    place without contact."""
    scene = load("reference").replace({"initial.position.x": way})
    ends = {0.08 + way - 0.008 > scene.rail.end, -0.08 + way + 0.008 < scene.rail.start}
    assert (True in ends) == outside
    found = [words for words in scene.warnings if "outside the rail" in words]
    assert len(found) == outside
    assert all(words.startswith("pads, rail.start, rail.end: at ignition pads ") for words in found)
    free = scene.replace({"contact": None, "friction": None})
    assert not any("outside the rail" in words for words in free.warnings)


@pytest.mark.parametrize("others", [{}, {"contact": None, "friction": None}])
def test_a_rail_that_ends_behind_every_pad_is_refused(others):
    """By a wrong sign of its end. The rear edges of the rear pads are at -88 mm. A case of an ensemble is
    refused in the same words. Control: a rail that ends 0.1 mm beyond them."""
    held = {"rail.start": -0.3, "rail.mounts": [{"start": 0.008, "end": 0.024}]}
    scene = load("tiny").replace(held | others)
    beyond, behind = {"rail.end": -0.0879}, {"rail.end": -0.0881}
    with pytest.raises(SceneError) as error:
        scene.replace(behind)
    (fault,) = error.value.faults
    assert (fault.key, fault.given) == ("rail.end", "-0.0881 m")
    assert fault.expected.startswith("more than -0.088 m")
    variations = Variations(scene)
    for _ in range(2):  # the first row of its keys, and a later one
        assert variations.of(beyond).rail.end == -0.0879
        with pytest.raises(SceneError) as refused:
            variations.of(behind)
        assert str(refused.value) == str(error.value)
    # a payload that begins 1 mm behind its nominal place has its pads on the rail
    assert scene.replace(behind | {"initial.position.x": -1e-3}).rail.end == -0.0881


def test_errors_far_from_the_values_of_the_scene_are_told():
    """Distributions replace the values of a scene, so those of another one make it another payload. A rocket of
    12 kg flew as one of 5 kg. Control: the mass at the edge of its range, and errors of angles and sizes
    that begin at those of the scene."""
    rocket = load("rocket_rail")
    assert implausible.of_all_conditions(rocket) == []
    heavy = rocket.replace(
        {"payload.mass": 12.0, "payload.inertia": {"xx": 0.02, "yy": 2.0, "zz": 2.0}}
    )
    told = implausible.of_all_conditions(heavy)
    (mass,) = [words for words in told if words.startswith("vary.")]
    assert mass.startswith("vary.payload.mass: 4.") and "and 12 kg in the scene" in mass
    drawn = uncertainty.of_scene(rocket)
    edge = float(drawn.vary["payload.mass"].ppf(np.array(0.999)))
    assert uncertainty.far_from_scene(drawn, rocket.replace({"payload.mass": edge})) == []
    without = rocket.replace({"payload.mass": 12.0, "studies.errors": None})
    assert not any(words.startswith("vary.") for words in implausible.of_all_conditions(without))


@pytest.mark.parametrize(
    "static, dynamic, warned",
    [(0.2, 0.2, False), (0.3, 0.2, False), (0.2, 0.2001, True), (0.0, 0.2, True)],
)
def test_friction_that_grows_when_a_pad_slides(static, dynamic, warned):
    scene = load("tiny").replace({"friction.static": static, "friction.dynamic": dynamic})
    found = [text for text in scene.warnings if text.startswith("friction.static")]
    assert len(found) == warned


def test_cases_are_examined_as_scenes_are():
    """A refused case has no message, and neither has what the scene itself has."""
    rows = [{"payload.mass": "9 kg"}, {"payload.mass": "-1 kg"}, {"rail.material.density": 20.0}]
    found = implausible.of_cases(load("tiny"), 3, lambda low, high: rows[low:high])
    assert all(words.endswith("(case 2)") for words in found)
    assert [words.partition(": ")[0] for words in found] == [
        "rail.material.youngs_modulus, rail.material.density",
        "rail.material.density",
    ]
    light = load("tiny").replace(rows[2])
    assert implausible.of_cases(light, 3, lambda low, high: rows[low:high]) == []


def test_many_cases_are_examined_at_even_distances():
    count, seen = 10 * implausible.MOST_CASES, []

    def rows(low, high):
        seen.append(low)
        return [{"friction.static": 0.1 if low > count / 2 else 0.3}]

    (found,) = implausible.of_cases(load("tiny"), count, rows)
    assert len(seen) == implausible.MOST_CASES and seen[0] == 0 and seen[-1] == count - 1
    assert f"and 499 more of {implausible.MOST_CASES:,} examined)" in found
