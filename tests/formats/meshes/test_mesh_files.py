"""The same rail in every format of mesh files, and what each format may say about its groups."""

from functools import cache

import meshio
import numpy as np
import pytest

from tests.formats.meshes import forms, seeds
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh import facets, touching
from tipoff.highfi.mesh.rail_mesh import MeshError, RailMesh, read
from tipoff.highfi.rail import spin
from tipoff.meshes import bricks, generator, msh
from tipoff.scenes import load

WHOLE = seeds.AREAS
HALF = WHOLE["mount"] / 2.0


def areas(mesh):
    """Areas (m2) of the surfaces."""
    return {name: facets.area(mesh.points, found) for name, found in mesh.surfaces.items()}


def check_rail(mesh, expected=None):
    """Areas, volume and number of elements are those of the plate."""
    assert areas(mesh) == pytest.approx(expected or WHOLE, rel=1e-6)
    assert len(mesh.cells) == seeds.ELEMENTS
    volume = hexahedron.basis(mesh.points[mesh.cells]).dx.sum()
    assert volume == pytest.approx(seeds.VOLUME, rel=1e-6)


def read_text(folder, text, name="rail.inp"):
    (folder / name).write_text(text, encoding="utf-8")
    return read(folder / name)


@pytest.mark.parametrize("form", forms.ALL)
def test_the_same_rail_in_every_format(tmp_path, form):
    """In gmsh 4.1 the mount is two entities: one is in two groups, one is used reversed. Nodes, elements
    and the lowest frequency are those of the first format."""
    mesh, first = read(forms.write(form, tmp_path / "rail")), seeds.rail()
    check_rail(mesh)
    np.testing.assert_allclose(mesh.points, first.points, atol=1e-9)
    np.testing.assert_array_equal(mesh.cells, first.cells)
    assert lowest(mesh) == pytest.approx(lowest(in_memory()), rel=1e-6)


@cache
def in_memory() -> RailMesh:
    """The rail that no file has given."""
    return read(msh.tagged(*seeds.rail()))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("form", ["Abaqus", "Nastran small", "gmsh 2.2 text"])
def test_a_byte_order_mark_is_no_part_of_the_first_line(tmp_path, form, encoding):
    """The names of the groups are in the first line of what is left of the Nastran file."""
    file = seeds.write(form, tmp_path / "rail")
    text = file.read_text(encoding="utf-8")
    text = text[text.index("$ Femap") :] if form.startswith("Nastran") else text
    file.write_bytes(text.encode(encoding))
    check_rail(read(file))


def lowest(mesh):
    """Lowest frequency (Hz) of the plate, held at its mount."""
    material = load("tiny").rail.material
    return spin.lowest_of(mesh, material) / (2.0 * np.pi)


def test_the_whole_mount_holds_the_rail(tmp_path):
    """Whatever way a file says that facets are in a group, the lowest frequency is the same. Control: a
    mount that lost a part of its facets is softer."""
    form = "gmsh 2.2 text"
    expected = lowest(read(seeds.write(form, tmp_path / "rail")))
    numbers = list(range(seeds.ELEMENTS + 1, seeds.ELEMENTS + 9))
    assert len(seeds.rail().surfaces["mount"]) == len(numbers)

    def text(*parts):
        lines = [f"*ELSET, ELSET=mount\n{', '.join(map(str, part))}\n" for part in parts]
        return seeds.abaqus().replace("ELSET=mount", "ELSET=other") + "".join(lines)

    in_two = read_text(tmp_path, text(numbers[:3], numbers[3:]))
    assert lowest(in_two) == pytest.approx(expected, rel=1e-9)
    halves = read(seeds.write("gmsh 4.1 binary", tmp_path / "halves"))
    assert lowest(halves) == pytest.approx(expected, rel=1e-9)
    # Control.
    assert lowest(read_text(tmp_path, text(numbers[:3]))) < 0.8 * expected


