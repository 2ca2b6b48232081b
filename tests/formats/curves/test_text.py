"""Tables of text as other programs write them: any separator, comments, blocks of text, decimal commas."""

import math

import pytest

from tests.formats.curves.dyna_files import written
from tipoff.comparison.layout import of_options
from tipoff.comparison.quantities import Found, read_quantities

NAMES = "time=Time, velocity_x=VX, rate_x=WX, rate_y=WY, rate_z=WZ"
NUMBERS = "time=1, velocity_x=2, rate_x=3, rate_y=4, rate_z=5"
UNITS = "time=ms, velocity_x=m/s, rate=deg/s"
ROWS = [(0, 0, 1, 2, 3), (0.5, 0.25, 1.5, 2, -3)]


def layout(columns=NAMES, units=UNITS, **others):
    return of_options(["a"], [columns] if columns else (), [units] if units else (), **others)["a"]


def rows(separator: str, comma: bool = False) -> str:
    """The rows of numbers of all tables here."""
    lines = [separator.join(f"{value:g}" for value in row) for row in ROWS]
    return "\n".join(lines).replace(".", "," if comma else ".") + "\n"


def require_rows(found: Found) -> None:
    assert not found.faults, "\n".join(map(str, found.faults))
    assert found.values["time"] == pytest.approx([0.0, 5e-4])
    assert found.values["velocity_x"] == pytest.approx([0.0, 0.25])
    for axis, rates in zip("xyz", ((1, 1.5), (2, 2), (3, -3))):
        assert found.values[f"rate_{axis}"] == pytest.approx([math.radians(one) for one in rates])


HEADER = ["Time", "VX", "WX", "WY", "WZ"]
# Adams: a block of text, then tabs. "Lines that do not begin with a number are comments."
TAB = 'Plot_1\nrun of 3 May\n\n"Time"\t"VX"\t"WX"\t"WY"\t"WZ"\n' + rows("\t")
# Abaqus: a blank line, a header, a blank line, columns between blanks, a summary.
RPT = (
    "\n\n              Time             VX             WX             WY             WZ \n\n"
    "                0.             0.             1.             2.             3. \n"
    "           500.E-03       250.E-03            1.5             2.            -3. \n\n"
    "    Minimum                0.             1.             2.            -3. \n"
)
# Exudyn: a sensor file has comments without names, and columns between commas.
EXUDYN = (
    "#sensor output file\n#Exudyn version = 1.12\n#sensorNumber = 0\n#sensorType = Body\n"
    "#sensorOutputVariableType = 3\n#number of sensor values = 4\n"
    "#data is written in the following order: time, values\n" + rows(",")
)
# numpy.savetxt of MuJoCo or Chrono arrays: the header in a comment.
SAVETXT = "# Time VX WX WY WZ\n" + rows(" ")


@pytest.mark.parametrize(
    "text",
    [
        ",".join(HEADER) + "\n" + rows(","),
        ", ".join(HEADER) + "\n" + rows(", "),
        ";".join(HEADER) + "\n" + rows(";"),
        ";".join(HEADER) + "\n" + rows(";", comma=True),
        "\t".join(HEADER) + "\n" + rows("\t", comma=True),
        " ".join(HEADER) + "\n" + rows(" ", comma=True),
        "  ".join(HEADER) + "\r\n" + rows("  ").replace("\n", "\r\n"),
        "\ufeff" + ",".join(HEADER) + "\n" + rows(","),
        "% made by hand\n" + ",".join(HEADER) + "\n# half of it\n" + rows(","),
        ",".join(["other", *HEADER]) + "\n9," + rows(",").strip().replace("\n", "\n9,"),
        ",".join(["run", *HEADER]) + "\na," + rows(",").strip().replace("\n", "\na,"),
        TAB,
        RPT,
        SAVETXT,
        "2024-05-03 run\n" + ",".join(HEADER) + "\n" + rows(","),
        "3 rails\n" + " ".join(HEADER) + "\n" + rows(" "),
    ],
)
def test_a_table_is_read_by_its_names(text, tmp_path):
    require_rows(read_quantities(written(tmp_path, "a.txt", text), layout()))


@pytest.mark.parametrize("text", [EXUDYN, TAB, RPT, SAVETXT, rows(" "), rows(";", comma=True)])
def test_a_table_is_read_by_its_numbers(text, tmp_path):
    require_rows(read_quantities(written(tmp_path, "a.txt", text), layout(NUMBERS)))


@pytest.mark.parametrize("title", ["! run 1\n", "3 rails\n", "# 2 1 3 of 5\n", "run 3 of 5\n"])
def test_numbers_in_a_title_are_no_columns(title, tmp_path):
    """Column 3 is the third, although a word of the title is "3"."""
    require_rows(read_quantities(written(tmp_path, "a.txt", title + rows(" ")), layout(NUMBERS)))


