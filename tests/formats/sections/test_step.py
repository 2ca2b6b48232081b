"""Sections of solids in STEP, written by OpenCASCADE: against the section that was drawn out, against its
drawing in DXF, and against the area and moments that OpenCASCADE finds. Solids that are no extrusions."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from tests.formats.sections.test_dxf import arc, drawing, line
from tests.formats.test_outline import shape
from tests.scenes.section_shapes import T_SLOT
from tests.scenes.support import CONTACT, SMALL, small
from tests.scenes.test_profile_rail import RAIL
from tipoff.formats.outline import outline
from tipoff.formats.sections.dxf import read_dxf
from tipoff.formats.sections.step import read_step
from tipoff.formats.sections.step_solid import read_solid
from tipoff.highfi.rail import scene_mesh
from tipoff.meshes import generator
from tipoff.scenes import SceneError, parse

pytestmark = pytest.mark.gmsh
LENGTH = 200.0  # mm
L = ((0, 0), (24, 0), (24, 4), (7, 4), (4, 7), (4, 24), (0, 24))
FILLET = 3  # the side of the L that is an arc about (7, 7), seen from there
T = tuple((1e3 * y, 1e3 * z) for y, z in shape(**T_SLOT).loops[0])
BLOCK = ((0, 0), (20, 0), (20, 10), (0, 10))


def prism(occ, corners, arcs=(), centre=(7, 7), length=LENGTH):
    """A solid drawn out along z, whose sides ``arcs`` are about ``centre``. Its end of the drawing is
    surface 1."""
    points = [occ.addPoint(*corner, 0.0) for corner in corners]
    middle = occ.addPoint(*centre, 0.0)
    sides = [
        occ.addCircleArc(a, middle, b) if number in arcs else occ.addLine(a, b)
        for number, (a, b) in enumerate(zip(points, points[1:] + points[:1]))
    ]
    face = occ.addPlaneSurface([occ.addCurveLoop(sides)])
    return occ.extrude([(2, face)], 0.0, 0.0, length)[1]


def written(path, draw, turns=(), joined=True):
    """A file of what ``draw(occ)`` makes, turned by each angle about an axis; faces in one plane are
    ``joined``."""
    with generator.session("drawing") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.option.setNumber("Geometry.OCCUnionUnify", int(joined))
        draw(gmsh.model.occ)
        for *axis, angle in turns:
            gmsh.model.occ.rotate(gmsh.model.occ.getEntities(3), 0, 0, 0, *axis, angle)
        gmsh.model.occ.synchronize()
        gmsh.model.removeEntities([(2, tag) for _, tag in gmsh.model.getEntities(2)], True)
        gmsh.write(str(path))
    return path


def occ_moments(corners, arcs):
    """Area (mm2) and principal moments (mm4), the smaller one first, by OpenCASCADE."""
    with generator.session("section") as gmsh:
        prism(gmsh.model.occ, corners, arcs)
        gmsh.model.occ.synchronize()
        # a lamina: its moments about axes in the plane
        tensor = np.reshape(gmsh.model.occ.getMatrixOfInertia(2, 1), (3, 3))
        return gmsh.model.occ.getMass(2, 1), np.linalg.eigvalsh(tensor)[:2]


def principal(moments):
    """Area (mm2) and principal moments (mm4) of an outline."""
    tensor = np.array([[moments.yy, moments.yz], [moments.yz, moments.zz]])
    return 1e6 * moments.area, 1e12 * np.linalg.eigvalsh(tensor)


def found(path, unit=None):
    return outline(read_step(path, unit).loops)


TURNS = {
    "along z": (),
    "along x": ((0, 1, 0, 0.5 * math.pi), (1, 0, 0, 0.5 * math.pi)),
    "along -y": ((1, 0, 0, 0.5 * math.pi),),
    "oblique": ((1, 2, 0.5, 0.7), (0, 0, 1, 2.0)),
}


@pytest.mark.parametrize("turns", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("corners, arcs", [(L, ()), (L, (FILLET,)), (T, ()), (BLOCK, ())])
def test_area_and_principal_moments_are_those_of_opencascade(tmp_path, corners, arcs, turns):
    path = written(tmp_path / "rail.step", lambda occ: prism(occ, corners, arcs), turns)
    area, moments = principal(found(path).moments())
    exact_area, exact = occ_moments(corners, arcs)
    near = 1e-6 if not arcs else 0.004  # chords of the fillet
    assert area == pytest.approx(exact_area, rel=near)
    assert moments == pytest.approx(exact, rel=near)
    assert read_step(path, None).length == pytest.approx(1e-3 * LENGTH, abs=2e-9)


@pytest.mark.parametrize(
    "turns, axes",
    [
        ((), lambda y, z: (y, z)),  # along z: Y is x, Z is y, as in a drawing
        (((0, 1, 0, 0.5 * math.pi),), lambda x, y: (y, -x)),  # along x
        (((1, 0, 0, 0.5 * math.pi),), lambda x, y: (y, x)),  # along -y; z and x
    ],
)
def test_axes_of_the_section_follow_those_of_the_file(tmp_path, turns, axes):
    path = written(tmp_path / "rail.stp", lambda occ: prism(occ, L), turns)
    expected = {tuple(round(1e-3 * place, 9) for place in axes(*corner)) for corner in L}
    assert set(found(path).loops[0]) == expected


def test_an_oblique_extrusion_turns_the_axes_by_the_smallest_angle(tmp_path):
    """Turned about an axis in its section, from along z: so is the frame, and the section is the same.
    Control: in axes of the file that are not turned, the L has other moments."""
    turned = written(tmp_path / "a.step", lambda occ: prism(occ, L), ((1, 2, 0, 0.6),))
    exact = found(written(tmp_path / "b.step", lambda occ: prism(occ, L))).moments()
    assert found(turned).moments() == pytest.approx(exact, rel=1e-7)
    assert abs(math.cos(0.6) - 1.0) > 0.1


def test_a_fillet_is_the_same_as_in_a_drawing(tmp_path):
    """Corners, mesh and key of the mesh are those of the same section as DXF."""
    solid = written(tmp_path / "rail.step", lambda occ: prism(occ, L, (FILLET,)))
    lines = [line(*a, *b) for n, (a, b) in enumerate(zip(L, L[1:] + L[:1])) if n != FILLET]
    (tmp_path / "rail.dxf").write_text(drawing(*lines, arc(7, 7, 3, 180, 270)))
    one, two = found(solid), outline(read_dxf(tmp_path / "rail.dxf", None).loops)
    assert len(one.loops[0]) == len(two.loops[0]) == len(L) + 3
    meshes, pads = [], [SMALL["pads"][0] | {"width": "6 mm", "inset": "10 mm"}]
    for file in (solid, tmp_path / "rail.dxf"):
        rail = RAIL | {"section": str(file), "mounted": [["12 mm", "0 mm"]]}
        rail |= {"at": ["-0.1041 m", "-0.1041 m"], "mirrored": ["y", "z"], "stretch": 4}
        scene = parse(small(rail=rail, contact=CONTACT, pads=pads))
        meshes.append(scene_mesh.make_mesh(scene, 0.004))
    assert meshes[0].cells.shape == meshes[1].cells.shape
    away, nearest = cKDTree(meshes[0].points).query(meshes[1].points)
    assert away.max() < 2e-9 and len(set(nearest)) == len(nearest)


def test_holes_along_the_rail_and_round_rails(tmp_path):
    """A bored block and a tube; chords take off less than their deviation along the arcs."""

    def tube(occ):
        wall, bore = (occ.addCylinder(0, 0, 0, 0, 0, LENGTH, radius) for radius in (10, 7))
        occ.cut([(3, wall)], [(3, bore)])

    def bored(occ):
        occ.cut([prism(occ, BLOCK)], [(3, occ.addCylinder(10, 5, -1, 0, 0, LENGTH + 2, 3))])

    for draw, exact, arcs in (
        (tube, math.pi * 51.0, 34.0 * math.pi),
        (bored, 200.0 - 9.0 * math.pi, 6.0 * math.pi),
    ):
        section = found(written(tmp_path / "rail.step", draw))
        assert len(section.loops) == 2
        assert abs(1e6 * section.moments().area - exact) < 0.0025 * 20.0 * arcs


def test_an_end_in_two_faces_has_one_border(tmp_path):
    """Two blocks that OpenCASCADE fuses without joining their faces: the edge between the halves of an end
    is no part of its border."""

    def fused(occ):
        occ.fuse([prism(occ, BLOCK)], [(3, occ.addBox(0, 10, 0, 20, 5, LENGTH))])

    path = written(tmp_path / "rail.step", fused, joined=False)
    assert len(read_solid(path).faces) == 10
    section = found(path)
    assert section.moments().area == pytest.approx(3e-4)
    assert len(section.loops[0]) == 6


def holed(occ):
    occ.cut([prism(occ, BLOCK)], [(3, occ.addCylinder(10, -1, 50, 0, 20, 0, 2.5))])


def notched(occ):
    occ.cut([prism(occ, L)], [(3, occ.addBox(10, -1, 80, 20, 20, 30))])


def tapered(occ):
    """The side at x = 24 leans by 0.2 degrees."""
    tool = occ.addBox(24, -1, -1, 5, 40, LENGTH + 2)
    occ.rotate([(3, tool)], 24, 0, 0, 0, 1, 0, -math.radians(0.2))
    occ.cut([prism(occ, L)], [(3, tool)])


def chamfered(occ):
    solid = prism(occ, L)
    tool = occ.addBox(-50, -50, LENGTH - 1, 100, 100, 50)
    occ.rotate([(3, tool)], 0, 0, LENGTH, 1, 0, 0, math.radians(30))
    occ.cut([solid], [(3, tool)])


def countersunk(occ):
    """A cone."""
    tool = occ.addCone(10, -0.1, 50, 0, 4, 0, 2, 4)
    occ.cut([prism(occ, BLOCK)], [(3, tool)])


def splined(occ):
    points = [
        occ.addPoint(y, z, 0) for y, z in ((0, 0), (20, 0), (22, 5), (18, 8), (20, 12), (0, 12))
    ]
    sides = [occ.addLine(points[0], points[1]), occ.addBSpline(points[1:5])]
    sides += [occ.addLine(points[4], points[5]), occ.addLine(points[5], points[0])]
    occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(sides)]))], 0, 0, LENGTH)


@pytest.mark.parametrize(
    "draw, words",
    [
        (lambda occ: prism(occ, T, length=20), "it is 20 mm long with a section of 40 x 40 mm"),
        (holed, r"a cylinder of radius 2.5 mm is not along it, from 47.5 to 52.5 mm of its 200 mm"),
        (notched, r"its section changes 80 mm from one end, of 200 mm"),
        (tapered, r"a plane leans by 0.2 degrees, from 0 to 200 mm"),
        (chamfered, r"a plane leans by 60 degrees"),
        (countersunk, r"a face is on a CONICAL_SURFACE"),
        (splined, r"a section of lines and arcs; it has a B_SPLINE_CURVE"),
        (lambda occ: occ.addSphere(0, 0, 0, 5), "a face is a whole SPHERICAL_SURFACE"),
        (lambda occ: occ.addBox(0, 0, 0, 5, 5, 5), "it is 5 mm long with a section of 5 x 5 mm"),
        (lambda occ: [occ.addBox(9 * n, 0, 0, 5, 5, 50) for n in (0, 1, 2)], "the file has 3"),
    ],
)
def test_controls_other_solids_are_refused_with_what_was_found(tmp_path, draw, words):
    """Control."""
    with pytest.raises(ValueError, match=words):
        found(written(tmp_path / "rail.step", draw))


def test_the_unit_of_the_file_counts(tmp_path):
    path = written(tmp_path / "rail.step", lambda occ: prism(occ, BLOCK))
    assert found(path, "mm").moments().area == pytest.approx(2e-4)
    with pytest.raises(ValueError, match="no rail.unit, or 'mm': the file states 0.001 m"):
        found(path, "in")


def test_a_scene_tells_of_another_length_and_names_what_is_wrong(tmp_path):
    path = written(tmp_path / "rail.step", lambda occ: prism(occ, BLOCK))
    rail = RAIL | {"section": str(path), "mounted": [["10 mm", "0 mm"]]}
    same = parse(small(rail=rail))
    assert not any("rail.section" in text for text in same.warnings)
    longer = same.replace({"rail.end": "0.3 m"})
    (told,) = (text for text in longer.warnings if "rail.section" in text)
    assert "the solid is 0.2 m long, the rail 0.4 m from start to end" in told
    written(path, holed)
    with pytest.raises(SceneError, match=r"\[rail\] geometry"):
        parse(small(rail=rail))
