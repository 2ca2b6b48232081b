"""A design of OpenRocket becomes a scene with the places, numbers and thrust that it states."""

import gzip
import io
import math
import zipfile

import pytest
from typer.testing import CliRunner

from tipoff import scenes
from tipoff.formats.designs.openrocket import read_openrocket
from tipoff.formats.designs.openrocket_table import read_simulation
from tipoff.scenes import uncertainty
from tipoff.scenes.parts import usual
from tipoff.studies.cli import app

# made up: a nose of 0.5 m, a tube of 1.5 m; buttons 0.1 and 0.9 m in front of the tail
DESIGN = """<?xml version='1.0' encoding='utf-8'?>
<openrocket version="1.10"><rocket><subcomponents><stage><subcomponents>
<nosecone><length>0.5</length><aftradius>auto 0.05</aftradius></nosecone>
<bodytube><length>1.5</length><radius>0.05</radius><subcomponents>
<railbutton><axialoffset method="bottom">-0.1</axialoffset><instancecount>2</instancecount>
<instanceseparation>-0.8</instanceseparation><innerdiameter>0.006</innerdiameter></railbutton>
</subcomponents></bodytube></subcomponents></stage></subcomponents></rocket>
<simulations><simulation><name>Windy</name>
<conditions><launchrodlength>3.0</launchrodlength><launchrodangle>6.0</launchrodangle></conditions>
<flightdata><databranch name="MAIN" types="Time,Mass,CG location,Longitudinal moment of inertia,\
Rotational moment of inertia,Thrust">
<datapoint>0,9.5,1.2,2.6,0.014,0</datapoint><datapoint>0.05,9.4,1.2,2.6,0.014,900</datapoint>
<datapoint>2.0,8.0,1.1,2.4,0.013,800</datapoint><datapoint>2.1,7.9,1.1,2.4,0.013,0</datapoint>
<datapoint>9.0,7.9,1.1,2.4,0.013,NaN</datapoint></databranch></flightdata></simulation></simulations>
</openrocket>"""


