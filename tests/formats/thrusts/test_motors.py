"""Motor files of RASP and RockSim: written out as their programs and authors publish them, with the
impulse that is stated elsewhere."""

import codecs

import pytest

from tests.formats.thrusts.support import points, refusal, thrust
from tipoff.formats.instrument_table import PAGE

# As in the collection of RocketPy; its documentation states 6026.35 N s and a peak of 2200 N.
M1670 = """M1670-BS 75 757 0 3.101 5.231 CTI
0.055 100
0.092 1500
0.1 2000
0.15 2200
0.2 1800
0.5 1950
1 2034
1.5 2000
2 1900
2.5 1760
2.9 1700
3 1650
3.3 530
3.4 350
3.9 0
"""
# The fictive motor of the description at thrustcurve.org has this layout: comments, header, points
# with spaces before them, a comment between two motors.
TWO = """; Two motors
; made for a test
A8 18 70 3-5 0.00312 0.01635 Estes Industries
   0.1 10.0
   0.3 0.0
;
B6 18 70 0-2-4-6 0.0056 0.0193 Estes Industries
   0.2 12.0 ; the peak
   0.8 0.0
"""
# As RocketPy has it; Itot is 39.78 N s.
E18 = """<engine-database>
  <engine-list>
    <engine FDiv="10" FFix="1" FStep="-1." Isp="195.96" Itot="39.78"
    Type="reloadable" auto-calc-cg="1" auto-calc-mass="1"
    avgThrust="18.082" burn-time="2.2" cgDiv="10" cgFix="1" cgStep="-1." code="E18"
    delays="4,8" dia="24." exitDia="0." initWt="57."
    len="70." mDiv="10" mFix="1" mStep="-1." massFrac="36.32" mfg="Aerotech" peakThrust="31."
    propWt="20.7" tDiv="10" tFix="1"
    tStep="-1." throatDia="0.">
      <comments>made for a test</comments>
      <data>
        <eng-data cg="35." f="0." m="20.7" t="0."/>
        <eng-data cg="35." f="31." m="20.3774" t="0.04"/>
        <eng-data cg="35." f="30." m="14.6638" t="0.4"/>
        <eng-data cg="35." f="26.7" m="8.7629" t="0.8"/>
        <eng-data cg="35." f="19.1" m="3.99638" t="1.2"/>
        <eng-data cg="35." f="8." m="1.17602" t="1.6"/>
        <eng-data cg="35." f="2.2" m="0.11448" t="2."/>
        <eng-data cg="35." f="0." m="0." t="2.2"/>
      </data>
    </engine>
  </engine-list>
</engine-database>
"""
XML = '<?xml version="1.0" encoding="ENCODING"?>\n'
SECOND = """<engine code="D12" mfg="Estes" Itot="1.">
      <data><eng-data t="0." f="0." m="1." cg="1."/><eng-data t="1." f="2." m="0." cg="1."/></data>
    </engine>
  </engine-list>"""
TWO_ENGINES = E18.replace("</engine-list>", SECOND)


@pytest.mark.case("X28")
def test_a_rasp_motor_has_its_published_impulse(tmp_path):
    found = thrust(tmp_path, "m1670.eng", M1670)
    assert found.requested() == pytest.approx(6026.35, abs=0.005)
    assert found.describe(4.0)["peak_N"] == 2200.0
    assert "RASP, motor M1670-BS of CTI, propellant 3.101 kg" in found.describe(4.0)["text"]
    time, force = points(found)
    assert (time[:2], force[:2]) == ([0.0, 0.055], [0.0, 100.0]) and len(time) == 16


def test_the_first_point_of_a_rasp_motor_is_implied(tmp_path):
    """The triangle from (0, 0). Control: the same points as a table lack it."""
    found = thrust(tmp_path, "two.ENG", TWO, motor="A8")
    assert points(found) == [[0.0, 0.1, 0.3], [0.0, 10.0, 0.0]]
    assert found.requested() == pytest.approx(0.5 * 0.3 * 10.0)
    table = thrust(tmp_path, "a8.csv", "time_s,force_N\n0.1,10\n0.3,0\n")
    assert table.requested() == pytest.approx(0.5 * 0.2 * 10.0)
    given = thrust(tmp_path, "zero.eng", TWO.replace("0.1 10.0", "0 3.0\n0.1 10"), motor="A8")
    assert points(given)[1] == [3.0, 10.0, 0.0]


@pytest.mark.parametrize("motor", ["B6", "Estes B6"])
def test_one_of_several_motors_is_named(tmp_path, motor):
    found = thrust(tmp_path, "two.eng", TWO, motor=motor)
    assert found.requested() == pytest.approx(0.5 * 0.8 * 12.0)
    assert "motor B6 of Estes Industries" in found.usage()


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-32", "utf-8-sig"])
@pytest.mark.parametrize("name, text", [("m.eng", M1670), ("e.rse", E18), ("x.rse", f"{XML}{E18}")])
def test_motors_that_windows_has_written(tmp_path, name, text, encoding):
    """Editors and redirections of Windows write UTF-16 with a byte order mark. An XML file states the
    encoding too."""
    mark = codecs.BOM_UTF16_BE if encoding == "utf-16-be" else b""
    content = mark + text.replace("ENCODING", encoding.removesuffix("-sig")).encode(encoding)
    found = thrust(tmp_path, name, content)
    assert (
        found.requested() == thrust(tmp_path, name, text.replace("ENCODING", "utf-8")).requested()
    )


