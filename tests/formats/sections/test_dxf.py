"""Sections drawn in DXF: lines, arcs and polylines against closed forms, and drawings that are
refused."""

import math

import pytest

from tipoff.formats.outline import outline
from tipoff.formats.sections.dxf import read_dxf
from tipoff.formats.sections.loops import DEVIATION
from tipoff.units import LENGTHS_OF_FILES


def drawing(*entities: list[tuple[int, object]], units: int | None = 4) -> str:
    """The text of a drawing."""
    head: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER")]
    head += [] if units is None else [(9, "$INSUNITS"), (70, units)]
    pairs = [*head, (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]
    pairs += [pair for entity in entities for pair in entity]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:>3}\n{value}\n" for code, value in pairs)


def line(a, b, c, d):
    return [(0, "LINE"), (8, "0"), (10, a), (20, b), (11, c), (21, d)]


def polyline(*corners, closed=1):
    pairs = [(0, "LWPOLYLINE"), (90, len(corners)), (70, closed)]
    for y, z, *bulge in corners:
        pairs += [(10, y), (20, z), *((42, each) for each in bulge)]
    return pairs


def arc(y, z, radius, begin, end):
    return [(0, "ARC"), (10, y), (20, z), (40, radius), (50, begin), (51, end)]


def moments(tmp_path, text, unit=None):
    path = tmp_path / "rail.dxf"
    path.write_text(text)
    return outline(read_dxf(path, unit).loops).moments()


def test_a_closed_polyline_in_millimetres(tmp_path):
    found = moments(tmp_path, drawing(polyline((0, 0), (20, 0), (20, 10), (0, 10))))
    assert found.area == pytest.approx(2e-4)


def test_lines_in_any_order_and_direction_are_chained(tmp_path):
    sides = [line(0, 0, 20, 0), line(0, 10, 0, 0), line(20, 10, 20, 0), line(0, 10, 20, 10)]
    assert moments(tmp_path, drawing(*sides)).area == pytest.approx(2e-4)


@pytest.mark.parametrize("turned", [False, True])
def test_arcs_and_bulges_are_chords_that_hardly_deviate(tmp_path, turned):
    """A stadium of two half circles of 5 mm: the chords take off less than the deviation along the
    arcs."""
    if turned:
        text = drawing(polyline((0, -5), (20, -5, 1), (20, 5), (0, 5, 1)))
    else:
        text = drawing(
            line(0, -5, 20, -5), arc(20, 0, 5, 270, 90), line(0, 5, 20, 5), arc(0, 0, 5, 90, 270)
        )
    exact, arcs = 200.0 + 25.0 * math.pi, 10.0 * math.pi
    area = 1e6 * moments(tmp_path, text).area
    assert 0.0 < exact - area < DEVIATION * 30.0 * arcs


def test_a_negative_bulge_is_a_notch(tmp_path):
    found = moments(tmp_path, drawing(polyline((0, 0), (20, 0, -1), (20, 10), (0, 10))))
    exact = 200.0 - 12.5 * math.pi
    assert abs(1e6 * found.area - exact) < DEVIATION * 20.0 * 5.0 * math.pi


def test_units_of_the_header_or_of_the_key(tmp_path):
    square = polyline((0, 0), (1, 0), (1, 1), (0, 1))
    assert moments(tmp_path, drawing(square, units=1)).area == pytest.approx(0.0254**2)
    assert moments(tmp_path, drawing(square, units=None), "cm").area == pytest.approx(1e-4)
    with pytest.raises(ValueError, match=r"set rail.unit"):
        moments(tmp_path, drawing(square, units=0))
    with pytest.raises(ValueError, match="the drawing states millimetres"):
        moments(tmp_path, drawing(square), "in")


LENGTHS = {  # m, of each $INSUNITS
    **{1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 2.54e-8, 9: 2.54e-5},
    **{10: 0.9144, 11: 1e-10, 12: 1e-9, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0, 17: 1e9},
    **{18: 1.495978707e11, 19: 9.4607304725808e15, 20: 3.0856775814913673e16},
    **{21: 0.3048006096012192, 22: 0.0254000508001016, 23: 0.9144018288036576},
    24: 1609.347218694437,
}


