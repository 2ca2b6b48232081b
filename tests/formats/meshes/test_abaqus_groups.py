"""What input files of Abaqus and CalculiX say about nodes, faces and bodies, beside sets of shells."""

import shutil
import subprocess

import numpy as np
import pytest

from tests.formats.meshes import seeds
from tests.formats.meshes.test_mesh_files import LISTED, WHOLE, areas, check_rail, lowest, read_text
from tests.highfi.mesh.test_file_elements import plate
from tipoff.highfi.mesh.asked import Asked
from tipoff.highfi.mesh.rail_mesh import MeshError, read
from tipoff.meshes import generator

SOLIDS = LISTED[: LISTED.index("*ELEMENT, TYPE=S4")]
NODES = {
    name: sorted({int(node) for row in facets + 1 for node in row})
    for name, facets in seeds.rail().surfaces.items()
}


def listed(name: str) -> str:
    """Numbers of the nodes of a surface, as data."""
    return ", ".join(map(str, NODES[name])) + "\n"


BOTH = "*NSET, NSET=Contact\n" + listed("contact")
CASES = {
    "two sets": "*NSET, NSET=mount\n" + listed("mount") + BOTH,
    "a set of sets and a range": "*NSET, NSET=a, GENERATE\n1, 9, 1\n*NSET, NSET=b\n"
    + listed("mount")
    + "*NSET, NSET=mount\nb\n"
    + BOTH,
    "surfaces of nodes": "*NSET, NSET=held\n"
    + listed("mount")
    + "*SURFACE, TYPE=NODE, NAME=mount\nheld, 1.\n*SURFACE, NAME=contact, TYPE=NODE\n"
    + "\n".join([*map(str, NODES["contact"]), ""]),
    "sets of nodes and of the solids beside them": "*NSET, NSET=mount\n"
    + listed("mount")
    + "*ELSET, ELSET=mount, GENERATE\n1, 8, 1\n"
    + BOTH,
    "a surface with the name of its set": "*NSET, NSET=mount\n"
    + listed("mount")
    + "*SURFACE, TYPE=NODE, NAME=mount\nmount\n"
    + BOTH,
    "a set that is no surface and has a fault": "*NSET, NSET=mount\n"
    + listed("mount")
    + BOTH
    + "*NSET, NSET=other\nnowhere\n*ELSET, ELSET=third\n999\n",
}


@pytest.mark.parametrize("case", CASES)
def test_sets_of_nodes_name_faces(tmp_path, case):
    check_rail(read_text(tmp_path, SOLIDS + CASES[case]))


def test_nodes_named_by_their_own_keyword(tmp_path):
    lines = SOLIDS.split("\n")
    mount = [line for line in lines if line.split(",")[0] in map(str, NODES["mount"])][
        : len(NODES["mount"])
    ]
    nodes = "*NODE, NSET=mount\n" + "\n".join(mount) + "\n" + BOTH
    check_rail(read_text(tmp_path, SOLIDS + nodes))


@pytest.mark.parametrize(
    "text, why",
    [
        ("*NSET, NSET=mount\nnowhere\n", "no node set NOWHERE"),
        ("*NSET, NSET=mount\n1, 999\n", "no node 999"),
        ("*NSET, NSET=mount\nmount\n", "node set MOUNT contains itself"),
        ("*NSET, NSET=mount, ELSET=all\n", "of an element set; write its nodes"),
        ("*NSET, GENERATE, NSET=mount\n9, 1\n", "GENERATE needs first, last and step"),
    ],
)
def test_what_a_set_of_nodes_gets_wrong_is_named(tmp_path, text, why):
    with pytest.raises(MeshError, match=f"as a file of Abaqus: line .*{why}"):
        read_text(tmp_path, SOLIDS + text)


def assembly() -> str:
    """The plate as a rail, moved and turned by 90 degrees about z, beside a payload of wedges."""
    body = SOLIDS.split("** a comment\n")[1] + CASES["two sets"]
    return (
        f"*PART, NAME=Rail\n{body}*END PART\n*PART, NAME=Payload\n*NODE\n"
        + "\n".join(f"{number}, {number}., {number * number}., 1." for number in range(1, 7))
        + "\n*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 4, 5, 6\n*END PART\n*ASSEMBLY, NAME=all\n"
        "*INSTANCE, NAME=Rail-1, PART=Rail\n0., 0.5, 0.\n0., 0.5, 0., 0., 0.5, 1., 90.\n"
        "*END INSTANCE\n*INSTANCE, NAME=Payload-1, PART=Payload\n*END INSTANCE\n*END ASSEMBLY\n"
    )


@pytest.mark.parametrize("body", ["Rail-1", "Rail", "RAIL-1"])
def test_a_body_is_an_instance_or_its_part(tmp_path, body):
    (tmp_path / "all.inp").write_text(assembly())
    mesh = read(tmp_path / "all.inp", Asked(body=body))
    check_rail(mesh)
    assert mesh.points.min(axis=0) == pytest.approx([-seeds.WIDTH, 0.5, 0.0], abs=1e-12)
    with pytest.raises(MeshError, match="solid elements of other types: wedge"):
        read(tmp_path / "all.inp")
    with pytest.raises(MeshError, match="groups of solids: PAYLOAD, PAYLOAD-1, RAIL, RAIL-1"):
        read(tmp_path / "all.inp", Asked(body="rails"))


