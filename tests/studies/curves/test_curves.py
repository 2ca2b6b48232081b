"""`tipoff curves`: files of several codes with one motion, and a run of tipoff."""

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

import tipoff
from tests.formats.curves import dyna_files
from tipoff.comparison.curves import Curves
from tipoff.studies.cli import app
from tipoff.studies.curves import stage
from tipoff.studies.curves.results import Compared

END = 8.0  # ms
UNITS = ("--units", "dyna: time=ms, length=mm")


def motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,) ms, v_x (n,) m/s, rates (n,3) rad/s: they rise in 4 ms and stay."""
    time = np.linspace(0.0, END, 161)
    rise = np.minimum(time / 4.0, 1.0)
    return time, 20.0 * rise, np.outer(rise, [0.01, 0.02, -0.03])


def table(path, factor=1.0, late=0.0):
    """A table between tabs, as of Adams, whose rates are ``factor`` times larger and ``late`` (ms)."""
    time, speed, rate = motion()
    lines = ["Plot_1", "Time\tVX\tWX\tWY\tWZ"]
    for instant, values in zip(time, np.column_stack([speed, factor * np.degrees(rate)])):
        lines.append("\t".join(map(repr, [float(instant + late), *values.tolist()])))
    path.write_text("\n".join(lines))
    return path


def binout(path):
    """The same motion in binout, in mm and ms, with a state every 0.05 ms."""
    states = [(time, (speed, 0.0, 0.0), 1e-3 * rate) for time, speed, rate in zip(*motion())]
    path.write_bytes(dyna_files.rigid_body(states).content)
    return path


ADAMS = (
    *("--columns", "adams: time=Time, velocity_x=VX, rate_x=WX, rate_y=WY, rate_z=WZ"),
    *("--units", "adams: time=ms, velocity_x=m/s, rate=deg/s"),
)


def call(out, *arguments):
    asked = ["curves", "--scene", "tiny", "--out", str(out), *map(str, arguments)]
    return CliRunner().invoke(app, asked, catch_exceptions=False)


def found(out) -> Compared:
    return stage.STAGE.read(json.loads((out / "tiny" / "curves.json").read_text()))


def test_two_codes_with_one_motion_are_equal(tmp_path):
    """Finite elements of LS-DYNA in mm and ms against a table of Adams in deg/s."""
    files = binout(tmp_path / "binout0000"), table(tmp_path / "adams.tab")
    said = call(tmp_path, f"dyna={files[0]}", f"adams={files[1]}", *ADAMS, *UNITS)
    assert said.exit_code == 0, said.output
    result = found(tmp_path)
    reference, other = result.rows
    assert (result.reference, reference.curve, other.curve) == ("dyna", "dyna", "adams")
    assert reference.settled_rate_deg_s == pytest.approx(np.degrees([0.01, 0.02, -0.03]), rel=1e-4)
    # scene axes become body axes: they differ by the angle of the payload, 2e-4 rad
    assert other.rate_relative_l2 < 3e-4 and other.velocity_relative_l2 < 1e-12
    assert other.iso18571 > 0.9999 and result.ratings[0].velocity_x == 1.0
    assert "ISO 18571" in said.stdout and (tmp_path / "tiny" / "figures" / "curves.png").exists()


def test_a_factor_is_the_relative_difference(tmp_path):
    """Rates 10 % larger: L2 and the magnitude of Sprague and Geers are 10 %, the phase is zero."""
    one, two = table(tmp_path / "a.tab"), table(tmp_path / "b.tab", 1.1)
    asked = [text.replace("adams: ", "") for text in ADAMS]
    assert call(tmp_path, one, two, *asked).exit_code == 0
    row = found(tmp_path).rows[1]
    assert row.curve == "b.tab"
    assert row.rate_relative_l2 == pytest.approx(0.1)
    assert row.sprague_geers_magnitude == pytest.approx(0.1)
    assert row.sprague_geers_phase == pytest.approx(0.0, abs=1e-7)
    error = 0.1 * math.degrees(0.03)
    assert row.settled_rate_error_deg_s == pytest.approx(error)


def test_a_file_without_v_x_is_compared_by_its_rates(tmp_path):
    files = binout(tmp_path / "binout0000"), table(tmp_path / "adams.tab")
    columns = ADAMS[1].replace("velocity_x=VX, ", "")
    said = call(
        tmp_path, f"dyna={files[0]}", f"adams={files[1]}", "--columns", columns, *ADAMS[2:], *UNITS
    )
    assert said.exit_code == 0, said.output
    result = found(tmp_path)
    assert result.rows[1].velocity_relative_l2 is None and result.ratings[0].velocity_x is None
    assert result.drawn["adams"].velocity_m_s is None and result.rows[1].iso18571 > 0.9999


def test_a_run_of_tipoff_is_one_more_curve(tmp_path):
    """A file of a run equals the run; a calibration for springs is for them alone."""
    scene = tipoff.load("tiny").condition("phi15")
    tipoff.run(scene, "springs").to_csv(tmp_path / "run.csv")
    asked = ("--condition", "phi15", "--model", "springs", "--settled-from", "20.14 ms")
    said = call(tmp_path, f"file={tmp_path / 'run.csv'}", *asked)
    assert said.exit_code == 0, said.output
    result = found(tmp_path)
    assert result.condition == "phi15" and result.rows[1].curve == "tipoff springs"
    assert result.rows[1].rate_relative_l2 < 1e-3
    again = call(tmp_path, f"file={tmp_path / 'run.csv'}", *asked)
    assert "curves: tiny" not in again.stderr  # stored


def test_one_start_is_for_files_and_runs(tmp_path):
    """Rates that change all the time have equal settled values in one window. Control: a file that ends
    in mid-run has a window of its own, and the note says so."""
    scene = tipoff.load("tiny").condition("phi15")
    run = tipoff.run(scene, "springs")
    run.to_csv(tmp_path / "run.csv")
    head, *lines = (tmp_path / "run.csv").read_text().splitlines()
    short = [line for line in lines if float(line.partition(",")[0]) <= 7e-3]
    (tmp_path / "short.csv").write_text("\n".join([head, *short]))
    asked = (f"file={tmp_path / 'short.csv'}", "--condition", "phi15", "--model", "springs")
    said = call(tmp_path, *asked, "--settled-from", "4 ms")
    assert said.exit_code == 0, said.output
    file, own = found(tmp_path).rows
    assert file.settled_from_s == own.settled_from_s == 4e-3
    assert own.settled_rate_error_deg_s < 0.01 and "different times" not in said.stdout
    said = call(tmp_path, *asked)
    file, own = found(tmp_path).rows
    assert file.settled_from_s == pytest.approx(5e-3) and own.settled_rate_error_deg_s > 0.1
    assert own.settled_from_s == pytest.approx(run.outcome.window_start)
    assert "begin at different times" in said.stdout
    assert '--settled-from "5 ms"' in said.stdout


def test_curves_and_runs_are_compared_from_python(tmp_path):
    run = tipoff.run(tipoff.load("tiny").condition("phi15"), "springs")
    run.to_csv(tmp_path / "run.csv")
    read = Curves.read(tmp_path / "run.csv", run.outcome.window_start)
    assert tipoff.compare(run, read).rate_relative_l2 < 1e-3
    assert tipoff.compare(read, run).lateral_velocity_difference_m_s is None


@pytest.mark.parametrize(
    "arguments, words",
    [
        ([], "FILE: files: given nothing, expected two files, or one file and --model"),
        (["{a}"], "FILE: files: given a.tab"),
        (["{a}", "{a}"], "FILE: name: given 'a.tab' twice, expected NAME=FILE"),
        (["x={a}", "y={b}", "--condition", "phi15"], "--condition: option: given phi15"),
        (["x={a}", "--model", "soft"], "--model: name: given soft, expected one of compliant"),
        (["x={a}", "--model", "springs", "--condition", "phi16"], "phi16"),
        (["x={a}", "y={b}", "--axes", "up"], "--axes: value: given 'up', expected body or scene"),
        (["x={a}", "y={b}", "--settled-from", "5"], "--settled-from: value: given 5"),
        (["x={a}", "y={b}"], "a.tab: time: given no unit"),
        (["x={a}", "y=nowhere"], "nowhere: file: given No such file"),
    ],
)
def test_a_refusal_is_one_line_for_each_fault(arguments, words, tmp_path):
    """Nothing is written, and refusals of files name the section of the documentation."""
    places = {name: table(tmp_path / f"{name}.tab") for name in "ab"}
    columns = [text.replace("adams: ", "") for text in ADAMS[:2]]
    said = call(tmp_path / "out", *(text.format(**places) for text in arguments), *columns)
    assert said.exit_code == 2 and words in said.stderr, said.output
    assert not (tmp_path / "out").exists()
    if ".tab: " in words or "nowhere: " in words:
        assert "(file formats, Curves)" in said.stderr
