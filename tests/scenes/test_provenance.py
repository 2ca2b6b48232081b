"""What is overridden is the user's: through a program, a file that extends another, and a
condition."""

import pytest

from tests.scenes.support import small
from tipoff.scenes import SceneError, catalog, load, parse
from tipoff.scenes.provenance import nearest
from tipoff.studies.render import document
from tipoff.studies.report import inputs

BOX = "assumed: box 0.35 x 0.20 x 0.20 m with a real payload's asymmetry"
PAPER = "paper's group, Syst. Eng. Electron. 47(8) 2696, 2025"


@pytest.fixture
def read(tmp_path):
    def child(text, name="child.toml"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return load(tmp_path / name)

    return child


def changed(scene, *keys):
    return [nearest(scene.provenance, key) for key in keys]


def test_an_overridden_key_is_the_users_and_others_keep_their_origin():
    base = load("reference")
    found = base.replace({"payload.mass": "12 kg"})
    assert changed(base, "payload.mass", "platform.mass") == [PAPER, PAPER]
    assert changed(found, "payload.mass", "platform.mass") == ["user", PAPER]
    assert {
        key: text for key, text in found.provenance.items() if base.provenance.get(key) != text
    } == {"payload.mass": "user"}


def test_a_table_keeps_its_text_and_names_the_part_of_the_user():
    found = load("reference").replace({"payload.inertia.xx": 0.07})
    assert changed(found, "payload.inertia.xx", "payload.inertia.yy", "payload.inertia.xz") == [
        "user",
        BOX,
        BOX,
    ]
    assert nearest(found.provenance, "payload.inertia") == f"{BOX}, in part user"
    twice = found.replace({"payload.inertia.yy": 0.14})
    assert changed(twice, "payload.inertia.xx", "payload.inertia.yy", "payload.inertia.xz") == [
        "user",
        "user",
        BOX,
    ]
    assert nearest(twice.provenance, "payload.inertia") == f"{BOX}, in part user"


def test_an_entry_of_a_list_and_the_table_around_a_table():
    found = load("reference").replace(
        {"pads.0.relief": "10 um", "rail.material.density": "2700 kg/m**3"}
    )
    assert changed(found, "pads.0.relief", "pads.0.length", "pads.7.relief") == [
        "user",
        "assumed",
        "assumed",
    ]
    assert changed(found, "rail.material.density", "rail.material.youngs_modulus", "rail.leg") == [
        "user",
        "paper",
        "assumed",
    ]
    assert nearest(found.provenance, "pads") == "assumed, in part user"
    assert "8 pads (assumed, in part user)" in document.markdown(inputs.scene_tables(found))


def test_a_replaced_table_loses_the_provenance_of_its_keys():
    friction = {"static": 0.3, "dynamic": 0.3, "static_speed": "1 mm/s", "dynamic_speed": "2 mm/s"}
    assert changed(
        load("reference").replace({"friction": friction}), "friction.static", "friction"
    ) == ["user", "user"]
    assert changed(load("reference").replace({"friction": None}), "friction.static") == [None]


def test_given_provenance_is_kept():
    found = load("reference").replace(
        {"payload.mass": "12 kg", "provenance.payload.mass": "measured"}
    )
    assert nearest(found.provenance, "payload.mass") == "measured"
    table = load("reference").replace(
        {"payload.mass": "12 kg", "provenance": {"payload": {"mass": "weighed"}}}
    )
    assert table.provenance == {"payload.mass": "weighed"}


def test_a_file_that_extends_another(read):
    found = read(
        'extends = "reference"\n[payload]\nmass = "12 kg"\n[rail]\nend = "140 mm"\n[gravity]\nz = '
        '"-9.81 m/s**2"\n'
    )
    assert changed(found, "payload.mass", "rail.end", "rail.start", "gravity.z", "thrust.arm") == [
        "user",
        "user",
        "assumed",
        "user",
        load("reference").provenance["thrust.arm"],
    ]
    given = read(
        'extends = "reference"\n[payload]\nmass = "12 kg"\n'
        '[rail.material]\ndensity = "2700 kg/m**3"\nyoungs_modulus = "70 GPa"\n'
        '[provenance]\npayload.mass = "weighed"\n"rail.material" = "datasheet"\n'
    )
    assert changed(
        given,
        "payload.mass",
        "rail.material.density",
        "rail.material.youngs_modulus",
        "rail.material.yield_strength",
        "rail.end",
    ) == ["weighed", "datasheet", "datasheet", "handbook, 7075-T6", "assumed"]


def test_a_chain_of_files_and_a_table_of_another_kind(read):
    read(
        'extends = "reference"\n[payload]\nmass = "12 kg"\n[provenance]\n"payload.mass" = '
        '"weighed"\n',
        "base.toml",
    )
    assert changed(
        read('extends = "base.toml"\n[payload.inertia]\nxx = "0.07 kg*m**2"\n'), "payload.mass"
    ) == ["weighed"]
    assert changed(read('extends = "base.toml"\n[payload]\nmass = "13 kg"\n'), "payload.mass") == [
        "user"
    ]
    push = read(
        'extends = "reference"\n[thrust]\nkind = "constant"\nforce = "1 kN"\nduration = "20 '
        'ms"\narm = "0.1 m"\n'
    )
    assert changed(push, "thrust.arm", "thrust.force", "thrust.reaction") == ["user", "user", None]


def test_a_condition():
    scene = load("reference")
    assert nearest(scene.provenance, "thrust_offset.misalignment.radial") == "paper, Table 1"
    found = scene.condition("phi35")
    assert changed(
        found, "thrust_offset.misalignment.radial", "thrust_offset.misalignment.axial"
    ) == ["user", "paper, Table 1"]


@pytest.mark.parametrize("name", catalog())
def test_the_catalogue_has_the_provenance_of_its_own_changes(name):
    assert not {key: text for key, text in load(name).provenance.items() if "user" in text}


def test_origin_is_no_input_and_is_written_and_read_back():
    base, found = (
        load("reference"),
        load("reference").replace({"payload.inertia.xx": 0.066, "pads.0.relief": "20 um"}),
    )
    assert found.hash == base.hash
    again = parse(found.resolved(), bare_numbers_are_si=True)
    assert again.provenance == found.provenance
    assert "| user |" in document.markdown(inputs.scene_tables(found))


def test_a_misspelt_key_is_one_fault(read):
    for call in (
        lambda: read('extends = "reference"\n[payload]\nweight = "12 kg"\n'),
        lambda: load("reference").replace({"payload.weight": "12 kg", "conditions.own": {}}),
    ):
        with pytest.raises(SceneError) as caught:
            call()
        assert [fault.key for fault in caught.value.faults] == ["payload.weight"]
    with pytest.raises(SceneError, match="provenance.payload.weight"):
        parse(small(provenance={"payload.weight": "user"}))
