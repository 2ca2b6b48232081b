"""What bulk data of Nastran and OptiStruct say about sets, coordinate systems and bodies, and fields
between blanks."""

import numpy as np
import pytest

from tests.formats.meshes import seeds
from tests.formats.meshes.test_mesh_files import WHOLE, areas, check_rail, lowest, read_text
from tests.highfi.mesh.test_file_elements import plate
from tipoff.highfi.mesh.asked import Asked
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator

TEXT = seeds.nastran()
LINES = TEXT.split("\n")
# the plate without its shells and names
SOLIDS = "\n".join(line for line in LINES if not line.startswith(("CQUAD4", "PSHELL", "$ Femap")))
NODES = {
    name: sorted({int(node) for row in facets + 1 for node in row})
    for name, facets in seeds.rail().surfaces.items()
}


def set1(number: int, name: str) -> str:
    """A card SET1 with its continuations, in fields of eight columns."""
    fields = [str(number), *map(str, NODES[name])]
    rows = [fields[at : at + 8] for at in range(0, len(fields), 8)]
    firsts = ["SET1", *["+"] * len(rows)]
    return "".join(
        f"{first:8}" + "".join(f"{field:>8}" for field in row) + "\n"
        for first, row in zip(firsts, rows)
    )


def optistruct(number: int, name: str) -> str:
    """A card SET with the name that HyperMesh writes before it."""
    rows = [NODES[name][at : at + 8] for at in range(0, len(NODES[name]), 8)]
    return (
        f'$HMSET {number:8} {1:8} "{name}"\n'
        f"{'SET':8}{number:8}{'GRID':>8}{'LIST':>8}\n"
        + "".join("+       " + "".join(f"{node:8}" for node in row) + "\n" for row in rows)
    )


GRIDS = {"mount": ("set 4 of grids",), "contact": ("set 5 of grids",)}
SHELLS = {"mount": ("set 4 of elements",), "contact": ("set 5 of elements",)}


def in_case_control(sets: str, text: str) -> str:
    return text.replace("CEND\n", f"CEND\n{sets}")


def numbers(name: str) -> str:
    return ", ".join(map(str, NODES[name]))


