"""Groups that a reader leaves out, or reads in part: a scene that names one is refused with the reason.
Two cubes, written by hand; other names than of walls, which the scene gives in ``groups``."""

import numpy as np
import pytest

from tipoff.highfi.mesh.asked import Asked
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh, read

POINTS = [(x, y, z) for x in (0, 1, 2) for y, z in ((0, 0), (1, 0), (1, 1), (0, 1))]
CUBES = ((1, 2, 3, 4, 5, 6, 7, 8), (5, 6, 7, 8, 9, 10, 11, 12))
BOTTOM, TOP = ((1, 2, 6, 5), (5, 6, 10, 9)), ((4, 8, 7, 3), (8, 12, 11, 7))
GROUPS = {"mount": ("bolts",), "contact": ("walls",)}


def rows(lines, form="{:10d}") -> str:
    return "\n".join("".join(form.format(number) for number in line) for line in lines)


def dyna(sets: str) -> str:
    nodes = "\n".join(f"{n:8d}{x:16.5f}{y:16.5f}{z:16.5f}" for n, (x, y, z) in enumerate(POINTS, 1))
    solids = rows(((n, 1, *cube) for n, cube in enumerate(CUBES, 1)), "{:8d}")
    walls = f"*SET_SEGMENT_TITLE\nwalls\n{4:10d}\n{rows(TOP)}"
    return f"*KEYWORD\n*NODE\n{nodes}\n*ELEMENT_SOLID\n{solids}\n{walls}\n{sets}\n*END\n"


def abaqus(sets: str) -> str:
    nodes = "\n".join(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in enumerate(POINTS, 1))
    solids = "\n".join(", ".join(map(str, (n, *cube))) for n, cube in enumerate(CUBES, 1))
    head = f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8, ELSET=rail\n{solids}\n"
    return f"{head}*SURFACE, NAME=walls\nrail, S5\n{sets}\n"


def nastran(sets: str) -> str:
    grids = "\n".join(f"GRID,{n},,{x}.,{y}.,{z}." for n, (x, y, z) in enumerate(POINTS, 1))
    solids = "\n".join(
        f"CHEXA,{n},1,{','.join(map(str, cube[:6]))}\n,{cube[6]},{cube[7]}"
        for n, cube in enumerate(CUBES, 1)
    )
    return f"{sets}BEGIN BULK\n{grids}\n{solids}\nENDDATA\n"


def found(folder, name: str, text: str, groups=GROUPS) -> RailMesh:
    path = folder / name
    path.write_text(text)
    return read(path, Asked(groups=groups))


def refusal(folder, name: str, text: str, groups=GROUPS) -> str:
    with pytest.raises(MeshError) as fault:
        found(folder, name, text, groups)
    return str(fault.value)


ADDED = {
    "a sum of segments": f"*SET_SEGMENT\n{7:10d}\n{rows(BOTTOM[:1])}\n*SET_SEGMENT\n{8:10d}\n{rows(BOTTOM)}\n"
    f"*SET_SEGMENT_ADD_TITLE\nbolts\n{9:10d}\n{7:10d}{8:10d}",
    "a sum of sums of nodes": f"*SET_NODE_ADD_TITLE\nbolts\n{9:10d}\n{7:10d}\n"
    f"*SET_NODE_ADD\n{7:10d}\n{5:10d}{6:10d}\n*SET_NODE_LIST\n{5:10d}\n{rows([(1, 5, 9)])}\n"
    f"*SET_NODE_LIST\n{6:10d}\n{rows([(2, 6, 10)])}",
}


@pytest.mark.parametrize("name", ADDED)
def test_sets_that_add_up_others(tmp_path, name):
    mesh = found(tmp_path, "rail.k", dyna(ADDED[name]))
    assert {tuple(row) for row in np.sort(mesh.surfaces["mount"] + 1).tolist()} == {
        (1, 2, 5, 6),
        (5, 6, 9, 10),
    }
    assert len(mesh.surfaces["mount"]) == 2


