"""A scene as an object: overrides, immutability, hashes, and writing to and reading from a result
file."""

import copy
import json

import pytest
from pydantic import ValidationError

from tests.scenes.support import CONTACT, FRICTION, small
from tipoff.scenes import SceneError, load, parse
from tipoff.scenes.effects.registry import EFFECTS


def test_text_carries_units_and_a_number_is_si():
    scene = parse(small(contact=CONTACT))
    for value in ("0.05 mm", "50 um", 5e-5):
        assert scene.replace({"contact.clearance": value}).contact.clearance == pytest.approx(
            5e-5, rel=1e-14
        )


def test_replace_reaches_into_lists_and_makes_tables():
    scene = parse(small())
    assert scene.replace({"pads.0.relief": "20 um"}).pads[0].relief == pytest.approx(2e-5)
    assert scene.replace({"pads.0.position.1": 0.2}).pads[0].position == (0.0, 0.2, 0.1)
    assert scene.replace({"gravity.z": "-9.81 m/s**2"}).gravity.z == -9.81
    assert scene.replace({"gravity": {"z": -9.81}}).gravity.z == -9.81


@pytest.mark.parametrize("nothing", [None, "absent"])
def test_a_table_is_dropped(nothing):
    scene = parse(small(contact=CONTACT, friction=FRICTION))
    assert scene.replace({"friction": nothing}).friction is None
    assert scene.replace({"friction": nothing}).hash == parse(small(contact=CONTACT)).hash
    assert scene.replace({"gravity": nothing}).hash == scene.hash


def test_dropping_the_last_key_drops_the_table():
    """An empty table is present without meaning: friction-free and frictional kernels must not
    differ by it."""
    scene = load("reference").replace({"thrust_offset.misalignment": None})
    assert scene.thrust_offset is None
    assert parse(small()).replace({"initial.position.y": None}).initial is None


def test_replace_reports_every_fault_and_changes_nothing():
    scene = parse(small(contact=CONTACT))
    before = scene.hash
    with pytest.raises(SceneError) as caught:
        scene.replace(
            {
                "contact.clearance": "-1 mm",
                "payload.mas": 3.0,
                "frictoin": None,
                "pads.4.relief": 0.0,
                "duration": "2 m",
            }
        )
    assert {fault.key for fault in caught.value.faults} == {
        "contact.clearance",
        "payload.mas",
        "frictoin",
        "pads.4.relief",
        "duration",
    }
    assert all(fault.source.startswith("override of") for fault in caught.value.faults)
    assert scene.hash == before


def test_replace_does_not_share_its_values():
    values = {"z": -9.81}
    scene = parse(small()).replace({"gravity": values})
    values["z"] = 0.0
    assert scene.replace({"duration": 0.01}).gravity.z == -9.81


def test_a_scene_does_not_share_its_mapping():
    raw = small()
    scene = parse(raw)
    raw["payload"]["mass"] = "1 kg"
    assert scene.replace({"duration": 0.01}).payload.mass == 10.0


@pytest.mark.parametrize("path", ["duration", "payload.mass", "payload.inertia.xx", "thrust.peak"])
def test_immutable(path):
    target = parse(small())
    *parents, last = path.split(".")
    for part in parents:
        target = getattr(target, part)
    with pytest.raises(ValidationError):
        setattr(target, last, 1.0)


def test_lists_are_tuples():
    scene = load("reference")
    assert all(
        isinstance(item, tuple)
        for item in (scene.pads, scene.pads[0].normals, scene.rail.mounts, scene.agreement.fitted)
    )


def test_names_do_not_change_the_hash():
    base = parse(small())
    other = parse(
        small(
            name="other",
            description="text",
            provenance={"payload.mass": "measured"},
            conditions={"a": {"duration": "20 ms"}},
            agreement={"fitted": ["a"]},
        )
    )
    assert other.hash == base.hash


def test_units_and_key_order_do_not_change_the_hash():
    raw = small(payload__mass="10000 g", rail__start="-100 mm", thrust__peak="6000 N")
    assert parse(dict(reversed(raw.items()))).hash == parse(small()).hash


def _numbers(value, path=""):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _numbers(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _numbers(item, f"{path}.{index}")
    elif isinstance(value, float):
        yield path, value


def test_every_physical_number_changes_the_hash():
    scene = (
        load("reference")
        .condition("h9")
        .replace({"gravity.z": -9.81, "initial.position.y": 1e-5, "thermal.mean": 20.0})
    )
    # As a number, because its unit in text belongs to one exponent.
    scene = scene.replace({"contact.stiffness": scene.contact.stiffness})
    keys = [
        (key, value)
        for key, value in _numbers(scene.resolved())
        if key.split(".")[0] not in ("conditions", "agreement", "flight")
    ]
    assert len(keys) > 100
    hashes = {scene.replace({key: value * 1.0001 if value else 1e-6}).hash for key, value in keys}
    assert len(hashes | {scene.hash}) == len(keys) + 1


@pytest.mark.parametrize(
    "scene", [load("reference"), load("reference").condition("h9"), load("tiny"), parse(small())]
)
def test_resolved_reads_back(scene):
    raw = json.loads(json.dumps(scene.resolved(), allow_nan=False))
    back = parse(raw, bare_numbers_are_si=True)
    assert back.hash == scene.hash
    assert back.resolved() == scene.resolved()
    assert back.conditions == scene.conditions


def test_a_scene_can_be_copied_to_a_worker():
    scene = load("reference").condition("phi35")
    assert (
        copy.deepcopy(scene).replace({"duration": 0.01}).hash
        == scene.replace({"duration": 0.01}).hash
    )


def test_nested_and_dotted_conditions_mean_the_same():
    """Without quotes TOML nests the keys; taken as a whole table they would silently reset the
    axial angle to zero."""
    dotted = small(
        thrust_offset={"misalignment": {"axial": "0.1 deg"}},
        conditions={"a": {"thrust_offset.misalignment.radial": "15 deg"}},
    )
    nested = copy.deepcopy(dotted) | {
        "conditions": {"a": {"thrust_offset": {"misalignment": {"radial": "15 deg"}}}}
    }
    assert parse(nested).condition("a").hash == parse(dotted).condition("a").hash
    assert parse(nested).condition("a").thrust_offset.misalignment.axial > 0.0


def test_absent_effects():
    assert parse(small()).absent_effects() == [effect.key for effect in EFFECTS]
    assert parse(small(contact=CONTACT)).absent_effects() == [
        effect.key for effect in EFFECTS if effect.key != "contact"
    ]


def test_unknown_condition_names_the_known_ones():
    with pytest.raises(SceneError, match="one of phi0, phi15"):
        load("reference").condition("phi16")
