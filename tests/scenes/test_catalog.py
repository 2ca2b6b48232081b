"""The catalogue holds its published numbers, in SI, and every condition is that of its table."""

import math

import pytest

from tipoff.scenes import catalog, load

DEGREE = math.pi / 180.0


@pytest.mark.parametrize("name", catalog())
def test_every_scene_loads_with_all_its_conditions(name):
    scene = load(name)
    assert scene.name == name
    assert scene.warnings == []
    for condition in scene.conditions:
        scene.condition(condition)


def test_catalogue_names():
    assert {"reference", "sensitive", "tiny"} <= set(catalog())


# Values typed here a second time on purpose, in SI, from the table "Reference scene" of the design.
DESIGN = {
    "duration": 58e-3,
    "payload.mass": 9.9,
    "payload.inertia": {
        "xx": 0.066,
        "yy": 0.134,
        "zz": 0.128,
        "xy": 0.004,
        "xz": -0.002,
        "yz": 0.0,
    },
    "payload.size": (0.35, 0.20, 0.20),
    "platform.mass": 81.2,
    "platform.inertia": {"xx": 4.9, "yy": 4.9, "zz": 4.9, "xy": 0.0, "xz": 0.0, "yz": 0.0},
    "platform.mass_centre": {"x": -0.10, "y": 0.0, "z": 0.0},
    "rail.start": -0.088,
    "rail.end": 0.132,
    "rail.leg": 0.024,
    "rail.thickness": 0.004,
    "rail.mount_width": 0.004,
    "rail.fillet": 0.002,
    "rail.mount_stiffness": {"normal": 1e13, "shear": 5e12, "factor": 1.0},
    "rail.material.density": 2810.0,
    "rail.material.youngs_modulus": 72e9,
    "rail.material.poisson_ratio": 0.33,
    "contact.clearance": 0.25e-3,
    "contact.interface_stiffness": 1.8e12,
    "contact.stiffness": 70000.0 * 1000.0**1.5,
    "contact.exponent": 1.5,
    "contact.damping": 60e3,
    "contact.damping_depth": 0.3e-3,
    "contact.law": "impact",
    "thrust.kind": "gaussian",
    "thrust.peak": 6000.0,
    "thrust.width": 4e-3,
    "thrust.centre": 12e-3,
    "thrust.arm": 0.10,
    "thrust.reaction": "platform",
    "thrust_offset.misalignment": {"axial": 0.1 * DEGREE, "radial": 0.0},
    "friction.static": 0.2,
    "friction.dynamic": 0.2,
    "friction.static_speed": 0.010,
    "friction.dynamic_speed": 0.020,
    "output.interval": 5e-5,
}


def _same(found, expected) -> bool:
    if isinstance(expected, dict):
        return set(found) == set(expected) and all(
            _same(found[key], expected[key]) for key in expected
        )
    if isinstance(expected, tuple):
        return len(found) == len(expected) and all(map(_same, found, expected))
    return (
        found == expected
        if isinstance(expected, str)
        else found == pytest.approx(expected, rel=1e-14, abs=0.0)
    )


@pytest.mark.parametrize("key", DESIGN)
def test_reference_is_the_design(key):
    value = load("reference")
    for part in key.split("."):
        value = getattr(value, part)
    assert _same(value.model_dump() if hasattr(value, "model_dump") else value, DESIGN[key])


def test_reference_has_no_other_effects():
    assert load("reference").absent_effects() == [
        "mass_offset",
        "initial",
        "gravity",
        "thermal",
        "rail.damping",
        "hold_down",
    ]


def test_reference_pads():
    pads = load("reference").pads
    places = {pad.position for pad in pads}
    assert len(pads) == 8
    assert places == {(x, y, z) for x in (-0.08, 0.08) for y in (-0.1, 0.1) for z in (-0.1, 0.1)}
    for pad in pads:
        outward = {
            ("+" if pad.position[1] > 0 else "-") + "y",
            ("+" if pad.position[2] > 0 else "-") + "z",
        }
        assert set(pad.normals) == outward
        assert (pad.length, pad.width, pad.inset, pad.relief) == pytest.approx(
            (16e-3, 16e-3, 10e-3, 20e-6), rel=1e-14
        )


def test_reference_mounts_are_multiples_of_four_millimetres():
    spans = [(span.start, span.end) for span in load("reference").rail.mounts]
    assert spans == [
        pytest.approx(pair, rel=1e-14)
        for pair in ((8e-3, 28e-3), (100e-3, 120e-3), (192e-3, 212e-3))
    ]


def test_thrust_gives_sixty_newton_seconds_and_six_metres_per_second():
    scene = load("reference")
    impulse = scene.thrust.describe(scene.duration)["impulse_delivered_Ns"]
    assert impulse == pytest.approx(60.0, rel=3e-3)
    assert impulse / scene.payload.mass == pytest.approx(6.0, rel=2e-2)


def test_sensitive_is_clamped_but_for_two_values():
    expected = load("clamped").replace({"thrust.peak": "10 kN", "contact.clearance": "0.05 mm"})
    assert load("sensitive").hash == expected.hash


