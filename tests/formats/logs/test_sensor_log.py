"""The columns of a log: found by name, in SI, and refused with every fault."""

import numpy as np
import pytest

from tipoff.faults import SceneError
from tipoff.formats.logs.sensor_log import read_sensor_log, zero_and_one

NAMES = {"time": (), "rate": ("wx", "wy", "wz"), "acceleration": (), "temperature": ("temp",)}
UNITS = {"time": None, "rate": "deg/s", "acceleration": None, "temperature": None}
TABLE = "# a logger\nTime (ms);wx;wy;wz;temp (degC)\n0;1,5;2,5;-3,5;20\n2;1,5;;3,5;21\n"


def test_every_column_is_in_si(tmp_path):
    """Decimal commas, an empty cell, a unit that is given, and one with an offset."""
    path = tmp_path / "log.csv"
    path.write_text(TABLE)
    found, notes = read_sensor_log(path, NAMES, UNITS)
    assert found.keys() == {"time", "rate", "temperature"} and notes == []
    assert found["time"][:, 0].tolist() == pytest.approx([0.0, 2e-3])
    expected = np.radians([[1.5, 2.5, -3.5], [1.5, np.nan, 3.5]])
    np.testing.assert_allclose(found["rate"], expected)
    assert found["temperature"][:, 0].tolist() == pytest.approx([293.15, 294.15])


def test_times_of_a_clock_count_from_the_first_sample(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(TABLE.replace("\n0;", "\n1700000000000;").replace("\n2;", "\n1700000000002;"))
    found, notes = read_sensor_log(path, NAMES, UNITS)
    assert found["time"][:, 0].tolist() == [0.0, 2e-3] and "1700000000.000000 s" in notes[0]


def test_a_table_without_a_line_of_numbers_has_no_sample(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(TABLE.partition("\n0;")[0] + "\n")
    found, _ = read_sensor_log(path, NAMES, UNITS)
    assert [len(values) for values in found.values()] == [0, 0, 0]


def test_every_fault_is_named(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(TABLE.replace("wy", "w2").replace("2,5", "2;5"))
    names = NAMES | {"acceleration": ("ax", "ay", "az")}
    with pytest.raises(SceneError) as caught:
        read_sensor_log(path, names, UNITS | {"rate": None, "time": "s"})
    keys = [fault.key for fault in caught.value.faults]
    assert keys == ["wy", "ax", "ay", "az", "units.time", "units.rate", "units.rate"]


def test_a_count_is_no_unit_of_a_header():
    assert zero_and_one("0.5 m/s**2", "m/s**2") == (0.0, 0.5)
    with pytest.raises(ValueError):
        zero_and_one("5 kN", "N", is_header=True)
