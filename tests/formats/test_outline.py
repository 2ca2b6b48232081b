"""Outlines of sections: moments against closed forms, and outlines that are none."""

import math

import pytest
from pydantic import TypeAdapter

from tests.scenes.section_shapes import SHAPES, T_SLOT
from tipoff.formats.outline import outline
from tipoff.scenes.section_shapes import ShapeTable

SQUARE = [(0.0, 0.0), (0.02, 0.0), (0.02, 0.02), (0.0, 0.02)]
HOLE = [(0.005, 0.005), (0.015, 0.005), (0.015, 0.015), (0.005, 0.015)]


def table(**numbers):
    """The table of a shape with SI values."""
    return TypeAdapter(ShapeTable).validate_python(numbers, context={"bare_numbers_are_si": True})


def shape(**numbers):
    """The outline of a shape with SI values."""
    return table(**numbers).outline()


def rectangles(*parts):
    """Area and second moments about the common centroid of rectangles (sign, y, z, width, height), by
    Steiner's theorem."""
    area = sum(sign * b * h for sign, _, _, b, h in parts)
    y, z = (
        sum(part[0] * part[3] * part[4] * part[place] for part in parts) / area for place in (1, 2)
    )
    yy = sum(s * (h * b**3 / 12 + b * h * (a - y) ** 2) for s, a, _, b, h in parts)
    zz = sum(s * (b * h**3 / 12 + b * h * (c - z) ** 2) for s, _, c, b, h in parts)
    return area, yy, zz


@pytest.mark.parametrize(
    "name, parts",
    [
        ("tee", [(1, 0, 0.010, 0.03, 0.004), (1, 0, -0.002, 0.003, 0.020)]),
        ("channel", [(1, 0, 0, 0.03, 0.02), (-1, 0, 0.002, 0.024, 0.016)]),
        ("box", [(1, 0, 0, 0.03, 0.024), (-1, 0, 0, 0.022, 0.016)]),
    ],
)
def test_moments_of_shapes_of_rectangles(name, parts):
    found = shape(**SHAPES[name]).moments()
    assert (found.area, found.yy, found.zz) == pytest.approx(rectangles(*parts), rel=1e-12)
    assert found.yz == pytest.approx(0.0, abs=1e-12 * found.yy)


def test_moments_of_an_inclined_triangle_far_from_the_origin():
    """Right triangle with legs a and b: a b / 2, b a^3 / 36, a b^3 / 36, -a^2 b^2 / 72 about its
    centroid."""
    a, b = 0.03, 0.02
    found = outline([[(1.0, 2.0), (1.0 + a, 2.0), (1.0, 2.0 + b)]]).moments()
    expected = (
        a * b / 2,
        1.0 + a / 3,
        2.0 + b / 3,
        b * a**3 / 36,
        a * b**3 / 36,
        -((a * b) ** 2) / 72,
    )
    assert tuple(found) == pytest.approx(expected, rel=1e-7)


def test_a_t_slot_has_the_moments_of_its_parts_and_the_area_of_its_bore():
    """The section is the square without four slots of a rectangle, a rectangle and a trapezium."""
    width, slot, lip, cavity, depth, web = (T_SLOT[key] for key in list(T_SLOT)[1:])
    found = shape(**T_SLOT).moments()
    taper = cavity / 2 + web / math.sqrt(2)
    straight = width / 2 - lip - taper
    tapering = taper - (width / 2 - depth)
    foot = 2 * (width / 2 - depth) - math.sqrt(2) * web
    one = slot * lip + cavity * straight + (cavity + foot) / 2 * tapering
    assert found.area == pytest.approx(width**2 - 4 * one, rel=1e-12)
    assert found.yy == pytest.approx(found.zz, rel=1e-12)  # a square profile
    bored = shape(**SHAPES["bored t_slot"]).moments()
    assert found.area - bored.area == pytest.approx(math.pi * 0.0034**2, rel=1e-12)


def test_a_rod_bends_as_its_circle():
    """An octagon with the second moment of the circle. Control: the octagon around the circle has 11.5 % more,
    the one within it 17 % less."""
    radius = 0.5 * SHAPES["rod"]["diameter"]
    found, corners = shape(**SHAPES["rod"]).moments(), shape(**SHAPES["rod"]).loops[0]
    exact = 0.25 * math.pi * radius**4
    assert (found.yy, found.zz, found.yz) == pytest.approx((exact, exact, 0.0), rel=1e-12)
    assert found.area / (math.pi * radius**2) - 1.0 == pytest.approx(-0.00114, abs=1e-5)
    away, far = max(y for y, _ in corners), max(math.hypot(*corner) for corner in corners)
    assert (away / radius, far / radius) == pytest.approx((0.9731, 1.0533), abs=1e-4)
    # Control:
    for scale, off in ((radius / away, 0.115), (radius / far, -0.188)):
        other = outline([[(scale * y, scale * z) for y, z in corners]]).moments()
        assert other.yy / exact - 1.0 == pytest.approx(off, abs=1e-3)


def test_loops_may_have_any_order_and_direction():
    first = outline([SQUARE, HOLE])
    assert outline([HOLE[::-1], SQUARE[::-1]]).moments() == pytest.approx(first.moments())
    assert first.moments().area == pytest.approx(3e-4)
    normals = {side.normal for side in first.sides()[:4]}
    assert normals == {(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)}
    assert first.sides()[0].normal == (0.0, -1.0)  # away from the metal


@pytest.mark.parametrize(
    "loops, words",
    [
        ([SQUARE[:2]], "three corners or more"),
        ([[(0, 0), (0.02, 0.02), (0.02, 0), (0, 0.02)]], "meet only at their ends"),
        ([[(0, 0), (0.02, 0), (0.01, 0), (0.01, 0.02)]], "meet only at their ends"),
        ([[*SQUARE, (0.0, 0.02)]], "sides of 0.01 mm or more"),
        ([SQUARE, [(y + 0.03, z) for y, z in HOLE]], "one outer border with holes inside it"),
        ([SQUARE, [(y + 0.01, z) for y, z in HOLE]], "meet only at their ends"),
        ([SQUARE, HOLE, [(0.008, 0.008), (0.012, 0.008), (0.01, 0.012)]], "none within another"),
        ([[(0.001 * place, 0.001 * (place % 2)) for place in range(402)]], "at most 400 corners"),
    ],
)
def test_outlines_that_are_none_are_refused(loops, words):
    with pytest.raises(ValueError, match=words):
        outline(loops)


def test_a_side_is_found_by_a_point_on_it():
    found = outline([SQUARE, HOLE])
    assert found.sides()[found.side_at((0.02, 0.01))].normal == (1.0, 0.0)
    with pytest.raises(ValueError, match="this is a corner"):
        found.side_at((0.02, 0.02))
    with pytest.raises(ValueError, match=r"nearest side is .* mm, 1 mm away"):
        found.side_at((0.021, 0.01))


@pytest.mark.parametrize(
    "change, words",
    [
        ({"slot": 0.021}, "slot < cavity"),
        ({"web": 0.012}, "a floor with a width"),
        ({"cavity": 0.030}, "begins to taper behind the lip"),
        ({"bore": 0.02}, "meet only at their ends"),
    ],
)
def test_dimensions_that_do_not_fit_each_other_are_refused(change, words):
    with pytest.raises(ValueError, match=words):
        shape(**T_SLOT | change)