@pytest.mark.gmsh
@pytest.mark.parametrize("kind", ["hexahedron20", "tetra", "tetra10", "hexahedron27"])
def test_elements_of_all_orders_as_gmsh_writes_them(tmp_path, kind):
    with generator.session("plate") as gmsh:
        plate(gmsh, kind)
        for suffix in ("inp", "msh"):
            gmsh.write(str(tmp_path / f"plate.{suffix}"))
    mesh, own = (read(tmp_path / f"plate.{suffix}") for suffix in ("inp", "msh"))
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)
    assert len(mesh.points) == len(own.points) and len(mesh.cells) == len(own.cells)
    assert lowest(mesh) == pytest.approx(lowest(own), rel=1e-9)


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron20"])
def test_sides_of_solids_of_all_orders(tmp_path, kind):
    """Each side of one element has the corners that the guides of Abaqus give it."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    sides = {1: (0, 1, 2), 2: (0, 3, 1), 3: (1, 3, 2), 4: (2, 3, 0)}
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    if kind == "hexahedron20":
        corners = np.array(
            [[x, y, z] for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        )
        sides = {
            1: (0, 1, 2, 3),
            2: (4, 7, 6, 5),
            3: (0, 4, 5, 1),
            4: (1, 5, 6, 2),
            5: (2, 6, 7, 3),
        }
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
        edges += [(0, 4), (1, 5), (2, 6), (3, 7)]
    points = corners if kind == "tetra" else np.concatenate([corners, corners[edges].mean(axis=1)])
    text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(points, 1))
    numbers = ", ".join(map(str, range(1, 1 + len(points))))
    text += (
        f"*ELEMENT, TYPE=C3D{len(points)}, ELSET=all\n7, {numbers}\n*SURFACE, NAME=contact\n7, S1\n"
    )
    for side, wanted in sides.items():
        mesh = read_text(tmp_path, f"{text}*SURFACE, NAME=mount, TYPE=ELEMENT\nall, S{side}\n")
        found = np.unique(mesh.points[mesh.surfaces["mount"]].reshape(-1, 3), axis=0)
        for corner in corners[list(wanted)]:
            assert (np.abs(found - corner).max(axis=1) < 1e-12).any()
        normal = np.cross(
            corners[wanted[1]] - corners[wanted[0]], corners[wanted[2]] - corners[wanted[0]]
        )
        assert np.abs((found - corners[wanted[0]]) @ normal).max() < 1e-12


def test_elements_that_appear_twice_are_a_fault(tmp_path):
    text = seeds.abaqus()
    first = text.split("C3D8R\n1, ")[1].split("\n")[0]
    with pytest.raises(MeshError, match="elements that appear twice: 9"):
        read_text(tmp_path, f"{text}*ELEMENT, TYPE=C3D8\n99, {first}\n")


CALCULIX = """*BOUNDARY
mount, 1, 3
*MATERIAL, NAME=metal
*ELASTIC
72.E9, .33
*DENSITY
2810.
*SOLID SECTION, ELSET=rail, MATERIAL=metal
*STEP
*FREQUENCY
1
*END STEP
"""


# All tests of gmsh run where it loads. Without CalculiX this is none of them.
@(pytest.mark.gmsh if shutil.which("ccx") else pytest.mark.skip(reason="no CalculiX"))
def test_a_file_that_calculix_runs(tmp_path):
    """One file with all cards of a run: CalculiX and the reader take it. The frequencies of the same
    elements agree up to the mass, which is lumped here and consistent there: the plate is two elements
    thick. Control: held at its end, the plate is far softer."""
    with generator.session("plate") as gmsh:
        plate(gmsh, "tetra10")
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.write(str(tmp_path / "plate.inp"))
    text = (tmp_path / "plate.inp").read_text()
    start, end = text.index("*ELEMENT, type=CPS6"), text.index("*ELEMENT, type=C3D10")
    text = text[:start] + text[end:]  # CalculiX takes no plane elements beside solids
    text = "\n".join(_without_sets(text, {"mount", "contact"})) + "\n" + CALCULIX
    (tmp_path / "job.inp").write_text(text)
    subprocess.run(["ccx", "job"], cwd=tmp_path, check=True, capture_output=True)
    rows = (tmp_path / "job.dat").read_text().split("\n")
    line = next(row for row in rows if row.split()[:1] == ["1"])
    mesh = read(tmp_path / "job.inp")
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)
    frequency = float(line.split()[3])
    assert lowest(mesh) == pytest.approx(frequency, rel=0.1) and lowest(mesh) < frequency
    swapped = Asked(groups={"mount": ("contact",), "contact": ("mount",)})
    assert lowest(read(tmp_path / "job.inp", swapped)) < 0.3 * frequency


def _without_sets(text: str, names: set[str]) -> list[str]:
    """Lines without the element sets of these names, whose elements were taken out."""
    lines, skipped = [], False
    for line in text.split("\n"):
        if line.startswith("*"):
            key, _, name = line.partition("ELSET=")
            skipped = key.upper().startswith("*ELSET") and name in names
        if not skipped:
            lines.append(line)
    return lines