@pytest.mark.parametrize(
    "sets, words",
    [
        (
            f"*SET_SEGMENT_GENERAL_TITLE\nbolts\n{3:10d}\nSEG {1:6d}",
            "*SET_SEGMENT_GENERAL_TITLE is not read; write the set as a list",
        ),
        (f"*SET_NODE_ADD_TITLE\nbolts\n{3:10d}\n{8:10d}", "node set 8 is not there as a list"),
        (f"*SET_NODE_ADD_TITLE\nbolts\n{3:10d}\n{3:10d}", "node set 3 contains itself"),
    ],
)
def test_sets_of_lsdyna(tmp_path, sets, words):
    said = refusal(tmp_path, "rail.k", dyna(sets))
    assert "group 'bolts' is not read: line" in said and words in said


def test_a_set_without_a_title_is_named_by_its_number(tmp_path):
    general = f"*SET_NODE_GENERAL\n{3:10d}\nNODE {1:6d}"
    said = refusal(tmp_path, "rail.k", dyna(general), GROUPS | {"mount": ("Node set 3",)})
    assert "group 'Node set 3' is not read: line" in said


def test_sums_of_sums_end(tmp_path):
    """Each set adds the next one eight times: 8^30 ways through them."""
    sums = "\n".join(f"*SET_NODE_ADD\n{n:10d}\n{rows([[n + 1] * 8])}" for n in range(100, 130))
    leaf = f"*SET_NODE_LIST_TITLE\nbolts\n{130:10d}\n{rows([(1, 5, 9, 2, 6, 10)])}"
    groups = GROUPS | {"mount": ("node set 100",)}
    assert len(found(tmp_path, "rail.k", dyna(f"{sums}\n{leaf}"), groups).surfaces["mount"]) == 2


@pytest.mark.parametrize(
    "sets, words",
    [
        ("*SURFACE, NAME=bolts\n1, S3\n2, S9", "face S9 of hexahedron elements; S1 to S6 are read"),
        ("*SURFACE, NAME=bolts\n1, S3\nothers, S3", "no element set OTHERS"),
        ("*SURFACE, NAME=bolts\nrail,", "face of no name"),
        ("*SURFACE, NAME=bolts, COMBINE=UNION\nwalls", "*SURFACE with COMBINE=UNION; write its"),
        ("*SURFACE, NAME=bolts, TYPE=CUTTING SURFACE\n1", "*SURFACE with CUTTING SURFACE"),
        ("*NSET, NSET=bolts\n1, 2, 5, 6, others", "no node set OTHERS"),
    ],
)
def test_sets_of_abaqus_in_part_are_refused(tmp_path, sets, words):
    """A half of a mount would be a softer rail without a word. Control: a scene that does not name the
    group is read."""
    said = refusal(tmp_path, "rail.inp", abaqus(sets))
    assert "group 'bolts' is not read: line" in said and words in said
    held = abaqus(sets + "\n*SURFACE, NAME=held\nrail, S3")
    mesh = found(tmp_path, "rail.inp", held, GROUPS | {"mount": ("held",)})
    assert len(mesh.surfaces["mount"]) == 2


def test_a_combined_surface_with_the_name_of_a_mount(tmp_path):
    text = abaqus("*SURFACE, NAME=mount, COMBINE=UNION\nwalls\n*SURFACE, NAME=contact\nrail, S5")
    assert "group 'mount' is not read" in refusal(tmp_path, "rail.inp", text, {})


def test_sets_of_nastran(tmp_path):
    sets = "SET 4 = 1 THRU 10 EXCEPT 3\nSET 5 = 3,4,7,8,11,12\n"
    groups = {"mount": ("set 4 of grids",), "contact": ("set 5 of grids",)}
    said = refusal(tmp_path, "rail.bdf", nastran(sets), groups)
    assert "group 'set 4 of grids' is not read: line 1: a set with EXCEPT; write" in said
