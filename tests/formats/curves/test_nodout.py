"""nodout, rbdout and binout of LS-DYNA."""

import re

import numpy as np
import pytest

from tests.formats.curves import dyna_files as dyna
from tipoff.comparison.layout import of_options
from tipoff.comparison.quantities import Found, read_quantities
from tipoff.formats.curves.binout import is_one

UNITS = "time=ms, length=mm"


def layout(units=UNITS, **others):
    return of_options(["a"], units=[units] if units else (), **others)["a"]


def require_motion(found: Found) -> None:
    """2 mm/ms are 2 m/s, and 1e-5 rad/ms are 0.01 rad/s."""
    assert not found.faults
    assert found.values["time"] == pytest.approx([0.0, 5e-4])
    assert found.values["velocity_x"] == pytest.approx([0.0, 2.0])
    for axis, rate in zip("xyz", (0.01, 0.02, 0.03)):
        # the payload turns by 1e-5 rad in the file, so body axes differ by 1e-5 of the rate
        assert found.values[f"rate_{axis}"] == pytest.approx([0.0, rate], rel=1e-4)


def said(found: Found) -> str:
    return "\n".join(map(str, found.faults))


@pytest.mark.parametrize("text", [dyna.NODOUT, dyna.RBDOUT], ids=["nodout", "rbdout"])
def test_a_text_file_has_the_motion(text, tmp_path):
    require_motion(read_quantities(dyna.written(tmp_path, "a", text), layout()))


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("real", ["f4", "f8"])
@pytest.mark.parametrize("whole", ["i4", "i8"])
def test_a_binary_file_has_the_motion(order, real, whole, tmp_path):
    """The tables of symbols and other databases do not move the data; folders may be relative."""
    file = dyna.binout(order, real, whole)
    path = dyna.written(tmp_path, "binout0000", file.content)
    require_motion(read_quantities(path, layout(body=["7"])))


def test_a_header_is_that_of_a_file_of_ls_dyna():
    """The first bytes of a file that LS-DYNA R11 wrote, up to the first folder."""
    real = bytes.fromhex("0808080101010000 1100000000000000 07b308000000000000")
    assert is_one(real)
    own = dyna.Lsda().content
    assert (own[:17], len(own)) == (real[:17], len(real))
    assert not is_one(b"time,velocity_x") and not is_one(b"\t1\t2\t3\t4\t5")


def test_columns_may_be_any_others_with_a_sign(tmp_path):
    """The rail along -Y of the model. Control: a displacement is no rate, and LS-DYNA has rad."""
    path = dyna.written(tmp_path, "a", dyna.NODOUT)
    found = read_quantities(path, layout(columns=["velocity_x=-y_velocity"]))
    assert found.values["velocity_x"] == pytest.approx([0.0, 1e-3])
    assert "rate_y: given 'mm'" in said(read_quantities(path, layout(columns=["rate_y=3"])))
    other = read_quantities(path, layout(f"{UNITS}, rate_z=deg/ms"))
    assert "rate_z: given deg/ms in --units, expected rad/ms, the unit in the file" in said(other)


@pytest.mark.parametrize("body", ["7", "9", "nodal 9"])
def test_one_of_several_bodies_is_chosen_by_its_number(body, tmp_path):
    """Control: without a number both are listed."""
    path = dyna.written(tmp_path, "rbdout", dyna.two_bodies())
    found = read_quantities(path, layout(body=[body]))
    assert found.values["velocity_x"] == pytest.approx([0.0, 2.0] if body == "7" else [1.0, 3.0])
    assert "--body: given no number, expected one of 7, nodal 9" in said(
        read_quantities(path, layout())
    )


def test_a_binary_file_goes_on_in_its_next_part(tmp_path):
    """Control: without the next part only its own states are there."""
    states = [(0.5 * step, (float(step), 0, 0), (0.0, 0, 0)) for step in range(4)]
    whole = dyna.rigid_body(states).content
    path = dyna.written(tmp_path, "binout0000", dyna.rigid_body(states[:2]).content)
    assert read_quantities(path, layout()).values["velocity_x"] == pytest.approx([0.0, 1.0])
    more = dyna.Lsda()
    for place, (time, speed, _) in enumerate(states[2:], 3):
        more.folder(f"/rbdout/d{place:06d}")
        more.data("time", "f8", time)
        for axis, one in zip("xyz", speed):
            more.data(f"global_v{axis}", "f8", one)
            more.data(f"global_rv{axis}", "f8", 0.0)
    dyna.written(tmp_path, "binout0000%001", more.content)
    found = read_quantities(path, layout())
    assert found.values["velocity_x"] == pytest.approx([0.0, 1.0, 2.0, 3.0])
    one = read_quantities(dyna.written(tmp_path, "whole", whole), layout())
    assert (found.values["velocity_x"] == one.values["velocity_x"]).all()
    dyna.written(tmp_path, "binout0000%002", "no part")
    assert "%002: file: given no header of LSDA" in said(read_quantities(path, layout()))