def zipped(text: str) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("rocket.ork", text)
    return stream.getvalue()


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.mark.parametrize("packed", [str.encode, zipped, lambda text: gzip.compress(text.encode())])
def test_every_value_of_a_design_is_in_the_scene_with_its_field(packed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.ork").write_bytes(packed(DESIGN))
    made = call("new", "mine.toml", "--rocket", "design.ork")
    assert made.exit_code == 0, made.output
    scene = scenes.load("mine.toml")
    assert (scene.payload.mass, scene.payload.size) == (9.5, pytest.approx((2.0, 0.1, 0.1)))
    assert (scene.payload.inertia.xx, scene.payload.inertia.yy) == (0.014, 2.6)
    places = sorted({pad.position[0] for pad in scene.pads})
    assert places == pytest.approx([0.1 - 0.8, 0.9 - 0.8])  # the mass centre is 0.8 m from the tail
    assert (scene.rail.start, scene.rail.end) == pytest.approx((-0.8, 2.2))
    assert math.degrees(math.atan2(-scene.gravity.x, -scene.gravity.z)) == pytest.approx(84.0)
    assert scene.thrust.requested() == pytest.approx(0.5 * 45 + 850 * 1.95 + 40)
    assert scene.rail.section.slot == pytest.approx(6.477e-3)
    for key, field in {
        "payload.mass": "first datapoint, Mass",
        "payload.inertia": "Rotational moment of inertia",
        "buttons": "railbutton: axialoffset",
        "rail.end": "launchrodlength",
    }.items():
        text = scenes.provenance.nearest(scene.provenance, key)
        assert text.startswith("design.ork: ") and field in text
    vary = uncertainty.of_scene(scene).vary
    assert vary["payload.mass"].ppf(0.5) == pytest.approx(9.5)
    assert vary["gravity.inclination"].ppf(0.5) == pytest.approx(math.radians(84.0))


def test_places_by_every_method():
    def guides(offset, kind="railbutton"):
        text = DESIGN.replace('<axialoffset method="bottom">-0.1</axialoffset>', offset)
        return read_openrocket(text.replace("railbutton", kind).encode()).guides

    assert guides('<axialoffset method="top">1.4</axialoffset>') == pytest.approx((1.1, 1.9))
    assert guides('<position type="middle">0.65</position>') == pytest.approx((1.1, 1.9))
    assert guides('<axialoffset method="absolute">1.9</axialoffset>') == pytest.approx((1.1, 1.9))


def test_a_lug_is_a_lug_on_a_usual_rod_that_fits(tmp_path, monkeypatch):
    """Inner diameter 2 (4.5 - 0.5) mm; the rod is the largest fraction of an inch within it, or has a play of 8 %."""
    monkeypatch.chdir(tmp_path)
    sizes = "<radius>0.0045</radius><thickness>0.0005</thickness><length>0.2</length>"
    lug = f'<axialoffset method="top">1.0</axialoffset>{sizes}'
    one = DESIGN.replace("<instancecount>2", "<instancecount>1").replace("railbutton", "launchlug")
    text = one.replace('<axialoffset method="bottom">-0.1</axialoffset>', lug)
    design = read_openrocket(text.encode())
    assert design.guides == pytest.approx((1.6,)) and design.lug == pytest.approx((8e-3, 0.2))
    (tmp_path / "design.ork").write_text(text)
    made = call("new", "mine.toml", "--rocket", "design.ork")
    assert made.exit_code == 0, made.output
    scene = scenes.load("mine.toml")
    assert scene.rail.section.diameter == pytest.approx(0.92 * 8e-3)
    assert scene.contact.gaps()[1] == pytest.approx(0.5 * 0.08 * 8e-3)
    middles = {pad.position[0] for pad in scene.pads}
    assert sorted(middles) == pytest.approx([0.4 - 0.8 - 0.098, 0.4 - 0.8 + 0.098])
    assert scenes.provenance.nearest(scene.provenance, "lugs").endswith("thickness, length")
    assert usual.rod_in(6.6e-3) == pytest.approx(6.35e-3)
    with pytest.raises(ValueError, match="launch lug with radius"):
        read_openrocket(text.replace("<thickness>0.0005</thickness>", "").encode())


@pytest.mark.parametrize(
    "data, words",
    [
        (b"PK\x03\x04 no archive", "whole zip archive"),
        (b"\x1f\x8bno", "whole gzip"),
        (b"<openrocket>", "valid XML"),
        (b"<rocket/>", "element openrocket"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><openrocket>&b;</openrocket>', "without a document type"),
        (
            b"<openrocket/>",
            "nose cone.*two rail buttons.*stored data.*launchrodlength.*launchrodangle",
        ),
        (DESIGN.replace("Mass,", "Weight,").encode(), "run it in OpenRocket and save"),
        (DESIGN.replace("railbutton", "fin").encode(), "two rail buttons or a launch lug with"),
    ],
)
def test_a_design_that_cannot_be_used_is_refused_with_all_that_is_missing(data, words):
    with pytest.raises(ValueError, match=f"(?s){words}"):
        read_openrocket(data)


def test_nothing_is_written_for_a_refused_design(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.ork").write_text("<openrocket/>")
    for options in (["--rocket"], [], ["--rocket", "--mass", "3 kg"]):
        made = call("new", "mine.toml", *options, "design.ork")
        assert made.exit_code == 2 and [each.name for each in tmp_path.iterdir()] == ["design.ork"]


# made up, as OpenRocket writes it: the names with their units in a comment, and events between the rows
TABLE = """# Windy (Up to date)
# 5 data points written for 8 variables.
# Time (s),Altitude (m),Mass ({mass}),Motor mass (g),CG location ({length}),\
Longitudinal moment of inertia ({inertia}),Rotational moment of inertia ({inertia}),Thrust ({force})
# Event LAUNCH occurred at t=0 seconds
0,0,{m},1800,{c},{a},{r},0
# Event LIFTOFF occurred at t=0.01 seconds
0.05,0.1,{m},1700,{c},{a},{r},{f}
2,99,{m},300,{c},{a},{r},{f}
2.1,104,{m},200,{c},{a},{r},0
9,50,{m},200,{c},{a},{r},NaN
"""
SI = {"mass": 9.5, "length": 1.2, "inertia": 2.6, "along": 0.014, "force": 900.0}
# typed here from the definitions of the units: kg, m, kg m2 and N in each
UNITS = {
    "SI": (("kg", 1.0), ("m", 1.0), ("kg·m²", 1.0), ("N", 1.0)),
    "usual": (("g", 1e-3), ("cm", 1e-2), ("kg·cm²", 1e-4), ("N", 1.0)),
    "imperial": (
        ("oz", 0.45359237 / 16.0),
        ("in", 0.0254),
        ("lb·ft²", 0.45359237 * 0.3048**2),
        ("lbf", 0.45359237 * 9.80665),
    ),
}


def table(units="SI", **own):
    (mass, m), (length, c), (inertia, i), (force, f) = UNITS[units]
    named = {"mass": mass, "length": length, "inertia": inertia, "force": force}
    values = {"m": SI["mass"] / m, "c": SI["length"] / c, "a": SI["inertia"] / i}
    values |= {"r": SI["along"] / i, "f": SI["force"] / f}
    return TABLE.format(**(named | {key: f"{value:.12g}" for key, value in values.items()} | own))


def without_results(text=DESIGN):
    begin, end = text.index("<flightdata>"), text.index("</flightdata>") + len("</flightdata>")
    return text[:begin] + text[end:]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_beside_a_design_takes_the_place_of_its_results(
    units, separator, tmp_path, monkeypatch
):
    """In any unit, the scene is that of the design with these results."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "design.ork").write_text(without_results())
    (tmp_path / "windy.csv").write_text(table(units).replace(",", separator), encoding="utf-8")
    alone = call("new", "alone.toml", "--rocket", "design.ork")
    assert alone.exit_code == 2 and "the table that it exports" in " ".join(alone.stderr.split())
    made = call("new", "mine.toml", "--rocket", "design.ork", "windy.csv")
    assert made.exit_code == 0, made.output
    scene = scenes.load("mine.toml")
    assert scene.payload.mass == pytest.approx(9.5, rel=1e-5)
    inertia = scene.payload.inertia
    assert (inertia.xx, inertia.yy, inertia.zz) == pytest.approx((0.014, 2.6, 2.6), rel=1e-5)
    assert sorted({pad.position[0] for pad in scene.pads}) == pytest.approx([-0.7, 0.1], abs=1e-5)
    assert scene.thrust.requested() == pytest.approx(0.5 * 45 + 900 * 1.95 + 45, rel=1e-5)
    for key, words in {
        "payload.mass": ("windy.csv: line 5", "Mass ("),
        "payload.inertia": ("windy.csv: line 5", "Rotational moment of inertia ("),
        "thrust": ("windy.csv: ", "Thrust ("),
        "buttons": ("design.ork: ", "railbutton"),
    }.items():
        text = scenes.provenance.nearest(scene.provenance, key)
        assert text.startswith(words[0]) and words[1] in text, text


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "a table of OpenRocket with the column Mass.*Time.*Thrust"),
        (
            table().replace("CG location (m)", "CP location (m)").replace("Thrust (N)", "Drag (N)"),
            "the column CG location; the column Thrust; header",
        ),
        (table(mass="N", force="kg"), "Mass in a unit of kg .given N.; Thrust in a unit of N"),
        (table(inertia="s"), "Longitudinal moment of inertia in a unit of kg.m\\*\\*2 .given s"),
        (table(inertia=""), "the column Longitudinal moment of inertia; the column Rotational"),
        (table(m="0", a="NaN"), "Mass above zero in its first line.*Longitudinal.*given nan"),
        (table(f="0"), "a thrust above zero"),
        (table().replace("\n2.1,", "\n1.1,"), "times in increasing order"),
        (table().replace("\n0,0,", "\n0.5,0,"), "the launch in its first line"),
        (table(c="here"), "CG location .m.: a number .'here'"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused_with_all_that_is_wrong(text, words):
    with pytest.raises(ValueError, match=f"(?s){words}"):
        read_simulation(text.encode(), "windy.csv")


def test_the_faults_of_a_design_and_of_its_table_are_listed_together(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    (tmp_path / "design.ork").write_text(without_results().replace("railbutton", "fin"))
    (tmp_path / "windy.csv").write_text(table(force="kg"))
    made = call("new", "mine.toml", "--rocket", "design.ork", "windy.csv")
    assert made.exit_code == 2 and "2 faults" in made.stderr
    assert "two rail buttons" in made.stderr and "Thrust in a unit" in made.stderr
    assert "stored data" not in made.stderr
    many = call("new", "mine.toml", "--rocket", "design.ork", "windy.csv", "windy.csv")
    assert many.exit_code == 2 and "at most one table" in many.stderr
    assert not (tmp_path / "mine.toml").exists()
