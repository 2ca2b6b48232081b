"""Scene files that build on others: what is inherited, replaced and dropped."""

import warnings

import pytest

import tipoff
from tipoff import scenes
from tipoff.scenes import SceneError, load, reading


@pytest.fixture
def scene(tmp_path):
    def read(text, name="child.toml"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return load(tmp_path / name)

    return read


def test_values_are_inherited_and_replaced(scene):
    found = scene('extends = "reference"\n[thrust]\npeak = "7 kN"\n')
    assert found.name == "child"
    assert found.hash == load("reference").replace({"thrust.peak": 7000.0}).hash
    assert found.description == load("reference").description


def test_a_chain_beside_the_file_wherever_it_is_read_from(scene, tmp_path, monkeypatch):
    scene('extends = "tiny"\nduration = "25 ms"\n', "base.toml")
    monkeypatch.chdir("/")
    found = scene('extends = "base.toml"\n[payload]\nmass = "11 kg"\n')
    assert found.hash == load("tiny").replace({"duration": 0.025, "payload.mass": 11.0}).hash


def test_a_table_is_dropped(scene):
    assert (
        scene('extends = "reference"\nfriction = "absent"\n').hash
        == load("reference").replace({"friction": None}).hash
    )


ABSENT = ["friction", "gravity", "thermal", "rail.fillet", "payload.size", "rail.damping"]


@pytest.mark.parametrize("key", ABSENT)
@pytest.mark.parametrize("base", ["tiny", "sensitive"])
def test_what_the_base_lacks_may_be_dropped_in_a_file_and_by_an_override(scene, base, key):
    """One file of changes fits several bases. A table that loses its only key is no table."""
    table, _, last = key.rpartition(".")
    text = f'[{table}]\n{last} = "absent"\n' if table else f'{last} = "absent"\n'
    whole = load(base).replace({key: "absent"})
    assert scene(f'extends = "{base}"\n{text}').hash == whole.hash
    assert whole.replace({key: "absent"}).hash == whole.hash
    own = f'extends = "{base}"\n[conditions.own]\n"{key}" = "absent"\n'
    assert scene(own).condition("own").hash == whole.hash


def test_absent_needs_no_base():
    raw = load("tiny").resolved()
    raw["pads"][0]["relief"] = raw["gravity"] = raw["thermal"] = "absent"
    found = scenes.parse(raw, bare_numbers_are_si=True)
    assert found.gravity is None and found.thermal is None
    assert found.hash == load("tiny").replace({"pads.0.relief": "absent"}).hash


@pytest.mark.parametrize("key", ["conditions.h99", "gravitee", "rail.filet"])
def test_a_name_that_is_misspelt_is_refused_both_ways(scene, key):
    table, _, last = key.rpartition(".")
    text = f'[{table}]\n{last} = "absent"\n' if table else f'{last} = "absent"\n'
    for read in (
        lambda: scene(f'extends = "reference"\n{text}'),
        lambda: load("reference").replace({key: "absent"}),
    ):
        with pytest.raises(SceneError, match=key):
            read()


def test_another_kind_of_thrust_replaces_the_inherited_table(scene):
    """Mixed, the peak and width of the Gaussian would be keys that a constant push does not
    have."""
    found = scene(
        'extends = "reference"\n[thrust]\nkind = "constant"\nforce = "1 kN"\nduration = "20 '
        'ms"\narm = "0.1 m"\n'
    )
    assert (found.thrust.kind, found.thrust.force) == ("constant", 1000.0)
    law = '[contact]\nlaw = "linear"\nclearance = "0.1 mm"\nstiffness = "1e4 N/mm"\n'
    assert scene(f'extends = "reference"\n{law}').contact.exponent == 1.0


def test_the_same_kind_is_merged(scene):
    found = scene('extends = "reference"\n[thrust]\nkind = "gaussian"\npeak = "7 kN"\n')
    assert (found.thrust.peak, found.thrust.width) == (7000.0, 0.004)


def test_conditions_are_added_and_replaced_whole(scene):
    """A condition is one variation: keys of an inherited one with the same name must not leak into
    it."""
    found = scene(
        'extends = "reference"\n[conditions.h9]\nthrust_offset = '
        '"absent"\n[conditions.own]\nduration = "50 ms"\n'
    )
    assert found.conditions["h9"] == {"thrust_offset": "absent"}
    assert found.condition("own").duration == 0.05
    assert "phi15" in found.conditions


def test_an_inherited_condition_can_be_dropped_with_its_roles(scene):
    """As the warning says whose value an inherited condition replaces. Control: what is not inherited
    cannot be dropped, and a role that the file itself states is its own."""
    found = scene('extends = "reference"\n[conditions]\nh9 = "absent"\nphi0 = "absent"\n')
    whole = load("reference")
    assert set(whole.conditions) - set(found.conditions) == {"h9", "phi0"}
    assert found.agreement.fitted == tuple(
        name for name in whole.agreement.fitted if name != "phi0"
    )
    assert "h9" not in found.agreement.held_out and "h8" in found.agreement.held_out
    with pytest.raises(SceneError, match="conditions.h99: given 'absent', expected a table"):
        scene('extends = "reference"\n[conditions]\nh99 = "absent"\n')
    own = '[agreement]\nheld_out = ["h8", "h9"]\n[conditions]\nh9 = "absent"\n'
    with pytest.raises(SceneError, match="agreement.held_out: given 'h9'"):
        scene(f'extends = "reference"\n{own}')


def test_a_curve_lies_beside_the_file_that_names_it(scene, tmp_path, monkeypatch):
    (tmp_path / "curve.csv").write_text(
        "time_s,force_N\n0,0\n0.005,3000\n0.01,6000\n0.015,3000\n0.02,0\n"
    )
    text = 'extends = "reference"\n[thrust]\nkind = "measured"\nfile = "curve.csv"\n'
    scene(text, "base.toml")
    monkeypatch.chdir("/")
    found = scene('extends = "base.toml"\n')
    assert found.thrust.describe(0.05)["curve_impulse_Ns"] == pytest.approx(60.0)


def test_a_misspelt_key_in_a_child_is_found(scene):
    with pytest.raises(
        SceneError,
        match="child.toml: contact.clearence: no such key, did you mean contact.clearance",
    ):
        scene('extends = "reference"\n[contact]\nclearence = "1 mm"\n')


def test_a_key_of_another_kind_of_table_is_not_suggested_for_itself(scene):
    with pytest.raises(SceneError, match="no such key in this kind of thrust; another kind has it"):
        scene('extends = "reference"\n[thrust]\nfile = "curve.csv"\n')


def test_a_misspelt_table_is_not_dropped_in_silence(scene):
    with pytest.raises(SceneError, match="frictoin: no such key, did you mean friction"):
        scene('extends = "reference"\nfrictoin = "absent"\n')


def test_values_that_inherited_conditions_replace_are_warned_about(tmp_path):
    path = tmp_path / "child.toml"
    text = (
        'extends = "reference"\n[thrust_offset.misalignment]\naxial = "0.2 deg"\nradial = "9 deg"\n'
    )
    path.write_text(text)
    (axial, radial) = reading.replaced_by_conditions(path)
    assert "thrust_offset.misalignment.axial" in axial and "h4, h5, h6, h7, h8, h9" in axial
    assert "phi0, phi15" in radial
    own = [f'{name}."payload.mass" = "9 kg"' for name in scenes.load("reference").conditions]
    path.write_text(text + "[conditions]\n" + "\n".join(own))
    assert reading.replaced_by_conditions(path) == []
    path.write_text('extends = "reference"\n[payload]\nmass = "9 kg"\n')
    assert reading.replaced_by_conditions(path) == reading.replaced_by_conditions("tiny") == []


def test_python_warns_once_of_values_that_inherited_conditions_replace(tmp_path):
    """Control: a file that sets what no condition does, and a scene of the catalogue, are quiet."""
    path = tmp_path / "child.toml"
    path.write_text('extends = "tiny"\n[thrust_offset.misalignment]\nradial = "9 deg"\n')
    with pytest.warns(UserWarning) as caught:
        scene = tipoff.load(path)
        for name in ("phi15", "phi35"):
            scene.condition(name)
    (warned,) = caught
    assert warned.filename == __file__  # it points at the line of the user
    (words,) = reading.replaced_by_conditions(path)
    assert str(warned.message) == words and "phi0, phi15" in words
    path.write_text('extends = "tiny"\n[payload]\nmass = "9 kg"\n')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert tipoff.load(path).payload.mass == 9.0
        assert tipoff.load("tiny").hash == scenes.load("tiny").hash
