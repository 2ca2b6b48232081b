"""A table whose file ends inside a number: 1.2345 is not taken for 1.2345E-03."""

import pytest

from tipoff.faults import SceneError
from tipoff.formats.instrument_table import read_table

EXPONENTS = "".join(f"{k}.0E-03,{k}.2345E-03\n" for k in range(1, 13))
DECIMALS = "".join(f"0.{k:03d};{k},2345\n" for k in range(1, 13))
NAMES = "t [s],w [deg/s]\n"


def rows(text, is_loose=True):
    return read_table("a.csv", text.encode(), lambda cells: 0.5, is_loose).rows


@pytest.mark.parametrize("lost", range(2, 16))
@pytest.mark.parametrize("text", [EXPONENTS, DECIMALS], ids=["exponents", "decimals"])
def test_a_cut_last_line_is_left_out_of_a_curve(text, lost):
    """Control: the whole file without its last line end has all lines."""
    whole = NAMES.replace(",", ";" if text is DECIMALS else ",") + text
    assert len(rows(whole[:-1])) == len(rows(whole)) == 12
    start = whole.rindex("\n", 0, -1) + 1
    left = whole[: max(start + 1, len(whole) - lost)]
    assert rows(left) == rows(whole)[:-1]


def test_a_cut_last_number_of_another_table_is_refused():
    with pytest.raises(SceneError, match="last line without its end"):
        rows((NAMES + EXPONENTS)[:-5], is_loose=False)


def test_a_table_by_hand_may_end_without_a_line_end():
    """Its numbers are written in any way. So are those of a program, with as many digits as they need."""
    short = "0.0,0\n0.004,6000.5\n0.009,0"
    assert len(rows(NAMES + short, is_loose=False)) == 3
    longer = "".join(f"{k},{k}\n" for k in range(30)) + "30,0.5"
    assert len(rows(NAMES + longer, is_loose=False)) == 31
    long = "".join(f"{k / 7!r},{k / 3!r}\n" for k in range(30)) + "30.5,0"
    assert len(rows(NAMES + long, is_loose=False)) == 31
