"""Input that no person would write, and that must be refused all the same: with its faults, at once,
and without taking the memory of the machine. The sound neighbours of each are controls."""

import os

import pytest

from tests.scenes.support import refused, small
from tipoff.files import MOST_TEXT
from tipoff.formats.csv_file import MOST_LINES, listed
from tipoff.scenes import SceneError, load, parse, uncertainty
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.overrides import DEEPEST
from tipoff.scenes.scene import CATALOG
from tipoff.scenes.table import MOST
from tipoff.units import to_si

pytestmark = pytest.mark.case("X19")

MATERIAL = (
    'material = { density = "1 kg/m**3", youngs_modulus = "1 Pa", poisson_ratio = 0.3 }\n'
    'start = "0 m"\nend = "1 m"\n'
)


def faults_of(folder, text: str) -> list:
    """Faults of a scene file."""
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        load(path)
    return caught.value.faults


def nested(levels: int) -> str:
    return "[conditions.x." + ".".join("a" * levels) + "]\nb = 1\n"


@pytest.mark.parametrize(
    "text, key",
    [
        (
            'extends = "tiny"\n[agreement]\nheld_out = [["phi15"], { a = 1 }]\n',
            "agreement.held_out.0",
        ),
        ('extends = "tiny"\n[payload]\nmass = ' + "9" * 400, "payload.mass"),
        ('extends = "tiny"\n[payload]\nmass = ' + "9" * 5000, "file"),
        ('extends = "tiny"\n' + nested(600), "tables"),
        ('extends = "tiny"\n' + nested(5000), "tables"),
        ('extends = "tiny"\nx = ' + "[" * 9000 + "]" * 9000, "tables"),
        ('extends = "' + "a" * 300 + '"', "extends"),
        ('extends = "' + "a" * 300 + '.toml"', "extends"),
        ('extends = "a\\u0000.toml"', "extends"),
        ('extends = "tiny"\n[rail]\nmesh = "a\\u0000"\n' + MATERIAL, "rail.mesh"),
        ('extends = "tiny"\n[rail]\nmesh = "/dev/zero"\n' + MATERIAL, "rail.mesh"),
        ('extends = "tiny"\n[rail]\nmesh = "' + "a" * 300 + '"\n' + MATERIAL, "rail.mesh"),
        ('extends = "tiny"\n[thrust]\nkind = "measured"\nfile = "/dev/zero"\n', "thrust.file"),
        (
            'extends = "tiny"\n[conditions.x]\n"pads.².relief" = "1 mm"\n',
            "conditions.x.pads.².relief",
        ),
        ('extends = "tiny"\n[payload]\nsize = ["1e-200 m", "1 m", "1 m"]\n', "payload.size.0"),
        ('extends = "tiny"\n[payload]\nmass = "1 kg*9**9**9"\n', "payload.mass"),
    ],
)
def test_a_file_is_refused_with_the_key(tmp_path, text, key):
    assert key in [fault.key for fault in faults_of(tmp_path, text)]


def test_tables_of_a_program_are_bounded_too():
    deep: dict = {}
    for _ in range(2000):
        deep = {"a": deep}
    assert refused(small(conditions={"x": deep}))[0].key == "tables"
    with pytest.raises(SceneError, match="no such key"):
        parse(small()).replace({"payload." + "a." * 5000 + "b": 1.0})
    with pytest.raises(SceneError, match="tables"):
        parse(small()).replace({"payload": deep})
    path = "a." * (DEEPEST - 4) + "b"
    assert refused(small(conditions={"x": {path: 1.0}}))[0].key.startswith("conditions.x")


def test_more_names_than_a_scene_may_have_are_refused_at_once():
    names = [f"n{number}" for number in range(40_000)]
    found = refused(small(agreement={"fitted": names}))
    assert found[0].key == "agreement.fitted" and str(MOST) in found[0].expected
    conditions = {name: {"payload.mass": "9 kg"} for name in names}
    assert [fault.key for fault in refused(small(conditions=conditions))] == ["conditions"]
    few = dict(list(conditions.items())[:3])
    assert len(parse(small(conditions=few)).conditions) == 3


@pytest.mark.parametrize(
    "unit",
    [
        *("kg*9**9**9", "kg**9**9**9", "kg*(9**99999999)", "kg*9.0", "kg**1e40", "2 kg"),
        *("(" * 60 + "kg" + ")" * 60, "kg*" * 90 + "kg", "k" * 100_000, "kg**999"),
    ],
)
def test_a_unit_is_no_arithmetic(unit):
    with pytest.raises(ValueError, match="is no unit"):
        to_si(f"1 {unit}", "kg")


@pytest.mark.parametrize(
    "text, unit, value",
    [
        ("1 N/mm**1.5", "N/m**1.5", 1000.0**1.5),
        ("1 N/mm^(3/2)", "N/m**1.5", 1000.0**1.5),
        ("2 kg m^2", "kg*m**2", 2.0),
        ("2 kg·m²", "kg*m**2", 2.0),
        ("5 1/K", "1/K", 5.0),
        ("3 (kg*m)/s**2", "N", 3.0),
        ("4 µm", "m", 4e-6),
        ("50 %", "dimensionless", 0.5),
        ("180 °", "rad", 3.141592653589793),
        ("1 m s**-1", "m/s", 1.0),
    ],
)
def test_units_as_people_write_them(text, unit, value):
    """Control."""
    assert to_si(text, unit) == pytest.approx(value, rel=1e-15)


def test_a_byte_order_mark_is_no_fault(tmp_path):
    text = (CATALOG / "tiny.toml").read_text(encoding="utf-8")
    (tmp_path / "tiny.toml").write_text(text, encoding="utf-8-sig")
    assert load(tmp_path / "tiny.toml").hash == load("tiny").hash


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(SceneError, match="not a regular file"):
        load(tmp_path / "pipe.toml")
    with pytest.raises(SceneError, match="not a regular file"):
        uncertainty.load(tmp_path / "pipe.toml", load("tiny"))
    with pytest.raises(SceneError, match="not a regular file"):
        listed(tmp_path / "pipe.toml")
    with pytest.raises(OSError, match="not a regular file"):
        Calibration.load(tmp_path / "pipe.toml")


def test_links_in_a_circle(tmp_path):
    (tmp_path / "a.toml").symlink_to(tmp_path / "a.toml")
    with pytest.raises(SceneError, match="symbolic links"):
        load(tmp_path / "a.toml")


def test_files_beyond_a_size_are_not_read(tmp_path):
    for name, read in (("a.toml", load), ("a.csv", listed)):
        path = tmp_path / name
        with open(path, "wb") as stream:
            stream.truncate(MOST_TEXT + 1)  # null characters, which take no disk
        with pytest.raises(SceneError, match="larger than 32 MiB|a line of"):
            read(path)


def test_lines_and_columns_of_a_table_are_bounded(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("1,2\n" * (MOST_LINES + 1))
    with pytest.raises(SceneError, match="1,000,000 lines at most"):
        listed(path)
    path.write_text("," * 2000 + "\n")
    with pytest.raises(SceneError, match="2001 columns, 1000 at most"):
        listed(path)
    path.write_text("1,2\n3,4\n")
    assert listed(path) == [(1, ["1", "2"]), (2, ["3", "4"])]


def test_small_and_thin_is_sound():
    """Control of the bounds in ``refusals``: near them, a payload of a gram and a rail of a micrometre."""
    assert parse(small(payload__mass="1e-3 kg")).payload.mass == 1e-3
    assert parse(small(rail__thickness="1 um")).rail.thickness == 1e-6
