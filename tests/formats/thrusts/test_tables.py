"""Tables of other programs: each is written out, and its points are given beside it in SI."""

import pytest

from tests.formats.thrusts.support import points, refusal, thrust
from tests.scenes.support import small
from tipoff.formats.instrument_table import PAGE
from tipoff.scenes import parse

LBF = 4.4482216152605
ROCKETPY = "0,0\n0.1200,2600.0000\n0.2100,2482.0000\n3.0000,0.0000\n"  # of Cesaroni_7450M2505-P
SI = {"time_unit": "s", "thrust_unit": "N"}

# text, keys, points
READ = {
    "RocketPy": (ROCKETPY, SI, [[0, 0.12, 0.21, 3], [0, 2600, 2482, 0]]),
    "RocketPy with a header": (
        '"Time (s)","Thrust (N)"\n0,0\n0.5,7\n',
        {},
        [[0, 0.5], [0, 7]],
    ),
    "RocketPy with comments": ("# motor\n0,0\n# half\n0.5,7\n", SI, [[0, 0.5], [0, 7]]),
    "milliseconds and pounds": (
        "Time [ms]\tThrust (lbf)\n0\t0\n250\t10\n",
        {},
        [[0, 0.25], [0, 10 * LBF]],
    ),
    "slashes and decimal commas": (
        "Zeit/ms;Kraft/kN\n0,0;0,0\n12,5;1,25\n",
        {},
        [[0, 0.0125], [0, 1250]],
    ),
    "commented header": (
        "% fired in May\n% Time [us], Force [gf]\n0,0\n1000,100\n",
        {},
        [[0, 1e-3], [0, 0.980665]],
    ),
    "other comments": (
        "// log 7\n; cold\ntime_ms,thrust_kgf\n0,0\n2,3\n",
        {},
        [[0, 2e-3], [0, 3 * 9.80665]],
    ),
    "text above the header": (
        "Test 12;Stand B\nDate;4 May\nTime (s);Thrust (N)\n0;1\n2;3\n",
        {},
        [[0, 2], [1, 3]],
    ),
    "line of units": ("Time,Force\nms,N\n0,0\n4,5\n", {}, [[0, 4e-3], [0, 5]]),
    "units without the time": ("Time [ms],Force\n,kN\n0,0\n4,5\n", {}, [[0, 4e-3], [0, 5000]]),
    "summary": ("! cold\nTime [s],Force [N]\n0,0\n4,5\nMaximum,5\n", {}, [[0, 4], [0, 5]]),
    "remark of one letter": ("Time,Force\n# a,b\n0,0\n4,5\n", SI, [[0, 4], [0, 5]]),
    "further columns": (
        "n,Time [s],P [bar],Thrust [N],Load cell [mV],note\n1,0,9,0,1,\n2,2,9,7,1,go\n",
        {},
        [[0, 2], [0, 7]],
    ),
    "named columns": (
        "Time [s],Clock time [s],Force A [N],Force B [N]\n0,50,1,2\n1,51,3,4\n",
        {"time_column": "Clock time", "thrust_column": "Force B [N]", "ignition": "50 s"},
        [[0, 1], [2, 4]],
    ),
    "columns by number": (
        "7,0,0\n7,1,5\n",
        SI | {"time_column": "2", "thrust_column": "3"},
        [[0, 1], [0, 5]],
    ),
    "other case of a unit": ("Time (Seconds),Thrust (Newtons)\n0,0\n1,5\n", {}, [[0, 1], [0, 5]]),
    "unit by a key": ("Time [s],Force\n0,0\n1,5\n", {"thrust_unit": "lbf"}, [[0, 1], [0, 5 * LBF]]),
    "mass as force by a key": (
        "Time [s],Force [kg]\n0,0\n1,5\n",
        {"thrust_unit": "kgf"},
        [[0, 1], [0, 49.03325]],
    ),
    "counts": ("Time [s],Load\n0,0\n1,500\n", {"thrust_unit": "-0.02 N"}, [[0, 1], [0, -10]]),
    "quoted decimal commas": (
        'Time [s],Force [N]\n"0,0","0,5"\n"1,5",2\n',
        {},
        [[0, 1.5], [0.5, 2]],
    ),
    "code page": (
        "Zeit [µs];Kraft [N];T [°C]\n0;0;20\n1000;5;21\n".encode("cp1252"),
        {},
        [[0, 1e-3], [0, 5]],
    ),
    "UTF-16": ("Time [s]\tForce [N]\r\n0\t0\r\n1\t5\r\n".encode("utf-16"), {}, [[0, 1], [0, 5]]),
    "blanks": (
        "made by hand\n# Time [s]  Thrust [N]\n 0.0   0\n 0.5  7e0\n",
        {},
        [[0, 0.5], [0, 7]],
    ),
    "blanks and decimal commas": (
        "Time(s) Thrust(N)\n0,0 0,0\n0,5 7,5\n",
        {},
        [[0, 0.5], [0, 7.5]],
    ),
    "units in brackets below": (
        "t;F;p\n[ms];[kN];[bar]\n0;0;1\n5;1,5;2\n",
        {},
        [[0, 5e-3], [0, 1500]],
    ),
    "empty cells at the end": ("Time [s];Force [N];\n0;0;\n1;5;\n;;\n", {}, [[0, 1], [0, 5]]),
}


