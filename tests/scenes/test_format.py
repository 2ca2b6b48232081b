"""The number of the format of a scene file: stated, absent, and that of another version."""

import tomllib

import pytest
from typer.testing import CliRunner

import tipoff
from tipoff import SceneError
from tipoff.scenes.reading import CATALOG, FORMAT
from tipoff.studies.cli import app

OTHERS = ["2", "0", '"1"', "1.0", "true"]


def written(folder, text, name="mine"):
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return path


def faults(path):
    with pytest.raises(SceneError) as raised:
        tipoff.load(path)
    return [(fault.source, fault.key, fault.given) for fault in raised.value.faults]


@pytest.mark.parametrize("path", sorted(CATALOG.glob("*.toml")), ids=lambda path: path.stem)
def test_every_scene_of_the_catalogue_states_it(path):
    assert tomllib.loads(path.read_text(encoding="utf-8"))["format"] == FORMAT


@pytest.mark.parametrize("asked", [(), ("--rocket",), ("--deployer", "6u")], ids=" ".join)
def test_every_new_scene_states_it(asked, tmp_path):
    file = tmp_path / "own.toml"
    made = CliRunner().invoke(app, ["new", str(file), *asked])
    assert made.exit_code == 0 and tomllib.loads(file.read_text())["format"] == FORMAT


def test_a_file_without_it_is_read_as_the_first_format(tmp_path):
    text = 'extends = "tiny"\nname = "mine"\n'
    without, stated = written(tmp_path, text), written(tmp_path, f"format = 1\n{text}", "stated")
    assert tipoff.load(without).hash == tipoff.load(stated).hash == tipoff.load("tiny").hash
    # Neither result files nor overrides have it: it is of the file.
    assert "format" not in tipoff.load(stated).resolved()
    with pytest.raises(SceneError):
        tipoff.load(stated).replace({"format": 1})


@pytest.mark.parametrize("stated", OTHERS)
def test_another_one_is_refused_before_all_other_faults(stated, tmp_path):
    """Keys of another format would be refused one by one, as if the user had misspelt them."""
    rest = 'extends = "tiny"\n[payload]\nmasss = "3 kg"\n'
    path = written(tmp_path, f"format = {stated}\n{rest}")
    ((source, key, given),) = faults(path)
    assert (source, key) == (str(path), "format")
    assert given == repr(tomllib.loads(f"format = {stated}")["format"])
    # Control: with this format, the fault is that of the key.
    assert ["payload.masss"] == [
        key for _, key, _ in faults(written(tmp_path, f"format = {FORMAT}\n{rest}", "this"))
    ]


def test_that_of_an_inherited_file_is_its_own(tmp_path):
    base = written(tmp_path, 'format = 2\nextends = "tiny"\n', "base")
    above = written(tmp_path, f'format = {FORMAT}\nextends = "base.toml"\n', "above")
    assert faults(above) == [(str(above), "format", f"{base}: 2")]


def test_the_refusal_says_what_is_read_and_what_to_change(tmp_path):
    with pytest.raises(SceneError, match=r"install a version.*write format = 1 and change"):
        tipoff.load(written(tmp_path, 'format = 2\nextends = "tiny"\n'))


def test_tables_in_python_may_have_it():
    raw = tipoff.load("tiny").resolved()
    found = tipoff.parse({"format": FORMAT} | raw, bare_numbers_are_si=True)
    assert found.hash == tipoff.load("tiny").hash
    with pytest.raises(SceneError, match="format"):
        tipoff.parse({"format": 2} | raw, bare_numbers_are_si=True)