def plate(gmsh, order=1):
    """The plate with a mount of two faces, one of which is in the group of bolts too, and its solid
    in two groups."""
    occ = gmsh.model.occ
    for start in (0.0, 0.02):
        occ.addBox(start, 0.0, 0.0, 0.02, 0.02, 0.008)
    occ.removeAllDuplicates()
    occ.synchronize()
    lower = [tag for _, tag in gmsh.model.getEntities(2) if occ.getCenterOfMass(2, tag)[2] < 1e-9]
    end = [tag for _, tag in gmsh.model.getEntities(2) if occ.getCenterOfMass(2, tag)[0] < 1e-9]
    for name, tags in (("bolts", lower[:1]), ("mount", lower), ("contact", end)):
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    for name in ("rail", "mount"):  # a name may be used in each dimension
        gmsh.model.addPhysicalGroup(3, [1, 2], name=name)
    for _, edge in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(edge, 3)
    gmsh.model.mesh.setTransfiniteAutomatic()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)


@pytest.mark.gmsh
@pytest.mark.parametrize(
    "version, parts, binary",
    [(2.2, 0, 0), (2.2, 0, 1), (4.0, 0, 0), (4.1, 0, 0), (4.1, 0, 1), (4.1, 2, 0), (4.1, 2, 1)],
)
def test_a_face_in_two_groups_is_in_both(tmp_path, version, parts, binary):
    """As gmsh itself writes it, also after a partition, where entities are parts of others."""
    with generator.session("plate") as gmsh:
        plate(gmsh)
        if parts:
            gmsh.model.mesh.partition(parts)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(tmp_path / "plate.msh"))
    mesh = read(tmp_path / "plate.msh")
    assert areas(mesh) == pytest.approx(WHOLE, rel=1e-9)
    assert hexahedron.basis(mesh.points[mesh.cells]).dx.sum() == pytest.approx(seeds.VOLUME)
    # Control: the half that is in one group alone.
    assert areas(mesh)["mount"] != pytest.approx(HALF, rel=0.1)


@pytest.mark.gmsh
@pytest.mark.parametrize("suffix", ["inp", "bdf"])
def test_a_rail_as_gmsh_writes_it_for_other_tools(tmp_path, suffix):
    with generator.session("plate") as gmsh:
        plate(gmsh)
        if suffix == "bdf":  # which has one property for each element
            gmsh.model.removePhysicalGroups([(2, 1), (3, 5)])
            gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
        gmsh.write(str(tmp_path / f"plate.{suffix}"))
    file = tmp_path / f"plate.{suffix}"
    if suffix == "bdf":  # gmsh writes numbers, no names
        names = {2: "mount", 3: "contact"}
        comments = [f'$HMNAME PROP {tag:16d}"{name}" 4' for tag, name in names.items()]
        file.write_text("\n".join(comments) + "\n" + file.read_text())
    assert areas(read(file)) == pytest.approx(WHOLE, rel=1e-5)


TWO_BLOCKS = "\n*ELEMENT, TYPE=S4, ELSET=mount\n13, ".join(seeds.abaqus().rsplit("\n13, ", 1))
# mounts are elements 9 to 16, contacts 17 and 18
LISTED = seeds.abaqus("*ELEMENT, TYPE=S4, ELSET=shells_{name}")
SETS = {
    "a set in two blocks": TWO_BLOCKS,
    "solids without a set before sets": seeds.abaqus(),
    "a set of sets": LISTED
    + "*ELSET, ELSET=mount\nshells_mount\n*ELSET, ELSET=contact\nmore, shells_contact,\n"
    + "*ELSET, ELSET=more\n17\n",
    "sets by number in several lines": LISTED
    + "*ELSET, ELSET=mount\n9, 10, 11, 12,\n13, 14\n*ELSET, ELSET=contact\n17, 18\n"
    + "*ELSET, ELSET=mount\n15, 16\n",
    "ranges": LISTED
    + "*ELSET, ELSET=mount, GENERATE\n9, 15, 2\n10, 16, 2\n"
    + "*ELSET, GENERATE, ELSET=contact\n17, 900000000000, 1\n",
    "numbers and names in one set": LISTED
    + "*ELSET, ELSET=a, GENERATE\n9, 15\n*ELSET, ELSET=mount\na, 16\n*ELSET, ELSET=contact\n18, 17\n",
    "capitals": LISTED.replace("shells_mount", "Mount") + "*ELSET, ELSET=CONTACT\nSHELLS_Contact\n",
    "a keyword in two lines": LISTED.replace("TYPE=S4, ELSET=shells_", "TYPE=S4,\nELSET="),
    "an element that two lines name": seeds.abaqus() + "*ELSET, ELSET=mount\n9, 10\n",
    "nodes in two blocks": seeds.abaqus().replace("\n16, ", "\n*NODE, NSET=more\n16, ", 1),
    "surfaces of shells": LISTED
    + "*SURFACE, NAME=mount, TYPE=ELEMENT\nshells_mount, SPOS\n"
    + "*SURFACE, NAME=contact\n17, SNEG\n18, SNEG\n",
    "surfaces of solids": LISTED
    + "*ELSET, ELSET=all, GENERATE\n1, 8\n"
    + "*SURFACE, NAME=mount\nall, S3\n*SURFACE, NAME=contact\n1, S1\n",
}