CASES = {
    "case control, elements": (
        in_case_control("SET 4 = 9 THRU 14, 15,\n 16\n  set 5 = 17,18\n", TEXT),
        SHELLS,
    ),
    "case control, grids": (
        in_case_control(f"SET 4 = {numbers('mount')}\nSET 5={numbers('contact')}\n", SOLIDS),
        GRIDS,
    ),
    "SET1": (SOLIDS.replace("ENDDATA", set1(4, "mount") + set1(5, "contact") + "ENDDATA"), GRIDS),
    "SET1 with a range": (
        TEXT.replace("ENDDATA", "SET1,4,9,THRU,16\nSET1,5,17,18\nENDDATA"),
        SHELLS,
    ),
    "SET of OptiStruct": (
        SOLIDS.replace(
            "ENDDATA", optistruct(4, "MOUNT".lower()) + optistruct(5, "contact") + "ENDDATA"
        ),
        {},
    ),
    "properties by number": (
        "\n".join(line for line in LINES if "Femap" not in line),
        {"mount": ("property 2",), "contact": ("Property 3",)},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_sets_and_properties_are_groups(tmp_path, case):
    text, groups = CASES[case]
    (tmp_path / "rail.bdf").write_text(text)
    check_rail(read(tmp_path / "rail.bdf", Asked(groups=groups)))


def in_system(points: np.ndarray, numbers: str, number: int = 7) -> str:
    """The plate with the coordinates of its grids in a system of their own."""
    text = []
    rows = iter(points)
    for line in LINES:
        if line.startswith("GRID"):
            x, y, z = next(rows)
            line = f"GRID,{line[8:16].strip()},{number},{x:.12g},{y:.12g},{z:.12g}"
        text.append(line)
    return "\n".join(text).replace("ENDDATA", f"{numbers}\nENDDATA")


def test_grids_in_rectangular_systems_are_placed(tmp_path):
    """CORD2R 7 has its origin at (1, 2, 3), z along the basic x and x along the basic y; CORD2R 8 is
    given in system 7, turned by 90 degrees about its z. Control: in the basic system the plate lies
    elsewhere."""
    points, *_ = seeds.rail()
    turn = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    seven = "CORD2R,7,,1.,2.,3.,2.,2.,3.\n+,1.,3.,3."
    inside = (points - [1.0, 2.0, 3.0]) @ turn.T
    mesh = read_text(tmp_path, in_system(inside, seven), "rail.bdf")
    check_rail(mesh)
    assert mesh.points.min(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    eight = seven + "\nCORD2R,8,7,0.,0.,0.,0.,0.,1.\n+,0.,1.,0."
    quarter = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    mesh = read_text(tmp_path, in_system(inside @ quarter.T, eight, 8), "rail.bdf")
    check_rail(mesh)
    assert mesh.points.max(axis=0) == pytest.approx([0.04, 0.02, 0.008], abs=1e-9)
    basic = read_text(tmp_path, in_system(inside, seven, 0), "rail.bdf")
    assert basic.points.min() < -1.0
    usual = in_system(inside, "GRDSET,,7\n" + seven).replace(",7,-", ",,-")
    assert read_text(tmp_path, usual, "rail.bdf").points.min() > -1e-9


@pytest.mark.parametrize(
    "cards, why",
    [
        ("", "coordinates in system 7, which the file lacks"),
        ("CORD2C,7,,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.", "system 7, a CORD2C; write them in the basic"),
        ("CORD1R,7,1,2,3", "system 7, a CORD1R"),
        ("CORD2R,7,,0.,0.,0.,0.,0.,1.\n+,0.,0.,2.", "three points of CORD2R 7 on one line"),
        ("CORD2R,7,7,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.", "system 7 is given in itself"),
        ("SET1,4,9,THRU", "a set with THRU and no number behind it"),
        ("SET1,4,x", "'X' in place of an integer"),
    ],
)
def test_what_a_file_gets_wrong_is_named(tmp_path, cards, why):
    with pytest.raises(MeshError, match=f"as a file of Nastran: line .*{why}"):
        read_text(tmp_path, in_system(seeds.rail().points, cards), "rail.bdf")


def test_a_free_card_may_be_in_one_line(tmp_path):
    """Its ninth data field is no mark of a continuation. Control: a line that has a mark."""
    lines, whole, marked = TEXT.split("\n"), [], []
    place = 0
    while place < len(lines):
        if not lines[place].startswith("CHEXA"):
            whole.append(lines[place])
            marked.append(lines[place])
            place += 1
            continue
        first, second = lines[place], lines[place + 1]
        fields = [first[at : at + 8].strip() for at in range(0, 72, 8)]
        rest = [second[at : at + 8].strip() for at in (8, 16)]
        whole.append(",".join([*fields, *rest]))
        marked += [",".join([*fields, "+A"]), ",".join(["+A", *rest])]
        place += 2
    assert any(line.count(",") == 10 for line in whole)
    for number, made in enumerate((whole, marked)):
        (tmp_path / f"{number}.bdf").write_text("\n".join(made))
        check_rail(read(tmp_path / f"{number}.bdf"))


def test_a_body_is_a_property(tmp_path):
    """Beside the plate there is a wedge of another property."""
    text = TEXT.replace("ENDDATA", "CPENTA,99,9,1,2,3,4,5,6\nENDDATA")
    (tmp_path / "rail.bdf").write_text(text)
    check_rail(read(tmp_path / "rail.bdf", Asked(body="property 1")))
    with pytest.raises(MeshError, match="solid elements of other types: wedge"):
        read(tmp_path / "rail.bdf")


@pytest.mark.gmsh
@pytest.mark.parametrize("kind", ["hexahedron20", "tetra", "tetra10"])
@pytest.mark.parametrize("form", [0, 1, 2])
def test_elements_of_all_orders_as_gmsh_writes_them(tmp_path, kind, form):
    """In free, small and large fields; gmsh gives the numbers of physical groups as properties."""
    with generator.session("plate") as gmsh:
        plate(gmsh, kind)
        gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
        gmsh.option.setNumber("Mesh.BdfFieldFormat", form)
        for suffix in ("bdf", "msh"):
            gmsh.write(str(tmp_path / f"plate.{suffix}"))
    groups = {"mount": ("property 1",), "contact": ("property 2",)}
    mesh, own = read(tmp_path / "plate.bdf", Asked(groups=groups)), read(tmp_path / "plate.msh")
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-4)  # columns of eight characters
    assert len(mesh.points) == len(own.points) and len(mesh.cells) == len(own.cells)
    assert lowest(mesh) == pytest.approx(lowest(own), rel=1e-3)


def free(card: str) -> str:
    """A card of eight columns with single blanks between its fields."""
    fields = card.split()
    return " ".join([*fields[:2], "0", *fields[2:]] if fields[0].startswith("GRID") else fields)


@pytest.mark.parametrize("kind", ["GRID", "CHEXA", "CQUAD4", "PSHELL", "+"])
def test_single_cards_of_nastran_may_have_blanks_between_fields(tmp_path, kind):
    """Beside cards in columns. A continuation follows its card, with a mark or without."""
    lines = seeds.nastran().split("\n")
    also = ("CHEXA", "+") if kind in ("CHEXA", "+") else (kind,)
    lines = [free(line) if line.startswith(also) else line for line in lines]
    if kind == "+":
        lines = [f"{line} +C" if line.startswith("CHEXA") else line for line in lines]
        lines = [f"+C{line[1:]}" if line.startswith("+ ") else line for line in lines]
    check_rail(read_text(tmp_path, "\n".join(lines), "rail.bdf"))
    small = [line.lower() if line.startswith(also) else line for line in lines]
    check_rail(read_text(tmp_path, "\n".join(small), "rail.bdf"))
    tabs = [line.replace(" ", "\t") if line.startswith(also) else line for line in lines]
    check_rail(read_text(tmp_path, "\n".join(tabs), "rail.bdf"))


def test_cards_of_sixteen_columns_may_have_blanks_between_fields(tmp_path):
    lines = [
        free(line) if line.startswith("GRID") else " ".join(line.split())
        for line in seeds.nastran(16).split("\n")
    ]
    assert "GRID* 1 0 0.0000 0.0000" in lines
    check_rail(read_text(tmp_path, "\n".join(lines), "rail.nas"))


def test_a_grid_between_blanks_has_all_its_fields(tmp_path):
    """The system of a grid is empty in most files, which blanks cannot say."""
    lines = [
        " ".join(line.split()) if line.startswith("GRID") else line
        for line in seeds.nastran().split("\n")
    ]
    with pytest.raises(MeshError, match="GRID with 4 fields between blanks: .* commas stand for"):
        read_text(tmp_path, "\n".join(lines), "rail.bdf")
