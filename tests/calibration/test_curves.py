"""Curves of another code or of a test instead of the reference: reading, refusals, and the fitted
constants."""

import hashlib
import json
import math
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.calibration.support import CONDITIONS, SMALL, TRUTH, own_curves, scene, write_curves
from tipoff import calibration, lowfi
from tipoff.calibration import Curves, parameters
from tipoff.calibration.objective import Objective, targets
from tipoff.scenes import Calibration, SceneError
from tipoff.studies.cli import app

HEAD = "time [ms],velocity_x [m/s],rate_x [deg/s],rate_y [deg/s],rate_z [deg/s]"
LINES = [f"{0.5 * n},{0.1 * n},1,2,3" for n in range(9)]  # 0 to 4 ms


def files(folder) -> dict[str, Curves]:
    return {
        name: Curves.read(write_curves(folder / f"{name}.csv", run))
        for name, run in own_curves().items()
    }


def distance(references: dict[str, Curves], changed: dict) -> float:
    """Objective of the references at the scene's constants with some ``changed``."""
    free = parameters.free(scene())
    residuals = Objective(scene(), targets(scene(), references), free)(
        np.array([item.share(item.read(scene().replace(changed))) for item in free])
    )
    return float(residuals @ residuals)


def test_a_run_written_as_a_file_is_the_run(tmp_path):
    """To the twelve digits written; the settled window of a file ends with its record, some samples
    later, while nothing pushes."""
    for name, read in files(tmp_path).items():
        wanted = Curves.from_trajectory(own_curves()[name])
        last = wanted.time.size
        np.testing.assert_allclose(read.time[:last], wanted.time, rtol=1e-11)
        np.testing.assert_allclose(read.rate[:last], wanted.rate, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(read.settled, wanted.settled, rtol=1e-3)
        assert 0.0 <= read.window_start - wanted.window_start < 3e-4


def test_constants_come_back_from_files(tmp_path):
    """The window of the settled rates differs by some samples, 1e-4 of the rates: that is all the
    objective keeps."""
    found = calibration.run(scene(), files(tmp_path), plan=SMALL)
    for name, value in TRUTH.items():
        assert found.constants[name] == pytest.approx(value, rel=5e-3), name
    assert found.objective < 1e-6
    for name in CONDITIONS:
        assert (
            hashlib.sha256((tmp_path / f"{name}.csv").read_bytes()).hexdigest()
            in found.provenance["references"]
        )


def test_any_sampling_has_the_same_minimum(tmp_path):
    """With a third of the samples, chosen at random, the minimum stays at the true constants,
    except for linear interpolation over some 0.3 ms. Control: the scene's own constants, wrong by
    30 %, stay far away."""
    generator, thinned = np.random.default_rng(3), {}
    for name, run in own_curves().items():
        keep = np.flatnonzero(generator.random(run.time.size) < 1.0 / 3.0)
        path = write_curves(tmp_path / f"{name}.csv", run, np.union1d(keep, [0, run.time.size - 1]))
        thinned[name] = Curves.read(path)
    truth = distance(thinned, TRUTH)
    assert truth < 1e-4 and distance(thinned, {}) > 30.0 * truth


def test_units_in_the_second_line_and_bare_si_agree(tmp_path):
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    one.write_text("\n".join([HEAD, *LINES]))
    names = "rate_z,rate_y,rate_x,velocity_x,time"
    turned = [",".join(reversed(line.split(","))) for line in LINES]
    two.write_text("\n".join([names, "deg/s,deg/s,deg/s,m/s,ms", *turned]))
    first, second = Curves.read(one), Curves.read(two)
    assert (first.rate == second.rate).all() and (first.time == second.time).all()
    assert first.settled == pytest.approx([math.radians(value) for value in (1, 2, 3)])
    assert first.time[-1] == pytest.approx(4e-3) and first.window_start == pytest.approx(2e-3)


def test_a_quoted_header_cell_may_hold_line_breaks(tmp_path):
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    one.write_text("\n".join([HEAD, *LINES]))
    broken = ",".join(f'"{cell.replace(" [", chr(10) + "[")}"' for cell in HEAD.split(","))
    two.write_text("\n".join([broken, *LINES]))
    first, second = Curves.read(one), Curves.read(two)
    assert (first.rate == second.rate).all() and (first.time == second.time).all()


def test_the_window_begins_at_the_given_time(tmp_path):
    """v_x rises by 0.2 m/s a ms: its mean over 1 to 3 ms is 0.4 m/s, and later samples are left
    out."""
    path = tmp_path / "a.csv"
    path.write_text("\n".join([HEAD, *LINES]))
    read = Curves.read(path, 1e-3)
    assert read.time[-1] == pytest.approx(3e-3)


@pytest.mark.parametrize(
    "old, new, words",
    [
        (HEAD, HEAD.replace("rate_y", "rate_q"), ["rate_y", "no such column", "rate_q"]),
        (HEAD, HEAD.replace("rate_y", "rate_x"), ["rate_x", "twice"]),
        (HEAD, HEAD.replace(" [deg/s]", "", 1), ["rate_x", "no unit"]),
        (HEAD, HEAD.replace("deg/s", "deg", 1), ["rate_x", "'deg'", "rad/s"]),
        (HEAD, HEAD.replace("deg/s", "1/s", 1), ["rate_x", "'1/s'", "rad/s"]),
        (HEAD, HEAD.replace("m/s", "furlong/blink", 1), ["velocity_x", "is no unit"]),
        ("1.0,0.2", "1.0,nan", ["velocity_x", "'nan' in line 4", "finite"]),
        ("1.0,0.2", "1.0,", ["velocity_x", "nothing in line 4"]),
        ("1.0,0.2", "1.0,inf", ["velocity_x", "'inf' in line 4"]),
        (
            "2.0,0.4,1,2,3",
            "2.0,0.4,1",
            ["rate_y: given nothing in line 6", "rate_z: given nothing in line 6"],
        ),
        ("2.0,0.4", "1.5,0.4", ["1.5 ms after 1.5 ms", "rise"]),
        ("2.0,0.4", "0.7,0.4", ["0.7 ms after 1.5 ms", "rise"]),
        ("4.0,0.8", "4.8,0.8", ["a gap from 3.5 ms to 4.8 ms", "steps of 1 ms"]),
        ("time [ms]", "time [s]", ["steps of 1 ms", "likely cause: values in ms with the unit s"]),
        ("0.0,0.0", "-0.2,0.0", ["-0.2 ms first", "since ignition"]),
        ("\n".join(["", *LINES[4:]]), "", ["a record of 1.5 ms", "2 ms"]),
        ("\n".join(["", *LINES[1:]]), "", ["1 samples"]),
        ("\n".join([HEAD, *LINES]), "", ["no line of numbers"]),
        (HEAD, HEAD + '\n"', ["a CSV file of text"]),
    ],
)
def test_every_fault_of_a_file_is_named(tmp_path, old, new, words):
    text = "\n".join([HEAD, *LINES])
    assert old in text
    path = tmp_path / "a.csv"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(SceneError) as caught:
        Curves.read(path)
    assert all(word in str(caught.value) for word in [*words, "a.csv"]), str(caught.value)


def test_faults_are_listed_at_once_and_a_window_must_lie_in_the_record(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(
        "\n".join(
            [
                "time [ms],velocity_x [kg],rate_x,rate_z [deg/s]",
                *(line[:-2] for line in LINES[:3]),
                "7,x,,3",
            ]
        )
    )
    with pytest.raises(SceneError) as caught:
        Curves.read(path, 6e-3)
    assert len(caught.value.faults) == 7  # rate_y; kg; x; no unit; nothing; gap; window
    with pytest.raises(SceneError, match="no such file|No such file"):
        Curves.read(tmp_path / "b.csv")
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(SceneError, match="file: given no line of numbers"):
        Curves.read(path)


def test_curves_that_end_under_thrust_or_outlast_the_scene_are_refused(tmp_path):
    read = files(tmp_path)
    early = {name: item._replace(window_start=0.02) for name, item in read.items()}
    with pytest.raises(
        calibration.CalibrationError, match="phi15 settles from 20 ms.*\n.*phi60 settles"
    ):
        calibration.run(scene(), early)
    with pytest.raises(
        calibration.CalibrationError,
        match="lasts .* ms, expected at most the scene's duration of 30 ms",
    ):
        calibration.run(scene().replace({"duration": "30 ms"}), {"phi60": read["phi60"]})


@pytest.fixture
def quick(monkeypatch):
    """A search of a few runs: the command is under test, not the fit."""
    monkeypatch.setattr(
        sys.modules["tipoff.calibration.run"],
        "Plan",
        lambda: SMALL._replace(points=2, evaluations=6, polish=1),
    )


def call(*arguments):
    return CliRunner().invoke(app, ["calibrate", *map(str, arguments)])


def test_command_fits_files_and_names_them(tmp_path, quick):
    runs = own_curves()
    one, two = (write_curves(tmp_path / f"{name}.csv", runs[name]) for name in CONDITIONS)
    asked = (
        "--reference",
        f"phi15={one}",
        "--reference",
        two,
        "--condition",
        "phi60",
        "--scene",
        "clamped",
        "--out",
        tmp_path / "out",
    )
    result = call(*asked)
    assert result.exit_code == 0, result.output
    found = Calibration.load(tmp_path / "out" / "clamped" / "curves" / "calibration.toml")
    assert (
        found.conditions == list(CONDITIONS)
        and "curves/calibration.toml" in result.stdout
        and "contact.force" in result.stdout
    )
    for path in (one, two):
        assert str(path) in found.provenance["references"]
        assert hashlib.sha256(path.read_bytes()).hexdigest() in found.provenance["references"]
    assert not (tmp_path / "out" / "clamped" / "calibration.toml").exists()
    assert "nothing changed" in call(*asked).stderr
    again = json.loads(
        call(
            *asked, "--json", "--settled-from", f"{1e3 * runs['phi15'].outcome.window_start} ms"
        ).stdout
    )
    assert again["constants"].keys() == found.constants.keys()


def test_a_table_of_another_program_has_the_same_fit(tmp_path, quick):
    """Semicolons, decimal commas, other names, no units, rates with the other sign. Control:
    without --columns the file is refused."""
    one = write_curves(tmp_path / "one.csv", lowfi.run(scene().replace(TRUTH), "springs"))
    rows = [line.split(",") for line in one.read_text().splitlines()[1:]]
    turned = [
        [*row[:4], row[4].removeprefix("-") if row[4][0] == "-" else f"-{row[4]}"] for row in rows
    ]
    text = "\n".join(";".join(row).replace(".", ",") for row in turned)
    two = tmp_path / "two.txt"
    two.write_text(f"made by hand\nT;VX;WX;WY;W3\n{text}\n")
    first = call("--reference", one, "--json", "--out", tmp_path / "a")
    names = "time=T, velocity_x=VX, rate_x=WX, rate_y=4, rate_z=-W3"
    stated = ("--columns", names, "--units", "time=ms, velocity_x=m/s, rate=deg/s")
    second = call("--reference", two, *stated, "--json", "--out", tmp_path / "b")
    assert second.exit_code == 0, second.output
    assert json.loads(first.stdout)["constants"] == json.loads(second.stdout)["constants"]
    refused = call("--reference", two, *stated[2:], "--out", tmp_path / "c")
    assert refused.exit_code == 2 and "time: given no such column" in refused.stderr
    idle = call(*stated, "--out", tmp_path / "c")
    assert idle.exit_code == 2 and "--columns" in idle.stderr and "--units" in idle.stderr


def test_a_file_without_a_name_is_the_scene_itself(tmp_path, quick):
    run = lowfi.run(scene().replace(TRUTH), "springs")
    path = write_curves(tmp_path / "a.csv", run)
    found = json.loads(call("--reference", path, "--json", "--out", tmp_path / "out").stdout)
    assert found["conditions"] == ["nominal"]


def test_command_lists_faults_of_all_files_and_options(tmp_path):
    bad = tmp_path / "bad.csv"
    bad.write_text("\n".join([HEAD, *LINES[:2]]))
    result = call(
        "--reference",
        f"phi15={bad}",
        "--reference",
        f"phi16={bad}",
        "--reference",
        f"phi60={tmp_path / 'none.csv'}",
        "--reference",
        f"phi15={bad}",
        "--out",
        tmp_path / "out",
    )
    assert result.exit_code == 2 and "Traceback" not in result.output
    assert all(
        word in result.stderr
        for word in ("a record of 0.5 ms", "phi16", "none.csv", "twice", "5 faults")
    )
    short = write_curves(tmp_path / "short.csv", own_curves()["phi60"], slice(0, 300))
    result = call("--reference", f"phi60={short}", "--out", tmp_path / "out")
    assert result.exit_code == 2 and "the record is too short" in result.stderr
    result = call("--settled-from", "38 ms", "--condition", "phi60", "--out", tmp_path / "out")
    assert (
        result.exit_code == 2
        and "--settled-from" in result.stderr
        and "--condition" in result.stderr
    )
    assert not (tmp_path / "out").exists()
