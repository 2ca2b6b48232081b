"""A format is one file: its declaration is found, in the program and in the keys of runs."""

import sys

import pytest

from tipoff.formats.declared import Format, declared, of_suffix

ROOMS = ("curves", "logs", "meshes", "sections", "thrusts")
READER = """from tipoff.formats.declared import Format

FORMATS = (Format("{name}", lambda path: "{name}", [("`.{name}`",)], suffixes=(".{name}",){more}),)
"""


def room(folder, name, more="", **files):
    """A package whose modules declare a format each."""
    (folder / name).mkdir()
    (folder / name / "__init__.py").write_text("")
    (folder / name / "shared.py").write_text("")  # declares none
    for each in ("b", "a"):
        (folder / name / f"{each}.py").write_text(READER.format(name=each, more=more))
    for each, text in files.items():
        (folder / name / f"{each}.py").write_text(text)
    return name


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith("a_room")]:
        del sys.modules[name]
    declared.cache_clear()


@pytest.mark.parametrize("name", ROOMS)
def test_every_room_has_formats_and_their_rows(name):
    """All rows of a room have the same cells, or its table would be none."""
    found = declared(f"tipoff.formats.{name}")
    assert len({len(row) for each in found for row in each.rows}) == 1
    assert [each.is_any_other for each in found[:-1]] == [False] * (len(found) - 1)


def test_a_file_in_the_folder_is_a_format(folder):
    package = room(folder, "a_room", c=READER.format(name="c", more=", is_any_other=True"))
    assert [each.name for each in declared(package)] == ["a", "b", "c"]
    assert of_suffix(declared(package), "rail.B").read("") == "b"
    assert of_suffix(declared(package), "rail").name == "c"


def test_a_file_that_no_format_reads_has_none(folder):
    assert of_suffix(declared(room(folder, "a_room_without")), "rail.c") is None


def test_a_declaration_of_another_kind_is_refused(folder):
    class OfAnotherRoom(Format):
        pass

    with pytest.raises(ValueError, match="is a OfAnotherRoom, and a is none"):
        declared(room(folder, "a_room_of_kinds"), OfAnotherRoom)


@pytest.mark.parametrize(
    "more", [{"c": READER.format(name="a", more="")}, {"more": ", is_any_other=True"}]
)
def test_two_formats_of_one_file_are_refused(folder, more):
    with pytest.raises(ValueError, match="two formats of a_room"):
        declared(room(folder, f"a_room_{len(str(more))}", **more))