@pytest.mark.parametrize("name", READ)
def test_tables_are_read(tmp_path, name):
    text, keys, expected = READ[name]
    found = points(thrust(tmp_path, "log.csv", text, **keys))
    assert [len(column) for column in found] == [len(column) for column in expected]
    for values, wanted in zip(found, expected):
        assert values == pytest.approx(wanted, rel=1e-12)


def test_what_was_read_is_said(tmp_path):
    text, keys, _ = READ["milliseconds and pounds"]
    assert "columns Time [ms] and Thrust (lbf)" in thrust(tmp_path, "a.csv", text, **keys).usage()
    assert (
        "columns 1 and 2 of a table without a header"
        in thrust(tmp_path, "a.csv", ROCKETPY, **SI).usage()
    )
    own = thrust(tmp_path, "a.csv", "time_s,force_N\n0,0\n1,5\n").usage()
    assert "columns" not in own


# text, keys, words of the refusal
REFUSED = {
    "no units without a header": (
        ROCKETPY,
        {},
        "state it in thrust.time_unit; no header, first line",
    ),
    "no units": (
        "Time,Thrust\n0,0\n1,5\n",
        {},
        "no unit of the time: state it in thrust.time_unit",
    ),
    "no unit of the force": (
        "time_s,force\n0,0\n1,5\n",
        {},
        "thrust.thrust_unit; header 'time_s, ",
    ),
    "mass": ("Time [s],Force [kg]\n0,0\n1,5\n", {}, "given dimension [mass]"),
    "range of the load cell": (
        "Time [s],Load cell (5 kN)\n0,0\n1,5\n",
        {},
        "('5 kN' is no unit); or state it in thrust.thrust_unit",
    ),
    "number in a name": ("Time [s],thrust_5N\n0,0\n1,5\n", {}, "no unit of the thrust"),
    "contradiction": ("Time [s],Force [N]\n0,0\n1,5\n", {"thrust_unit": "lbf"}, "contradicts the"),
    "no such unit": ("Time [s],Force\n0,0\n1,5\n", {"thrust_unit": "pounds"}, "thrust_unit with"),
    "zero unit": ("Time [s],Force\n0,0\n1,5\n", {"thrust_unit": "0 N"}, "thrust_unit with"),
    "two thrusts": (
        "Time [s],Thrust raw [N],Thrust [N]\n0,0,0\n1,5,5\n",
        {},
        "the thrust may be Thrust raw [N] or Thrust [N]: name it in thrust.thrust_column",
    ),
    "no thrust": ("Time [s],Channel 3 [N]\n0,0\n1,5\n", {}, "no column is clearly the thrust"),
    "three columns without a header": ("0,0,0\n1,1,1\n", SI, "no column is clearly the time"),
    "no such column": (
        "Time [s],Force [N]\n0,0\n1,5\n",
        {"thrust_column": "Kraft"},
        "thrust.thrust_column = 'Kraft' is not there; header 'Time [s], Force [N]'",
    ),
    "column twice": (
        "Time [s],Force [N],Force [N]\n0,0,0\n1,5,5\n",
        {"thrust_column": "Force"},
        "'Force' is twice there",
    ),
    "one column for both": (
        "Time [s],Force [N]\n0,0\n1,5\n",
        {"thrust_column": "Time"},
        "one column is both",
    ),
    "thousands": ("Time [s];Force [N]\n0;1,000\n1;2,000\n", {}, "'1,000' in line 2"),
    "thousands and points": ("Time [s];Force [N]\n0;0\n1;1.234,5\n", {}, "'1.234,5' in line 3"),
    "commas for both": (
        "Time [s],Force [N]\n0,0,0,0\n0,5,1,5\n",
        {},
        "two numbers in every row (line 2",
    ),
    "text below the header": ("Time [s],Force [N]\nabc,def\n0,0\n1,5\n", {}, "'abc' in line 2"),
    "a second header": ("time_s,force_N\n0,0\ntime_s,force_N\n1,1\n", {}, "'time_s' in line 3"),
    "no units between blanks": ("time force\n0 0\n1 5\n", {}, "header 'time, force'"),
    "a line that ends early": (
        "n,Time [s],Force [N]\n1,0,0\n2,1,5\n3,2\n",
        {},
        "3 cells in every row (line 4",
    ),
    "times before zero": ("Time [s],Force [N]\n-1,0\n1,5\n", {}, "scene begins (line 2)"),
    "ignition outside": (
        "Time [s],Force [N]\n-1,0\n1,5\n",
        {"ignition": "1 s"},
        "around thrust.ignition = 1 s (it is from -1 s to 1 s)",
    ),
    "infinite after conversion": (
        "Time [s],Force\n0,0\n1,1e300\n",
        {"thrust_unit": "1e30 N"},
        "finite",
    ),
}