@pytest.mark.parametrize("code", LENGTHS)
def test_every_unit_of_the_header(tmp_path, code):
    """In its own unit a square of 10 mm is the same, and another unit in the key is refused."""
    side = 0.01 / LENGTHS[code]
    text = drawing(polyline((0, 0), (side, 0), (side, side), (0, side)), units=code)
    assert moments(tmp_path, text).area == pytest.approx(1e-4, rel=1e-12)
    for unit, metres in LENGTHS_OF_FILES.items():
        if metres == LENGTHS[code]:
            assert moments(tmp_path, text, unit).area == pytest.approx(1e-4, rel=1e-12)
        else:
            with pytest.raises(ValueError, match="the drawing states .* in .INSUNITS"):
                moments(tmp_path, text, unit)


@pytest.mark.parametrize("code", [-1, 25, 99])
def test_a_unit_that_the_format_does_not_have(tmp_path, code):
    square = polyline((0, 0), (1, 0), (1, 1), (0, 1))
    with pytest.raises(ValueError, match=f"from 0 to 24, not {code}"):
        moments(tmp_path, drawing(square, units=code), "mm")


def test_the_system_of_measurement_is_only_a_hint(tmp_path):
    square = polyline((0, 0), (1, 0), (1, 1), (0, 1))
    text = drawing(square, units=0).replace(
        "  9\n$INSUNITS", "  9\n$MEASUREMENT\n 70\n0\n  9\n$INSUNITS"
    )
    with pytest.raises(ValueError, match=r"states none .*MEASUREMENT: inches.*set rail.unit"):
        moments(tmp_path, text)
    assert moments(tmp_path, text, "mm").area == pytest.approx(1e-6)


def test_an_arc_that_hardly_bends_is_a_line(tmp_path):
    """Its radius is beyond all numbers."""
    found = moments(tmp_path, drawing(polyline((0, 0, 1e-200), (20, 0), (20, 10), (0, 10))))
    assert found.area == pytest.approx(2e-4)


@pytest.mark.parametrize(
    "text, words",
    [
        (drawing([(0, "CIRCLE"), (10, 0), (20, 0), (40, 5)]), "no CIRCLE in the drawing"),
        (drawing([(0, "SPLINE")], [(0, "HATCH")]), "no HATCH, SPLINE in the drawing"),
        (drawing(line(0, 0, 20, 0), line(20, 0, 20, 10)), r"one ends at \(20, 10\)"),
        (drawing(), "the drawing has no entities"),
        (drawing(polyline((0, 0), ("a", 0), (1, 1))), "numbers in the drawing, not 'a'"),
        (drawing([(0, "LINE"), (10, 0), (20, 0)]), "a LINE has no group 11"),
        (drawing([*line(0, 0, 1, 0), (230, -1)]), "is mirrored"),
        (drawing(line(0, 0, 1, 0)).replace("EOF", "END"), "EOF, is missing"),
        (drawing(arc(0, 0, 0, 0, 90), line(0, 0, 9, 9), line(9, 9, 0, 0)), "sides of 0.01 mm"),
        (drawing(polyline((0, 0, 1e300), (9, 0), (9, 9))), "arcs with an angle below 360 degrees"),
        (drawing(polyline((0, 0), (1e300, 0), (9, 9))), "within 1000 m of the origin"),
        (drawing([(0, "LWPOLYLINE"), (70, 0)]), "a LWPOLYLINE has no group 10"),
        ("nonsense\nof text\n", "line 1 has no code"),
        ("AutoCAD Binary DXF\r\n", "this one is binary"),
        ("  0\nEOF\n", "one section ENTITIES"),
    ],
)
def test_other_drawings_are_refused_by_name(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        moments(tmp_path, text, None if "$INSUNITS" in text else "mm")