def test_clamped_is_the_reference_but_for_corner_mounts_and_inset():
    """Control: without one of the changes it is another scene."""
    changes = {f"pads.{pad}.inset": "9 mm" for pad in range(8)}
    changes |= {"rail.fillet": "absent", "rail.mount_stiffness": "absent"}
    reference, clamped = load("reference"), load("clamped")
    assert clamped.hash == reference.replace(changes).hash
    for left_out in changes:
        some = {key: value for key, value in changes.items() if key != left_out}
        assert clamped.hash != reference.replace(some).hash
    stated = {"rail.fillet", "rail.mount_stiffness"}
    assert stated <= reference.provenance.keys() and not stated & clamped.provenance.keys()


def test_tiny_is_short_and_its_rail_is_even():
    tiny, reference = load("tiny"), load("clamped")
    assert (tiny.pads, tiny.payload, tiny.rail.material) == (
        reference.pads,
        reference.payload,
        reference.rail.material,
    )
    places = [
        tiny.rail.end,
        *(place for span in tiny.rail.mounts for place in (span.start, span.end)),
    ]
    assert [round((place - tiny.rail.start) / 0.008, 9) % 1.0 for place in places] == [0.0] * 7
    assert tiny.duration < reference.duration
    assert set(tiny.agreement.fitted) == {"phi15", "phi60"}


# condition: misalignment (deg, deg), thrust eccentricity (mm, deg), mass eccentricity (mm, deg);
# None where absent
CONDITIONS = {
    "phi0": ((0.1, 0), None, None),
    "phi15": ((0.1, 15), None, None),
    "phi35": ((0.1, 35), None, None),
    "phi60": ((0.1, 60), None, None),
    "phi90": ((0.1, 90), None, None),
    "h1": ((0.1, 25), None, None),
    "h2": ((0.1, 45), None, None),
    "h3": ((0.1, 75), None, None),
    "h4": ((0.3, 30), None, None),
    "h5": (None, (0.3, 40), None),
    "h6": (None, None, (0.2, 120)),
    "h7": ((1.0, 200), None, None),
    "h8": (None, (1.0, 250), None),
    # Two thirds of the three-sigma ranges in the paper's Table 3: 0.4 deg, 0.6 mm, 0.4 mm.
    "h9": ((0.4 * 2 / 3, 70), (0.6 * 2 / 3, 160), (0.4 * 2 / 3, 310)),
    "h10": ((0.1, 35), None, None),
}


def test_conditions_are_complete():
    scene = load("reference")
    assert set(scene.conditions) == set(CONDITIONS)
    assert set(scene.agreement.fitted) == {"phi0", "phi15", "phi35", "phi60", "phi90"}
    assert set(scene.agreement.held_out) == set(CONDITIONS) - set(scene.agreement.fitted)


@pytest.mark.parametrize("name", CONDITIONS)
def test_condition_values(name):
    scene = load("reference").condition(name)
    misalignment, eccentricity, mass = CONDITIONS[name]
    offset = scene.thrust_offset
    found = [
        (offset.misalignment.axial, offset.misalignment.radial) if offset else (0.0, 0.0),
        (offset.eccentricity.axial, offset.eccentricity.radial) if offset else (0.0, 0.0),
        (scene.mass_offset.eccentricity.axial, scene.mass_offset.eccentricity.radial)
        if scene.mass_offset
        else (0.0, 0.0),
    ]
    wanted = [
        (a * scale, b * DEGREE)
        for (a, b), scale in zip(
            [misalignment or (0, 0), eccentricity or (0, 0), mass or (0, 0)], (DEGREE, 1e-3, 1e-3)
        )
    ]
    assert found == [pytest.approx(pair, rel=1e-13, abs=0.0) for pair in wanted]
    assert (scene.mass_offset is None) == (mass is None)
    assert (scene.thrust_offset is None) == (misalignment is None and eccentricity is None)
    assert (scene.initial is None) == (name != "h10")


def test_h10_starts_off_centre():
    assert load("reference").condition("h10").initial.position.y == pytest.approx(20e-6, rel=1e-14)


def test_provenance_separates_paper_and_assumption():
    provenance = load("reference").provenance
    assert provenance["rail.material.youngs_modulus"] == "paper"
    assert provenance["contact.clearance"] == "assumed"
    assert load("sensitive").provenance["contact.clearance"] == "assumed, harder than the reference"
    assert load("sensitive").provenance["payload.mass"] == provenance["payload.mass"]


def test_another_material_has_all_its_values_and_sources():
    """Titanium expands a third as much as the aluminium it replaces. Control: another thickness
    keeps the material."""
    other, own = load("titanium"), load("reference")
    assert other.rail.material.expansion == pytest.approx(
        8.6e-6
    ) and own.rail.material.expansion == pytest.approx(23.6e-6)
    keys = [f"rail.material.{name}" for name in own.rail.material.model_dump()]
    known = [key for key in keys if key in own.provenance]
    assert len(known) == 5 and all("Ti-6Al-4V" in other.provenance[key] for key in known)
    assert [load("thin").provenance[key] for key in known] == [own.provenance[key] for key in known]
