"""Tables of cases in CSV files: units in a line or in the cells, bad cells that the scene refuses,
bad headers that are refused at once."""

import numpy as np
import pytest

from tipoff.faults import SceneError
from tipoff.lowfi.ensemble.rows import numbers
from tipoff.lowfi.ensemble.table import TableFile
from tipoff.units import to_si

AXIAL, MASS = "thrust_offset.misalignment.axial", "payload.mass"


def table(folder, *lines: str) -> TableFile:
    path = folder / "cases.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return TableFile(path)


def test_units_in_a_line_or_in_the_cells_are_the_same_bits(tmp_path):
    texts = [f"{value:.6g}" for value in np.random.default_rng(1).uniform(0.0, 1.0, 200)]
    line = table(
        tmp_path,
        f"{AXIAL},{MASS}",
        "deg,g",
        *(f"{text},{9000 + n}" for n, text in enumerate(texts)),
    )
    cells = table(
        tmp_path, f"{AXIAL}, {MASS}", *(f"{text} deg, {9000 + n} g" for n, text in enumerate(texts))
    )
    assert line.asked == cells.asked == 200 and line.identity == cells.identity
    assert (
        line.rows(7, 9)
        == cells.rows(7, 9)
        == [
            {AXIAL: to_si(f"{texts[n]} deg", "rad"), MASS: to_si(f"{9000 + n} g", "kg")}
            for n in (7, 8)
        ]
    )


def test_odd_cells_stay_text_and_empty_keys_of_tables_are_left_out(tmp_path):
    found = table(
        tmp_path,
        f"{AXIAL},{MASS},friction",
        "deg,kg,",
        "x,9.9,absent",
        "nan,9.9,",
        "0.2,9.9",
        "0.3,9.9,,7",
        "",
    )
    assert found.asked == 4
    rows = found.rows(0, 4)
    assert rows[0] == {AXIAL: "x", MASS: 9.9, "friction": "absent"}
    assert rows[1][AXIAL] == "nan" and "friction" not in rows[1]
    assert rows[2]["friction"] == "a missing cell"
    assert rows[3]["cells beyond the header"] == "7"
    inputs = numbers(found.keys, rows)
    assert inputs.shape == (4, 3) and np.isnan(inputs[0, [0, 2]]).all() and inputs[0, 1] == 9.9


@pytest.mark.parametrize("units", [True, False])
def test_empty_cells_of_numbers_are_refused_with_their_lines(tmp_path, units):
    """A case with the value of the scene in place of a hole looks like one that was asked. Each
    column is named at once; a line that is too short has a hole too."""
    cell = "0.1,9" if units else "0.1 deg,9 kg"
    lines = [cell, "0.1,", "", " ,9", "0.1", cell]
    with pytest.raises(SceneError) as refused:
        table(tmp_path, f"{AXIAL},{MASS}", *(["deg,kg"] if units else []), *lines)
    first, second = refused.value.faults
    at = 2 if units else 1
    assert (first.key, first.given) == (MASS, f"nothing in lines {at + 2}, {at + 5}")
    assert (second.key, second.given) == (AXIAL, f"nothing in line {at + 4}")


def test_a_bare_number_is_no_quantity(tmp_path):
    """In a file every number of a dimension carries its unit: 0.1 alone is left for the scene to
    refuse."""
    assert table(tmp_path, AXIAL, "0.1").rows(0, 1) == [{AXIAL: "0.1"}]
    assert table(tmp_path, "friction.static", "0.1").rows(0, 1) == [{"friction.static": 0.1}]


@pytest.mark.parametrize(
    "lines, words",
    [
        ((f"{MASS},payload.weight,{MASS}", "kg,kg,kg"), ["payload.weight", "twice"]),
        ((f"{MASS},{AXIAL}", "m,deg"), [MASS, "'m'"]),
        (("",), ["header"]),
    ],
)
def test_a_bad_header_is_refused_at_once(tmp_path, lines, words):
    with pytest.raises(SceneError) as refused:
        table(tmp_path, *lines)
    assert all(word in str(refused.value) for word in words)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(SceneError, match="cases.csv"):
        TableFile(tmp_path / "cases.csv")


@pytest.mark.parametrize("text", ["payload.mass\n", "payload.mass\nkg\n"])
def test_a_table_without_a_case_is_refused(tmp_path, text):
    (tmp_path / "cases.csv").write_text(text)
    with pytest.raises(SceneError, match="given no case"):
        TableFile(tmp_path / "cases.csv")