@pytest.mark.case("X19")
@pytest.mark.parametrize("name", REFUSED)
def test_tables_that_are_not_clear_are_refused(tmp_path, name):
    text, keys, words = REFUSED[name]
    assert words in refusal(tmp_path, "log.csv", text, **keys)


@pytest.mark.parametrize("name", list(REFUSED)[:15])
def test_refusals_of_a_header_show_it_with_the_layout_and_the_page(tmp_path, name):
    text, keys, _ = REFUSED[name]
    said = refusal(tmp_path, "log.csv", text, **keys)
    if "unit with" not in said:
        first = text.splitlines()[0].replace(",", ", ")
        assert f"'{first}'" in said and "time_s,force_N or Time [ms];Thrust (lbf)" in said
        assert PAGE in said


def test_equal_points_make_equal_scenes(tmp_path):
    """However they are written."""
    files = {
        "a.csv": ("time_s,force_N\n0,0\n0.5,7\n1,0\n", {}),
        "b.csv": ("Time;Force\n0;0\n500;7\n1000;0\n", {"time_unit": "ms", "thrust_unit": "N"}),
        "c.eng": ("X 1 1 0 1 2 Y\n0.5 7\n1 0\n", {"motor": "X"}),
    }
    hashes = set()
    for name, (text, keys) in files.items():
        (tmp_path / name).write_text(text)
        table = {"kind": "measured", "file": str(tmp_path / name)} | keys
        scene = parse(small(thrust=table))
        hashes.add(scene.hash)
        assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    assert len(hashes) == 1


EPOCH = "timestamp_ms,thrust_N\n1700000000000,0\n1700000000500,100\n1700000001000,0\n"


@pytest.mark.parametrize("text", [EPOCH, "time_s,force_N\n4000,0\n4001,100\n4002,0\n"])
def test_a_curve_in_the_time_of_a_clock_needs_its_ignition(tmp_path, text):
    """The scene would wait for 54 years. Control: with the instant the curve is that of the burn."""
    said = refusal(tmp_path, "epoch.csv", text)
    assert "thrust.ignition" in said and "(the file is from " in said
    begin = said.partition("is from ")[2].partition(" to")[0]
    found = thrust(tmp_path, "epoch.csv", text, ignition=begin)
    assert found.requested() == pytest.approx(50.0 if text is EPOCH else 100.0)


def test_a_curve_that_begins_soon_after_zero_is_no_clock(tmp_path):
    thrust(tmp_path, "late.csv", "time_s,force_N\n9,0\n9.1,100\n9.2,0\n")
    thrust(tmp_path, "long.csv", "time_s,force_N\n90,0\n95,100\n100,0\n")
