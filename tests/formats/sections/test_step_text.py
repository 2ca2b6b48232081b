"""STEP text as other CAD programs write it, and files that are refused. gmsh is not needed."""

import pytest

from tests.formats.sections.step_text import prism
from tipoff.formats.outline import outline
from tipoff.formats.sections.step import read_step

L = ((0, 0), (24, 0), (24, 4), (4, 4), (4, 24), (0, 24))
PLACE = "CARTESIAN_POINT ( '', ( {}, 0.0, 0.0 ) )"
AXES = "AXIS2_PLACEMENT_3D ( '', #{}, $, $ )"


def found(tmp_path, text, unit=None):
    path = tmp_path / "rail.step"
    path.write_text(text, encoding="latin-1")
    return read_step(path, unit)


@pytest.mark.parametrize(
    "unit, key, scale", [("mm", None, 1e-3), ("in", None, 0.0254), ("none", "cm", 1e-2)]
)
def test_corners_length_and_unit(tmp_path, unit, key, scale):
    read = found(tmp_path, prism(L, 300.0, unit), key)
    assert read.length == pytest.approx(300.0 * scale)
    expected = {tuple(round(scale * place, 9) for place in corner) for corner in L}
    assert set(outline(read.loops).loops[0]) == expected


def assembly(turn: float) -> tuple[str, ...]:
    """Further instances that move a part by ``turn`` along x."""
    first = prism(L, 300.0).count("\n#") + 1
    lines = (PLACE.format("0.0"), PLACE.format(turn), AXES.format(first), AXES.format(first + 1))
    return (*lines, f"ITEM_DEFINED_TRANSFORMATION ( '', '', #{first + 2}, #{first + 3} )")


def test_a_part_of_an_assembly_counts_in_its_own_axes_only(tmp_path):
    assert found(tmp_path, prism(L, 300.0, rest=assembly(0.0))).length == pytest.approx(0.3)
    with pytest.raises(ValueError, match="this file has an assembly that moves it"):
        found(tmp_path, prism(L, 300.0, rest=assembly(5.0)))


def test_two_contexts_the_one_of_the_solid_counts(tmp_path):
    """A file may have other units for other representations, such as tolerances."""
    other = (
        "( LENGTH_UNIT ( ) NAMED_UNIT ( * ) SI_UNIT ( $, .METRE. ) )",
        "( GLOBAL_UNIT_ASSIGNED_CONTEXT ( ( #1 ) ) REPRESENTATION_CONTEXT ( '', '' ) )",
    )
    assert found(tmp_path, prism(L, 300.0, rest=other)).length == pytest.approx(0.3)


@pytest.mark.parametrize(
    "text, words",
    [
        ("solid rail\nfacet", "a STEP file, which begins with ISO-10303-21"),
        (prism(L, 300.0)[:900], "the end, END-ISO-10303-21, is missing"),
        (prism(L, 300.0, "none"), "a unit: the file states none, so set rail.unit"),
        (prism(L, 300.0, solid="BREP_WITH_VOIDS"), "the solid has a closed cavity"),
        (prism(L, 300.0, solid="FACETED_BREP"), "not one of facets"),
        (prism(L, 300.0, solid="SHELL_BASED_SURFACE_MODEL"), "surfaces that enclose none"),
        (prism(L, 300.0).replace("VERTEX_POINT", "VERTEX_PLACE"), "stands where another"),
        (prism(L, 300.0).replace("EDGE_LOOP ( 'NONE', (", "EDGE_LOOP ( 'NONE', (("), "bracket"),
        (prism(L, 300.0).replace("24.0", "24.0.0"), "is no number"),
        (prism(L, 300.0).replace("24.0", "1E999"), "another value belongs"),
        (prism(L, 300.0).replace("24.0", "1E200"), "within 1000 m of the origin"),
        (prism(L, 300.0).replace("#1,", "#99999,").replace("#1 )", "#99999 )"), "no instance"),
        (prism(L, 10.0), "as one it is 10 mm long with a section of 24 x 24 mm"),
        (prism(((0, 0), (1, 0), (0, 1e-3)), 9.0), "sides of 0.01 mm or more"),
    ],
)
def test_damaged_and_other_files_are_refused(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        outline(found(tmp_path, text).loops)


def test_both_ends_must_be_alike(tmp_path):
    """Control: one end of a damaged file has a corner elsewhere in its plane; all its faces still say
    that they are planes along z."""
    text = prism(L, 300.0)
    corner = "( 24.0, 4.0, 300.0 )"
    assert corner in text
    with pytest.raises(ValueError, match="its ends have 176 mm2 and 174 mm2"):
        found(tmp_path, text.replace(corner, "( 23.0, 4.0, 300.0 )"))
