"""Quantities: what is read, and what is refused because it could mean something else."""

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tipoff import units
from tipoff.units import parse, to_si


@pytest.mark.parametrize(
    "text, unit, value",
    [
        ("0.05 mm", "m", 5e-5),
        ("1e-3m", "m", 1e-3),
        ("20 µm", "m", 2e-5),
        ("-88 mm", "m", -0.088),
        (".5 m", "m", 0.5),
        ("180 deg", "rad", math.pi),
        ("0.5 mrad", "rad", 5e-4),
        ("5 rpm", "rad/s", math.pi / 6),
        ("57 deg/s", "rad/s", math.radians(57)),
        ("70000 N/mm**1.5", "N/m**1.5", 7e4 * 1e3**1.5),
        ("60 N*s/mm", "N*s/m", 6e4),
        ("72 GPa", "Pa", 7.2e10),
        ("0.2", "dimensionless", 0.2),
        ("33 %", "dimensionless", 0.33),
    ],
)
def test_units(text, unit, value):
    assert to_si(text, unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    "text, unit",
    [
        ("9.9 m", "kg"),
        ("9.9", "kg"),
        ("0.1", "rad"),
        ("5 Hz", "rad/s"),
        ("5 1/s", "rad/s"),
        ("10 deg", "dimensionless"),
        ("nan kg", "kg"),
        ("-inf kg", "kg"),
        ("1e400 kg", "kg"),
        ("", "m"),
        ("m", "m"),
        ("one m", "m"),
        ("1 m, 2", "m"),
        ("1 furlongx", "m"),
        ("9**9**9 m", "m"),
        ("1,5 mm", "m"),
        ("__import__('os')", "m"),
    ],
)
def test_refused(text, unit):
    with pytest.raises(ValueError, match=f"a (quantity in {unit.split('*')[0]}|number)"):
        to_si(text, unit)


def test_a_long_text_is_refused_at_once():
    """Control: a pattern that tries all divisions of a word takes 10 s for 24 letters, twice as long
    for each further one, and would not end here."""
    with pytest.raises(ValueError, match="is no unit"):
        to_si("1 " + "sensor" * 15 + " = 3", "s")


@pytest.mark.parametrize("value", [True, None, [], {}, b"1 m", 1j])
def test_only_text_and_numbers(value):
    with pytest.raises(ValueError, match="a quantity in m"):
        parse(value, "m", bare_numbers_are_si=True)


def test_a_bare_number_is_si_only_where_allowed():
    assert parse(2, "m", bare_numbers_are_si=True) == 2.0
    assert parse(2, "dimensionless", bare_numbers_are_si=False) == 2.0
    with pytest.raises(ValueError, match='for example "2 m"'):
        parse(2, "m", bare_numbers_are_si=False)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_si_text_is_read_to_the_bit(value):
    assert to_si(f"{value!r} m", "m") == value


@given(number=st.floats(-1e9, 1e9))
def test_factors_of_common_units_are_those_of_pint(number):
    for unit, known in units.COMMON_FACTORS.items():
        for text, factor in {**known, unit: 1.0}.items():
            expected = units.registry().Quantity(number, text).to(unit).magnitude
            assert number * factor == expected == to_si(f"{number!r} {text}", unit)


def test_a_scene_of_common_units_is_read_without_pint():
    code = (
        "import sys; from tipoff import scenes; scenes.load('reference'); "
        "assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_threads_that_read_the_first_unit_together_share_one_registry():
    """In a process that has read none. Without a lock each would load its own."""
    program = """
import threading
from tipoff.units import registry
barrier, found = threading.Barrier(8), set()
def read():
    barrier.wait()
    found.add(registry())
threads = [threading.Thread(target=read) for _ in range(8)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(len(found))
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.stdout == "1\n", run.stderr


@pytest.mark.parametrize(
    "time, text",
    [
        (0.0, "0 ms"),
        (-0.00125, "-1.25 ms"),
        (0.04436, "44.36 ms"),
        (0.9999, "999.9 ms"),
        (0.99999, "1 s"),
        (1.0, "1 s"),
        (44.36, "44.36 s"),
        (44360.0, "4.436e+04 s"),
    ],
)
def test_a_time_is_in_milliseconds_up_to_a_second(time, text):
    assert units.duration(time, 4) == text