@pytest.mark.parametrize("case", [case for case in SETS if case != "surfaces of solids"])
def test_sets_of_abaqus_have_all_their_elements(tmp_path, case):
    check_rail(read_text(tmp_path, SETS[case]))


def test_a_surface_of_faces_of_solids(tmp_path):
    """S1 to S6 of each brick together are its six faces; those of the outside are kept here by their
    place."""
    mesh = seeds.rail()
    corners = {tuple(sorted(row + 1)) for rows in mesh.surfaces.values() for row in rows}
    table = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
    lines = {"mount": "*SURFACE, NAME=mount\n", "contact": "*SURFACE, NAME=contact\n"}
    for name, rows in mesh.surfaces.items():
        wanted = {tuple(sorted(row)) for row in rows.tolist()}
        for label, cell in enumerate(mesh.cells, 1):
            for face, places in enumerate(table, 1):
                if tuple(sorted(cell[places].tolist())) in wanted:
                    lines[name] += f"{label}, S{face}\n"
    assert len(corners) == 10
    solids = LISTED[: LISTED.index("*ELEMENT, TYPE=S4")]
    check_rail(read_text(tmp_path, solids + lines["mount"] + lines["contact"]))


def test_parts_are_placed_by_their_instances(tmp_path):
    """The plate twice: once moved, once moved and turned by 90 degrees about z."""
    body = seeds.abaqus().split("** a comment\n")[1]
    text = (
        f"*HEADING\n*PART, NAME=plate\n{body}*END PART\n*ASSEMBLY, NAME=all\n"
        "*INSTANCE, NAME=one, PART=plate\n0.1, 0., 0.\n*END INSTANCE\n"
        "*INSTANCE, NAME=two, PART=PLATE\n0., 0.5, 0.\n0., 0.5, 0., 0., 0.5, 1., 90.\n"
        "*END INSTANCE\n*ELSET, ELSET=contact_one, INSTANCE=one\n17, 18\n"
        "*ELSET, ELSET=contact_two\ntwo.contact\n*END ASSEMBLY\n"
    )
    mesh = read_text(tmp_path, text)
    both = {name: 2.0 * area for name, area in WHOLE.items()}
    single = {f"contact_{name}": WHOLE["contact"] for name in ("one", "two")}
    assert areas(mesh) == pytest.approx(both | single, rel=1e-9)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    assert low == pytest.approx([-seeds.WIDTH, 0.0, 0.0], abs=1e-12)
    assert high == pytest.approx([0.1 + seeds.LENGTH, 0.5 + seeds.LENGTH, seeds.HEIGHT])


