"""The options that say where the quantities of a file are."""

import pytest

from tipoff.comparison.layout import Layout, of_options
from tipoff.faults import SceneError


def test_a_text_is_for_all_files_or_for_one_and_that_of_one_wins():
    found = of_options(
        ["dyna", "adams"],
        columns=["adams: time=Time, rate_x=-WX", "rate_x=3, rate_y=4"],
        units=["time=ms", "dyna: length=mm"],
        body=["dyna: nodal 7"],
        axes=["scene", "adams:body"],
        ignition=["dyna: 100 ms"],
    )
    assert found["dyna"] == Layout(
        columns=(("rate_x", "3"), ("rate_y", "4")),
        units=(("time", "ms"), ("length", "mm")),
        body="nodal 7",
        axes="scene",
        ignition=0.1,
    )
    assert dict(found["adams"].columns) == {"rate_x": "-WX", "rate_y": "4", "time": "Time"}
    assert found["adams"].axes == "body" and found["adams"].body is None


def test_a_layout_says_what_it_states():
    assert Layout().words == ""
    words = Layout((("time", "1"),), (("rate", "deg/s"),), "7", "scene", 0.1).words
    assert (
        words == "columns time=1; units rate=deg/s; body 7; rates in scene axes; ignition at 100 ms"
    )


def test_a_name_of_a_column_may_have_a_colon():
    found = of_options(["a"], columns=["rate_x=VR1 PI: PART-1 N: 7"])["a"]
    assert found.columns == (("rate_x", "VR1 PI: PART-1 N: 7"),)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"columns": ["time"]}, "--columns: time: given 'time', expected QUANTITY=TEXT"),
        ({"columns": ["rate_a=3"]}, "--columns: quantity: given 'rate_a'|did you mean"),
        ({"columns": ["b: time=3"]}, "--columns: quantity: given 'b: time'"),
        ({"columns": ["time=1, time=2"]}, "--columns: time: given twice, expected once"),
        ({"units": ["time="]}, "--units: time: given 'time=', expected QUANTITY=TEXT"),
        ({"ignition": ["soon"]}, "--ignition: value: given 'soon', expected a quantity in s"),
        ({"axes": ["global"]}, "--axes: value: given 'global', expected body or scene"),
    ],
)
def test_a_fault_of_an_option_is_one_line(given, words):
    with pytest.raises(SceneError) as caught:
        of_options(["a"], **given)
    assert all(word in str(caught.value) for word in words.split("|")), str(caught.value)


def test_all_faults_are_listed():
    with pytest.raises(SceneError) as caught:
        of_options(["a"], columns=["x=1"], units=["y=2"], axes=["z"])
    assert [fault.source for fault in caught.value.faults] == ["--columns", "--units", "--axes"]
