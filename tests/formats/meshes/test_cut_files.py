"""A mesh whose file ends inside a number: element 30 is not taken for element 305."""

import pytest

from tests.formats.meshes import forms
from tests.formats.meshes.test_mesh_files import check_rail
from tipoff.highfi.mesh.rail_mesh import MeshError, read

# a line with which a file may end before its last data
ENDS = ("*END\n", "ENDDATA\n")
TEXTS = ("Abaqus", "Nastran small", "Nastran free", "LS-DYNA standard", "LS-DYNA free")


def without_end(form, folder):
    """The file of a rail whose last line is data, and its text."""
    path = forms.write(form, folder / "rail")
    text = path.read_text()
    for end in ENDS:
        text = text.partition(end)[0]
    path.write_text(text)
    return path, text


@pytest.mark.parametrize("form", TEXTS)
def test_a_file_that_ends_inside_its_last_line_is_refused(tmp_path, form):
    """Control: the whole text is the rail."""
    path, text = without_end(form, tmp_path)
    check_rail(read(path))
    for lost in (1, 2, 3):
        path.write_text(text[:-lost])
        with pytest.raises(MeshError, match="has no end"):
            read(path)


@pytest.mark.parametrize("form", ["Nastran small", "LS-DYNA standard"])
def test_a_file_with_its_last_keyword_is_whole(tmp_path, form):
    path = forms.write(form, tmp_path / "rail")
    text = path.read_text()
    path.write_text(text[: max(text.find(end) + len(end) for end in ENDS) - 1])
    check_rail(read(path))