def test_several_motors_without_a_name_are_listed(tmp_path):
    assert "thrust.motor, one of 2 in the file: Estes A8, Estes B6" in refusal(
        tmp_path, "two.eng", TWO
    )
    said = refusal(tmp_path, "two.eng", TWO, motor="B66")
    assert "'B66' once (it is not there, did you mean B6" in said and "Estes A8, Estes B6" in said
    assert "it is 2 times there" in refusal(tmp_path, "two.eng", TWO + TWO, motor="B6")


@pytest.mark.case("X19")
@pytest.mark.parametrize(
    "text, words",
    [
        ("", "it has none"),
        ("; only a comment\n", "it has none"),
        ("0.1 10\n0.3 0\n", "give the points as a table in a file .csv"),
        ("0.1 10 3\n0.3 0 3\n", "first (line 1: '0.1 10 3')"),
        (M1670.replace("757 0 ", "757 6, 10 "), "not '5.231' as the maker (line 1"),
        (M1670.replace("757 0 ", "757 6 - 10 "), "numbers for sizes and masses (line 1"),
        (M1670.replace("M1670-BS", "M 1670"), "not '5.231' as the maker (line 1"),
        (M1670.replace("3.101 5.231", "5.231 3.101"), "a propellant of 5.231 kg in a motor of 3.1"),
        (M1670.replace("757 0", "757mm 0"), "numbers for sizes and masses (line 1"),
        (M1670.replace("M1670-BS 75 757 0", "M1670-BS 75 757"), "first (line 1"),
        (M1670.replace("0.15 2200", "0.15 2200 5"), "line 5: '0.15 2200 5'"),
        (M1670.replace("0.15 2200", "0.15 2,200"), "line 5"),
        (
            M1670.replace("0.15 2200", "0.15 abc").replace("3.3 530", "3.3 530 N"),
            "(line 5: '0.15 abc', line 14: '3.3 530 N')",
        ),
        (M1670.replace("0.15 2200", "0.15 nan"), "finite numbers (line 5)"),
        (M1670.replace("0.15 2200", "0.05 2200"), "increasing order (line 5)"),
        (M1670.replace("0.055 100", "-0.055 100"), "scene begins (line 2)"),
        (M1670.replace("0.5 1950", "0.5 -1950"), "of a motor that are not negative (line 7)"),
        (M1670.replace("0.2 1800", "0.15 1800\n0.15 1700"), "two rows for a jump (line 7)"),
        ("M1670-BS 75 757 0 3.101 5.231 CTI\n", "at least two different times"),
        (M1670.partition("530")[0] + "5", "(line 14: the last one has a thrust and no end"),
    ],
)
def test_rasp_files_that_cannot_be_are_refused(tmp_path, text, words):
    assert words in refusal(tmp_path, "motor.eng", text)


@pytest.mark.case("X28")
def test_a_rocksim_motor_has_the_impulse_that_its_file_states(tmp_path):
    found = thrust(tmp_path, "e18.rse", E18)
    # The file rounds; trapezoids of its eight points, added by hand.
    by_hand = 0.62 + 10.98 + 11.34 + 9.16 + 5.42 + 2.04 + 0.22
    assert found.requested() == pytest.approx(by_hand, rel=1e-12)
    assert found.requested() == pytest.approx(39.78, abs=0.005)
    assert "RockSim, motor E18 of Aerotech, 39.78 N s by the file" in found.usage()


def test_one_of_several_rocksim_motors_is_named(tmp_path):
    assert points(thrust(tmp_path, "two.rse", TWO_ENGINES, motor="Estes D12")) == [
        [0.0, 1.0],
        [0.0, 2.0],
    ]
    assert "one of 2 in the file: Aerotech E18, Estes D12" in refusal(
        tmp_path, "two.rse", TWO_ENGINES
    )


BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
"""
OUTSIDE = """<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/hostname">]>
"""


@pytest.mark.case("X19")
@pytest.mark.parametrize(
    "text, words",
    [
        (BOMB + E18.replace("made for a test", "&b;"), "without a document type (line 2)"),
        (OUTSIDE + E18.replace("made for a test", "&e;"), "without a document type (line 1)"),
        ('<!DOCTYPE engine-database SYSTEM "x.dtd">' + E18, "without a document type"),
        (E18.replace("made for a test", "&b;"), "undefined entity"),
        (E18.replace("</engine-list>", ""), "mismatched tag"),
        ("", "no element found"),
        ("<engine-database/>", "it has none"),
        ('<?xml version="1.0" encoding="no-such"?>' + E18, "encoding"),
        (E18.replace('f="30."', 'f="thirty"'), "each eng-data (line 14: t='0.4' f='thirty')"),
        (E18.replace('f="30."', ""), "f=''"),
        (E18.replace('f="30."', 'f="inf"'), "finite numbers (line 14)"),
        (E18.replace('f="30."', 'f="-3"').replace('f="8."', 'f="-8."'), "negative (lines 14, 17)"),
    ],
)
def test_rocksim_files_that_cannot_be_are_refused(tmp_path, text, words):
    assert words in refusal(tmp_path, "motor.rse", text)


def test_refusals_name_the_page_of_formats(tmp_path):
    for name, text in (("a.eng", "x\n"), ("a.rse", "x"), ("b.rse", BOMB), ("c.eng", TWO)):
        assert PAGE in refusal(tmp_path, name, text)


@pytest.mark.parametrize("name, text", [("a.eng", M1670), ("a.rse", E18)])
def test_keys_of_a_table_are_refused_for_a_motor(tmp_path, name, text):
    assert "without thrust.thrust_unit" in refusal(tmp_path, name, text, thrust_unit="lbf")
    assert "without thrust.motor" in refusal(
        tmp_path, "a.csv", "time_s,force_N\n0,0\n1,1\n", motor="A8"
    )