def test_the_bodies_of_a_binary_file_are_listed(tmp_path):
    path = dyna.written(tmp_path, "binout0000", dyna.binout().content)
    assert "given no number, expected one of rbdout 7, rbdout nodal 9" in said(
        read_quantities(path, layout())
    )
    assert "given '8', expected one of rbdout 7" in said(read_quantities(path, layout(body=["8"])))
    found = read_quantities(path, layout(body=["9"]))
    assert found.values["velocity_x"] == pytest.approx([-1.0, -1.0])


def test_nodes_of_a_binary_file(tmp_path):
    file = dyna.Lsda()
    file.folder("/nodout/metadata")
    file.data("ids", "i8", 1001, 1002)
    for step in range(3):
        file.folder(f"/nodout/d{step + 1:06d}")
        file.data("time", "f4", step)
        for name in ("x_velocity", "rx_velocity", "ry_velocity", "rz_velocity"):
            file.data(name, "f4", 0.0, float(step))
    found = read_quantities(dyna.written(tmp_path, "b", file.content), layout(body=["1002"]))
    assert found.values["velocity_x"] == pytest.approx([0.0, 1.0, 2.0])


def test_a_stopped_run_ends_with_its_last_whole_state(tmp_path):
    """A file cut in a line, or between the two blocks of a time."""
    line = dyna.NODOUT.rindex("     1001")
    block = dyna.NODOUT.rindex("\n\n\n n o d a l")
    for cut in (line + 40, block):
        found = read_quantities(dyna.written(tmp_path, "a", dyna.NODOUT[:cut]), layout())
        assert not found.faults and found.values["time"].tolist() == [0.0]


@pytest.mark.parametrize(
    "change, words",
    [
        (lambda t: t.replace("2.0000E+00 -1.0000E-03", "2.0000E+00 ?"), "'?' in line"),
        (lambda t: t.replace("2.0000E+00 -1.0000E-03", "2.0000E+00"), "values"),
        (lambda t: t.replace("2.0000E+00 -1.0000E-03", "nan        -1.0000E-03"), "1 values NaN"),
        (lambda t: t.replace("5.00000E-01 )", "soon )").replace("5.000000E-01", "soon"), "'soon'"),
        (
            lambda t: t.replace("velocities:  ", "speeds:  ").replace("x-rot", "x-arc"),
            "no such column|values",
        ),
    ],
)
@pytest.mark.parametrize("text", [dyna.NODOUT, dyna.RBDOUT], ids=["nodout", "rbdout"])
def test_a_fault_of_a_text_file_is_one_line(text, change, words, tmp_path):
    found = read_quantities(dyna.written(tmp_path, "a", change(text)), layout())
    assert any(word in said(found) for word in words.split("|")), said(found)


def test_nodes_of_solid_elements_have_no_rates(tmp_path):
    """Their file has no block of rotations."""
    start = dyna.NODOUT.index("\n\n\n n o d a l", dyna.NODOUT.index("x-coor"))
    end = dyna.NODOUT.index("\n\n\n n o d a l", start + 1)
    text = dyna.NODOUT[:start] + dyna.NODOUT[end : dyna.NODOUT.rindex("\n\n\n n o d a l")]
    found = read_quantities(dyna.written(tmp_path, "nodout", text), layout())
    assert [fault.key for fault in found.faults] == ["rate_x", "rate_y", "rate_z"]
    assert "no such column 'rx_velocity'" in said(found) and "write rbdout" in said(found)


def test_rotations_that_are_all_zero_are_those_of_a_solid(tmp_path):
    """LS-DYNA writes zeros for the rotations of its nodes. Control: about one axis alone is motion."""
    turned = "1.0000E-05  2.0000E-05  3.0000E-05"
    still = "0.0000E+00  0.0000E+00  0.0000E+00"
    assert turned in dyna.NODOUT
    path = dyna.written(tmp_path, "nodout", dyna.NODOUT.replace(turned, still))
    assert "rates: given 0 at every time" in said(found := read_quantities(path, layout()))
    assert "write rbdout" in said(found)
    one = dyna.NODOUT.replace(turned, f"1.0000E-05{still[10:]}")
    assert not read_quantities(dyna.written(tmp_path, "nodout", one), layout()).faults