@pytest.mark.parametrize(
    "text, why",
    [
        (LISTED + "*ELSET, ELSET=mount\nmount\n", "element set MOUNT contains itself"),
        (LISTED + "*ELSET, ELSET=mount\nnowhere\n", "no element set NOWHERE"),
        (LISTED + "*ELSET, ELSET=mount\n9, 999\n", "no element 999"),
        (seeds.abaqus() + "*INCLUDE, INPUT=a.inp\n", r"\*INCLUDE is not read"),
        (seeds.abaqus() + "*NGEN\n1, 5\n", r"\*NGEN is not read"),
        (seeds.abaqus() + "*NODE\n1, 5., 5., 5.\n", "two places for nodes 1"),
        (seeds.abaqus() + "*ELEMENT, TYPE=S4\n9, 1, 2, 3, 4\n", "a second element 9"),
        (seeds.abaqus() + "*ELEMENT, TYPE=S4\n99, 1, 2, 3\n", "lacks nodes"),
        (seeds.abaqus() + "*ELEMENT, TYPE=S4\n99, 1, 2, 3, 77\n", "no coordinates for nodes 77"),
        (seeds.abaqus() + "*ELEMENT, TYPE=SC8R\n99, 1, 2, 3, 4, 5, 6, 7, 8\n", "type SC8R"),
        (seeds.abaqus().replace("*Element, type=C3D8R", "*Element"), "without TYPE="),
        (seeds.abaqus().replace("*NODE\n1, 0", "*NODE\n1, zero"), "line 5: 'zero' in place of"),
        ("5 1 0 0 0\n", "data before the first keyword"),
    ],
)
def test_what_a_file_of_abaqus_gets_wrong_is_named(tmp_path, text, why):
    with pytest.raises(MeshError, match=f"rail.inp cannot be used: as a file of Abaqus: .*{why}"):
        read_text(tmp_path, text)


@pytest.mark.parametrize(
    "before, after",
    [
        ("$ Femap Property {} : {}", "$ Femap Property {} : {}"),
        ("$ Femap Property {} : {}", '$HMNAME PROP                   {}"{}" 4'),
        ("$ Femap Property {} : {}", "$ANSA_NAME_COMMENT;{};PSHELL;{};;NO;NO;NO;"),
        ("PSHELL  {0}", "$ Elements and Element Properties for region : {1}\nPSHELL  {0}"),
        ("+     ", "      "),  # an empty first field continues too
        ("\nCHEXA ", "\n$ a comment\n\nCHEXA "),
        ("  0.0200", " 20.00-3"),  # an exponent without its letter
        ("  0.0200", "   2.D-2"),
        ("BEGIN BULK\n", ""),
    ],
)
def test_a_file_of_nastran_may_be_written_in_many_ways(tmp_path, before, after):
    text = seeds.nastran()
    if "region" in after:
        text = "\n".join(line for line in text.split("\n") if "Femap" not in line)
    for owner, name in ((2, "mount"), (3, "contact")):
        text = text.replace(before.format(owner, name), after.format(owner, name))
        assert after.format(owner, name) in text
    check_rail(read_text(tmp_path, text.replace("SOL 101\nCEND\n", ""), "rail.bdf"))


def test_continuations_with_marks_belong_to_their_card(tmp_path):
    """Eight columns more, which the next line repeats, as older programs write."""
    lines = seeds.nastran().split("\n")
    place = next(number for number, line in enumerate(lines) if line.startswith("CHEXA"))
    lines[place] += "+E1"
    lines[place + 1] = "+E1".ljust(8) + lines[place + 1][8:]
    check_rail(read_text(tmp_path, "\n".join(lines), "rail.bdf"))
    lines[place + 1] = "+E2".ljust(8) + lines[place + 1][8:]
    with pytest.raises(MeshError, match="continues a card that is not before it"):
        read_text(tmp_path, "\n".join(lines), "rail.bdf")


@pytest.mark.parametrize(
    "before, after, why",
    [
        ("Femap", "Property", "groups in the mesh: property 1, property 2"),
        (
            "GRID           1        ",
            "GRID           1       7",
            "coordinates in system 7, which the file lacks",
        ),
        ("BEGIN BULK", "BEGIN BULK\nINCLUDE 'a.bdf'", "INCLUDE is not read"),
        ("+      ", "CROD   ", "CHEXA with 6 nodes"),
    ],
)
def test_what_a_file_of_nastran_gets_wrong_is_named(tmp_path, before, after, why):
    text = seeds.nastran()
    assert before in text
    with pytest.raises(MeshError, match=why):
        read_text(tmp_path, text.replace(before, after), "rail.bdf")