@pytest.mark.parametrize(
    "header",
    [
        "Time [ms],VX [m/s],WX [deg/s],WY [deg/s],WZ [deg/s]",
        "Time (ms),VX (m/s),WX (deg/s),WY (deg/s),WZ (deg/s)",
        "Time,VX,WX,WY,WZ\nms,m/s,deg/s,deg/s,deg/s",
        "Time,VX,WX,WY,WZ\n# remark\nms,m/s,deg/s,deg/s,deg/s",
    ],
)
def test_units_of_the_header(header, tmp_path):
    """Control: without them each column is refused."""
    path = written(tmp_path, "a.csv", f"{header}\n{rows(',')}")
    require_rows(read_quantities(path, layout(units=None)))
    path = written(tmp_path, "b.csv", f"{','.join(HEADER)}\n{rows(',')}")
    found = read_quantities(path, layout(units=None))
    assert [fault.given for fault in found.faults] == ["no unit"] * 5
    assert '--units "rate_z=rad/s"' in str(found.faults[-1])


def test_units_between_blanks_belong_to_the_name_before_them(tmp_path):
    text = "# Time [ms]  VX [m/s]  WX [deg/s]  WY [deg/s]  WZ [deg/s]\n" + rows("  ")
    require_rows(read_quantities(written(tmp_path, "a.dat", text), layout(units=None)))


def test_a_unit_that_the_file_contradicts_is_refused(tmp_path):
    """A unit in the header that is none may be replaced. Control: the same unit in other words."""
    head = "Time [ms],VX [m/s],WX [{}],WY [deg/s],WZ [deg/s]\n" + rows(",")
    path = written(tmp_path, "a.csv", head.format("deg/s"))
    found = read_quantities(path, layout(units="rate=rad/s"))
    assert "WX" not in found.values and len(found.faults) == 3
    assert "given rad/s in --units, expected deg/s, the unit in the file" in str(found.faults[0])
    require_rows(read_quantities(path, layout(units="rate=degree/second")))
    path = written(tmp_path, "b.csv", head.format("dps"))
    require_rows(read_quantities(path, layout(units="rate_x=deg/s")))


def test_times_begin_at_the_ignition(tmp_path):
    """100 ms of settling under gravity are left out."""
    late = "\n".join(f"{100.0 + row[0]},{','.join(map(str, row[1:]))}" for row in ROWS)
    text = f"{','.join(HEADER)}\n0,9,9,9,9\n50,9,9,9,9\n{late}\n"
    path = written(tmp_path, "a.csv", text)
    require_rows(read_quantities(path, layout(ignition=["100 ms"])))
    found = read_quantities(path, layout(ignition=["1 s"]))
    assert not found.faults and found.values["time"].size == 0


def test_a_sign_turns_an_axis(tmp_path):
    path = written(tmp_path, "a.txt", TAB)
    found = read_quantities(path, layout(NAMES.replace("rate_z=WZ", "rate_z=-WX")))
    assert found.values["rate_z"] == pytest.approx(-found.values["rate_x"])
    found = read_quantities(path, layout(NAMES.replace("rate_z=WZ", "rate_z=-3")))
    assert found.values["rate_z"] == pytest.approx(-found.values["rate_x"])


@pytest.mark.parametrize(
    "text, columns, words",
    [
        (TAB, NAMES.replace("WX", "Wx"), "no such column 'Wx'|Time, VX, WX, WY, WZ"),
        (TAB, NAMES.replace("WX", "6"), "no such column '6'"),
        (TAB, NAMES.replace("WX", "0"), "no such column '0'"),
        (EXUDYN, NAMES, "expected a number from 1 to 5 in --columns: the file has no header"),
        (TAB.replace('"VX"', '"WX"'), NAMES, "rate_x: given twice 'WX'|no such column 'VX'"),
        (TAB.replace("1.5", "NoValue"), NAMES, "rate_x: given 'NoValue' in line 6"),
        (TAB.replace("1.5", "1.234,5"), NAMES, "rate_x: given '1.234.5' in line 6"),
        (TAB.replace("0.5\t", "x\t"), NAMES, "time: given 'x' in line 6"),
        (RPT.replace("Minimum", "Median"), NAMES, "time: given 'Median' in line 8"),
        ("", NAMES, "no line of numbers"),
        ("Time,VX\n", NAMES, "no line of numbers"),
        ("1 " * 1001, NAMES, "1001 columns, 1000 at most"),
        ("\xff", NAMES, "no line"),
    ],
)
def test_a_fault_is_one_line(text, columns, words, tmp_path):
    found = read_quantities(written(tmp_path, "a.txt", text), layout(columns))
    said = "\n".join(map(str, found.faults))
    assert all(word in said for word in words.split("|")), said


def test_options_of_other_formats_are_refused(tmp_path):
    path = written(tmp_path, "a.txt", TAB)
    found = read_quantities(path, layout(units=f"{UNITS}, length=mm", body=["7"]))
    said = "\n".join(map(str, found.faults))
    assert "--body: given 7, expected none: a table has one body" in said
    assert "--units length: given mm, expected none: only files of LS-DYNA" in said


@pytest.mark.parametrize("other", ["WY", "-WY", "5"])
def test_two_quantities_have_two_columns(tmp_path, other):
    """Control: the sign or the number of the column does not make it another one."""
    names = "time=Time, velocity_x=VX, rate_x=WX, rate_y=WY, rate_z=" + other.replace("5", "4")
    text = "Time,VX,WX,WY,WZ\n" + rows(",")
    found = read_quantities(written(tmp_path, "a", text), layout(names))
    (fault,) = found.faults
    assert fault.key == "rate_z" and "rate_y has this one" in fault.expected