def touching(text: str) -> str:
    """A file whose numbers have five digits behind the point, and fill twelve columns if negative."""
    whole = re.compile(r" ( |-)(\d\.\d{4})(E[+-]\d\d|[+-]\d{3})(?=\s)")
    return whole.sub(lambda found: f"{found[1]}{found[2]}0{found[3]}", text)


@pytest.mark.parametrize("text", [dyna.NODOUT, dyna.RBDOUT], ids=["nodout", "rbdout"])
def test_numbers_may_fill_their_columns(text, tmp_path):
    """Control: between blanks the line has fewer words than columns."""
    text = text.replace("0.0000E+00 ", "-.0000E+00 ").replace(" -.0000E+00", "-0.0000E+00")
    tight = touching(text)
    assert re.search(r"\dE[+-]\d\d-\d", tight)
    loose = read_quantities(dyna.written(tmp_path, "a", text), layout())
    found = read_quantities(dyna.written(tmp_path, "b", tight), layout())
    require_motion(found)
    for name, values in loose.values.items():
        np.testing.assert_array_equal(found.values[name], values)


@pytest.mark.parametrize("text", [dyna.NODOUT, dyna.RBDOUT], ids=["nodout", "rbdout"])
@pytest.mark.parametrize("lost", [*range(1, 14), 36, 72])
def test_a_cut_number_is_not_taken_for_another_one(text, lost, tmp_path):
    """5.0E-06 without its exponent is 5. A line of six numbers may be cut to the length of one of three. The
    whole file without its last line end is read."""
    last = (
        text.rindex("  6.0000-105\n") + 12
        if text is dyna.NODOUT
        else text.rindex("6.0000E-05\n") + 10
    )
    found = read_quantities(dyna.written(tmp_path, "a", text[: last - lost]), layout())
    assert not found.faults and found.values["time"].tolist() == [0.0]
    found = read_quantities(dyna.written(tmp_path, "b", text[:last]), layout())
    assert not found.faults and len(found.values["time"]) == 2


def test_a_cut_line_of_one_kind_may_have_the_length_of_another(tmp_path):
    """Twelve numbers of a node, cut to the nine of its rotation."""
    moved = dyna.NODOUT.rsplit("\n\n\n n o d a l", 1)[0].rstrip("\n")
    found = read_quantities(dyna.written(tmp_path, "a", moved[:-36]), layout())
    assert not found.faults and found.values["time"].tolist() == [0.0]


@pytest.mark.parametrize(
    "units, words",
    [
        (None, '--units: given no units, expected those of the model, such as --units "time=ms'),
        ("length=mm", "time: given no unit"),
        ("time=ms", "velocity_x: given no unit"),
        ("time=ms, length=kg", "velocity_x: given 'kg/ms'"),
    ],
)
def test_units_are_never_guessed(units, words, tmp_path):
    found = read_quantities(dyna.written(tmp_path, "a", dyna.NODOUT), layout(units))
    assert words in said(found)


@pytest.mark.parametrize(
    "content, words",
    [
        (dyna.binout().content[:-5], "a record of"),
        (dyna.binout().content[:200], "a record of"),
        (dyna.Lsda().content, "no rbdout and no nodout"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "given HDF5"),
        (dyna.HEADER + bytes([1, 0, 0]) + bytes(40), "a record of 0 bytes at byte 8"),
    ],
)
def test_a_fault_of_a_binary_file_is_one_line(content, words, tmp_path):
    found = read_quantities(dyna.written(tmp_path, "binout", content), layout())
    assert len(found.faults) == 1 and words in said(found)


def test_a_state_without_a_value_is_refused(tmp_path):
    file = dyna.binout(steps=2)
    file.folder("/rbdout/d000003")
    file.data("time", "f4", 1.0)
    file.folder("/rbdout/d000004")
    file.data("time", "f4", 1.5)
    path = dyna.written(tmp_path, "binout", file.content)
    assert "no global_vx at time 1" in said(read_quantities(path, layout(body=["7"])))
    np.testing.assert_allclose(read_quantities(path, layout(body=["7"])).values.get("time", 0), 0)
