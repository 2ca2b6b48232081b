"""Results of Adams in XML."""

import math

import pytest

from tests.formats.curves.adams_files import document, step
from tests.formats.curves.dyna_files import written
from tipoff.comparison.layout import of_options
from tipoff.comparison.quantities import read_quantities

LAST = step("dynamic", "5.0E-004", "0.1 250 1.5 2 -3", "0 0 0 0 0")
RESULTS = document(LAST)
REPEATED = document(step("dynamic", "0", "0 0 1 2 3", "0 0 0 0 0"), LAST)


def layout(*columns, body=("payload",), axes=("body",)):
    return of_options(["a"], columns=columns, body=body, axes=axes)["a"]


@pytest.mark.parametrize("text", [RESULTS, REPEATED], ids=["once", "first step repeated"])
def test_a_part_has_its_motion_with_the_units_of_the_file(text, tmp_path):
    """The model input is left out. Control: the other part rests."""
    path = written(tmp_path, "run.res", text)
    found = read_quantities(path, layout())
    assert not found.faults
    assert found.values["time"] == pytest.approx([0.0, 5e-4])
    assert found.values["velocity_x"] == pytest.approx([0.0, 0.25])
    assert found.values["rate_z"] == pytest.approx([math.radians(3), math.radians(-3)])
    assert not read_quantities(path, layout(body=("platform",))).values["rate_z"].any()


def test_components_are_columns(tmp_path):
    names = "time=time.TIME, velocity_x=-payload_XFORM.VX, rate_x=payload_XFORM.WZ"
    rest = "rate_y=payload_XFORM.WY, rate_z=payload_XFORM.WX"
    path = written(tmp_path, "run.res", RESULTS)
    found = read_quantities(path, layout(names, rest, body=()))
    assert not found.faults
    assert found.values["velocity_x"] == pytest.approx([0.0, -0.25])
    assert found.values["rate_x"] == pytest.approx([math.radians(3), math.radians(-3)])


@pytest.mark.parametrize(
    "old, new, asked, words",
    [
        ("", "", layout(body=()), "--body: given no number, expected one of payload, platform"),
        ("", "", layout(body=("rail",)), "--body: given 'rail', expected one of payload, platform"),
        ("", "", layout(axes=()), "rates: given no axes, expected --axes body or --axes scene"),
        ("", "", layout("rate_x=payload_XFORM.W"), "no such column 'payload_XFORM.W'"),
        ("deg/sec", "no_units", layout(), "rate_x: given 'no_units'"),
        ("0.1 250 1.5 2 -3\n0 0 0 0 0", "0.1", layout(), "Step: given a step of 2 values"),
        ("0.1 250 1.5", "0.1 250 x", layout(), "Step: given could not convert"),
        ('id="4"', 'id="x"', layout(), "id: given 'x'"),
        ("</Analysis>", "", layout(), "mismatched tag"),
        ("<Results", "<!DOCTYPE x>\n<Results", layout(), "file: given a DOCTYPE"),
        ('encoding="UTF-8"', 'encoding="nothing"', layout(), "expected XML of Adams results"),
    ],
)
def test_a_fault_is_one_line(old, new, asked, words, tmp_path):
    assert old in RESULTS
    path = written(tmp_path, "run.res", RESULTS.replace(old, new) if old else RESULTS)
    said = "\n".join(map(str, read_quantities(path, asked).faults))
    assert words in said, said


def test_a_request_file_is_refused_with_the_way_out(tmp_path):
    (fault,) = read_quantities(written(tmp_path, "run.REQ", "1 2 3 4 5\n")).faults
    assert fault.given == "a request file" and "Adams in XML (.res), or a table" in fault.expected