@pytest.mark.parametrize(
    "name, content, why",
    [
        ("rail.xdmf", "", "a mesh file ends in one of .bdf, .dat, .dyn, .fem, .inp"),
        ("rail", "", "a mesh file ends in one of .bdf, .dat, .dyn, .fem, .inp"),
        ("rail.msh", "(0 fluent)\n", "starts with .MeshFormat, this one with '.0 fluent"),
        ("rail.msh", "$MeshFormat\n1.0 0 8\n$EndMeshFormat\n", "format 1.0 of gmsh; save it in"),
        ("rail.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "no .Nodes"),
        ("rail.bdf", "", "no GRID"),
    ],
)
def test_a_file_that_is_no_mesh_is_refused(tmp_path, name, content, why):
    with pytest.raises(MeshError, match=why):
        read_text(tmp_path, content, name)


def test_counts_of_any_size_are_refused_at_once(tmp_path):
    """In text and in binary, where a count says how much there is to read."""
    text = seeds.gmsh_41().decode()
    for section in ("Entities", "Nodes", "Elements"):
        start = text.index(f"${section}\n") + len(section) + 2
        for count in ("9" * 18, "-1", "9" * 30):
            end = text.index(" ", start)
            changed = text[:start] + count + text[end:]
            with pytest.raises(MeshError, match=rf"\${section} (is shorter|has)|no coordinates"):
                read_text(tmp_path, changed, "rail.msh")
    content = seeds.gmsh_41(binary=True)
    place = content.index(b"$Nodes\n") + 7
    (tmp_path / "rail.msh").write_bytes(content[:place] + b"\xff" * 8 + content[place + 8 :])
    with pytest.raises(MeshError, match="cannot be used"):
        read(tmp_path / "rail.msh")


def test_coordinates_too_large_to_multiply_are_a_fault(tmp_path):
    """Without a warning of numpy, which tests turn into an error."""
    text = seeds.abaqus().replace("0.01", "1e200")
    with pytest.raises(MeshError, match="coordinates up to 1e.200 m"):
        read_text(tmp_path, text)


def test_what_no_check_foresaw_is_a_refusal(tmp_path):
    """A chain of sets that is longer than Python follows calls."""
    text = seeds.abaqus() + "*ELSET, ELSET=contact_long\na0\n"
    text += "".join(f"*ELSET, ELSET=a{number}\na{number + 1}\n" for number in range(3000))
    with pytest.raises(MeshError, match="the reader of Abaqus files fails on it .RecursionError"):
        read_text(tmp_path, text)


def block(lengths, counts, start=(0.0, 0.0, 0.0)):
    """Points and cells of a brick."""
    borders = [
        np.linspace(at, at + length, count + 1) for at, length, count in zip(start, lengths, counts)
    ]
    return bricks.filled(borders, np.ones(counts, dtype=bool))


@pytest.mark.parametrize("counts", [(2, 2, 2), (3, 3, 3), (9, 9, 9)])
@pytest.mark.parametrize("gap, touches", [(0.0, True), (1e-5, False)])
def test_parts_that_touch_without_shared_nodes_are_said(counts, gap, touches):
    """Whether their meshes match or not; 10 um apart they are two rails. Control: bricks that share
    their nodes do not touch anything."""
    size = (0.02, 0.02, 0.008)
    first, second = block(size, (2, 2, 2)), block(size, counts, (0.02 + gap, 0.0, 0.0))
    mesh = RailMesh(
        np.concatenate([first[0], second[0]]),
        np.concatenate([first[1], second[1] + len(first[0])]),
        {},
    )
    found = touching.touching(mesh)
    assert bool(len(found)) == touches
    assert not touching.warning(RailMesh(*first, {}))
    if touches:
        both = 2 * 0.02 * 0.008
        assert 0.7 * both < facets.area(mesh.points, found) < (1.0 + 1e-9) * both
        (words,) = touching.warning(mesh)
        assert "x 0.02 to 0.02 m, y 0 to 0.02 m, z 0 to 0.008 m" in words


def test_facets_of_two_groups_in_a_mesh_in_memory():
    """Control of the comparison: half of the mount is half of its area."""
    points, cells, surfaces = seeds.rail()
    found = {"mount": surfaces["mount"][:4], "contact": surfaces["contact"]}
    sets = {name: [np.array([], dtype=int)] * 3 for name in found}
    for place, name in enumerate(found, 1):
        sets[name] = [
            np.arange(len(found[name])) if index == place else np.array([], dtype=int)
            for index in range(3)
        ]
    blocks = [("hexahedron", cells), *(("quad", rows) for rows in found.values())]
    mesh = read(meshio.Mesh(points, blocks, cell_sets=sets))
    assert areas(mesh)["mount"] == pytest.approx(HALF, rel=1e-9)
