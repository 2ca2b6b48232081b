"""The reduction of a launch finds exit, speed and rates of known runs inside its stated uncertainty, as often as it
states."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies.measured import launches
from tests.studies.shown import html
from tipoff import lowfi
from tipoff.faults import SceneError
from tipoff.scenes import load
from tipoff.scenes.calibration import Calibration
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.cli import app
from tipoff.studies.measured import page, stage
from tipoff.studies.measured.launch import analysis, ends
from tipoff.studies.measured.launch.quantities import SPEED, TIME, rate_name

COUNT = 200
PLAYS = (0.25e-3, 0.5e-3, 1e-3)  # m on each side
NAMES = (TIME, SPEED, *(rate_name(axis) for axis in "xyz"))


@pytest.fixture(scope="module")
def runs():
    """Scenes and runs with several plays and misalignments."""
    found = []
    for number, play in enumerate(PLAYS):
        change = {
            "contact.clearance": play,
            "initial.position.z": -play,
            "thrust_offset.misalignment.radial": f"{70 * number} deg",
            "mass_offset": {"eccentricity": {"axial": "2 mm", "radial": "90 deg"}},
        }
        scene = load("rocket_rail").replace(change)
        found.append((scene, lowfi.run(scene, "springs")))
    return found


def truth(run, rise):
    """The values of ``NAMES`` in a run."""
    start = run.time[np.flatnonzero(np.gradient(run.velocity[:, 0], run.time) > rise)[0]]
    return [
        run.outcome.exit_time - start,
        run.outcome.exit_velocity[0],
        *np.degrees(run.outcome.exit_rate),
    ]


def reduced(runs, seed, change=None, biased=False, interval=1e-3):
    """Errors of ``NAMES`` of one log over the expanded and the standard uncertainty."""
    scene, run = runs[seed % len(runs)]
    generator = np.random.default_rng([7, seed])
    errors = launches.drawn(generator)
    g = np.array([scene.gravity.x, scene.gravity.y, scene.gravity.z])
    log = launches.log(run, g, errors, seed, interval=interval)
    after = 0.06 if interval < 5e-3 else 0.1  # s, ten samples of a slow log
    off = launches.TRAVEL * generator.standard_normal() if change is None else change
    told = scene.replace({"rail.end": scene.rail.end + off})
    found = analysis.analyse(launches.sheet(after=after), log, told, "log")
    stated = [found.stated[name] for name in NAMES]
    values = np.array([one.value for one in stated])
    if biased:
        values[2:] += np.degrees(found.record.bias)
    away = values - truth(run, found.rise)
    return (
        away / [one.expanded for one in stated],
        away / [one.uncertainty for one in stated],
    )


@pytest.mark.parametrize("interval", [1e-3, 1e-2])
def test_the_true_values_are_in_the_stated_intervals_as_often_as_stated(runs, interval):
    """At least 90 % of 200 logs: of a share of 95 % fewer come by chance in one count of 500. The scatter is neither
    half the standard uncertainty nor much above it."""
    found = np.array([reduced(runs, seed, interval=interval) for seed in range(COUNT)])
    inside = (np.abs(found[:, 0]) <= 1.0).mean(axis=0)
    spread = np.sqrt((found[:, 1] ** 2).mean(axis=0))
    assert (inside >= 0.90).all()
    assert ((spread > 0.5) & (spread < 1.2)).all()
    # the instant of the start is not late by half an interval in the mean
    assert abs(found[:, 1, 0].mean()) < 0.5
    # Control: rates without the bias at rest removed
    wrong = np.array([reduced(runs, seed, biased=True, interval=interval)[0] for seed in range(40)])
    assert ((np.abs(wrong[:, 2:]) <= 1.0).mean(axis=0) < 0.5).all()
    # Control: a rail that is 5 cm longer in the scene, 20 cm for samples each 10 ms, in which it moves 15 cm
    longer = 0.05 if interval < 5e-3 else 0.2
    wrong = np.array(
        [reduced(runs, seed, change=longer, interval=interval)[0] for seed in range(40)]
    )
    assert ((np.abs(wrong[:, :2]) <= 1.0).mean(axis=0) < 0.5).all()


SHEET = """
description = "SIMULATED"
simulated = true
file = "flight.csv"
axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

[columns]
rate = ["gx", "gy", "gz"]
acceleration = ["ax", "ay", "az"]

[units]
time = "s"
rate = "deg/s"
acceleration = "m/s**2"

[gyro]
range = "2000 deg/s"
resolution = "0.01 deg/s"

[gyro.uncertainty]
bias_instability = "0.003 deg/s"
scale = 0.005
misalignment = "0.3 deg"
g_sensitivity = "0 deg/s/(m/s**2)"

[accelerometer]
range = "300 m/s**2"
scale_uncertainty = 0.005

[launch]
travel_uncertainty = "2 mm"
"""


def written(folder, runs, which=0, more="", errors=None, rows=lambda table: table):
    """A sheet with the CSV file of a log in ``folder``."""
    scene, run = runs[which]
    g = np.array([scene.gravity.x, scene.gravity.y, scene.gravity.z])
    log = launches.log(run, g, errors or launches.drawn(np.random.default_rng(3)), 3)
    (folder / "flight.csv").write_text(launches.text(rows(launches.table(log))))
    (folder / "flight.toml").write_text(SHEET + more)
    return folder / "flight.toml"


def refused(path, scene):
    with pytest.raises(SceneError) as error:
        stage.analysed([path], scene)
    return str(error.value)


def test_a_launch_from_command_to_page(runs, tmp_path, monkeypatch, figures):
    """The launch is inside the ranges of its own scene. Control: a rocket twice as heavy is too slow in every case."""
    found_ = Calibration({}, [], [], [], [], [], [], np.empty((0, 0)), [], {}, [], 0.0)
    monkeypatch.setattr(calibrate, "load", lambda study: found_)
    path, vary = written(tmp_path, runs), tmp_path / "errors.toml"
    vary.write_text(
        '[vary."contact.clearance"]\ndistribution = "uniform"\nlow = "0.1 mm"\nhigh = "1 mm"\n'
    )

    def result(out, *arguments):
        asked = [
            *("measured", path, "--scene", "rocket_rail", "--model", "springs", "--cases", 50),
            *("--vary", vary, "--out", tmp_path / out, *arguments),
        ]
        said = CliRunner(env={"COLUMNS": "200"}).invoke(app, [str(word) for word in asked])
        assert said.exit_code == 0, said.output
        return json.loads((tmp_path / out / "rocket_rail" / "measured.json").read_text()), said

    found, said = result("right")
    assert "SIMULATED" in said.stdout and "1 launch, 50 predicted ones" in said.stdout
    rows = {row["quantity"]: row for row in found["comparisons"]}
    assert rows["time at the end of the rail"]["inside"]
    assert rows["speed at the end of the rail"]["inside"] and len(rows) == 6 + 9
    (launch,) = found["launches"]
    assert launch["cases"] == 50 and launch["lost"] == 0 and not found["tests"]
    assert set(found["files"]) >= {
        "measured-thrust-1.csv",
        "measured_launches.csv",
        "measured_comparisons.csv",
    }
    text = html(page.draw(stage.STAGE.read(found)))
    assert text.count("<figure>measured-launches") == 1
    # the thrust of the log is that of the run, less friction and the axial part of gravity
    kept = np.loadtxt(
        tmp_path / "right/rocket_rail/measured-thrust-1.csv", delimiter=",", skiprows=1
    )
    scene, run = runs[0]
    during = (kept[:, 0] > 0.05) & (kept[:, 0] < launch["exit_s"] - 0.02)
    steady = np.gradient(run.velocity[:, 0], run.time) - scene.gravity.x
    expected = np.interp(kept[during, 0], run.time, steady) * scene.payload.mass
    np.testing.assert_allclose(kept[during, 1], expected, rtol=0.03)
    heavy, _ = result("wrong", "--set", "payload.mass=10 kg")
    rows = {row["quantity"]: row for row in heavy["comparisons"]}
    assert not rows["speed at the end of the rail"]["inside"]
    assert rows["speed at the end of the rail"]["share_below"] == 1.0


def test_exits_by_way_by_contact_and_from_the_sheet(runs):
    """On a rail that shakes the rocket to its end, contact ends where the way does. Control: guides that slide
    quietly at the end have no such noise, and a note tells that the way is longer."""
    scene, run = runs[1]
    shift, g = launches.REST, np.array([scene.gravity.x, scene.gravity.y, scene.gravity.z])

    def away(kind, seed, rough=2.0):
        errors = launches.drawn(np.random.default_rng(seed))._replace(latency=0.0)
        log = launches.log(run, g, errors, seed, rough)
        own = analysis.analyse(launches.sheet(exit=kind), log, scene, "log")
        left = own.start - shift + own.record.left
        return (left - run.outcome.exit_time) / own.record.half, own.notes

    for kind in ("way", "contact"):
        errors = np.array([away(kind, seed)[0] for seed in range(60)])
        assert (np.abs(errors) < 1.96).mean() > 0.88 and np.sqrt((errors**2).mean()) > 0.5
    found, notes = away((shift + 0.25, shift + 0.27), 1)
    assert abs(found) < 1.0 and "exit from the sheet" in notes
    early, notes = away("contact", 1, rough=0.0)
    assert early < -10.0 and any("guides may slide quietly" in note for note in notes)
    short = scene.replace({"rail.end": scene.rail.end - 0.3})
    log = launches.log(run, g, launches.drawn(np.random.default_rng(1)), 1, 2.0)
    notes = analysis.analyse(launches.sheet(), log, short, "log").notes
    assert any("is the rail longer?" in note for note in notes)


def test_a_quiet_rail_has_no_end_of_contact(runs):
    generator = np.random.default_rng(1)
    time = 1e-3 * np.arange(400)
    quiet = generator.standard_normal((400, 5))
    assert ends.by_contact(time, quiet, (0.1, 0.35)) is None
    louder = quiet * np.where(time < 0.25, 5.0, 1.0)[:, None]
    middle, spread = ends.by_contact(time, louder, (0.1, 0.35))
    assert abs(middle - 0.25) < 3.0 * spread < 0.02


def test_faults_of_a_launch_are_told(runs, tmp_path):
    scene = runs[0][0]
    assert "no rise of the force along +X" in refused(
        written(tmp_path, runs, rows=lambda table: table[:600]), scene
    )
    words = refused(written(tmp_path, runs, rows=lambda table: table[:900]), scene)
    assert "m of way in the whole log" in words and "the travel of the scene" in words
    assert "launch.after" in refused(written(tmp_path, runs, more='after = "2 ms"\n'), scene)
    scaled = lambda table: table * np.array([1, 1, 1, 1, 2, 2, 2])  # noqa: E731
    assert "9.807 m/s2 within 5 %" in refused(written(tmp_path, runs, rows=scaled), scene)
    path = written(tmp_path, runs)
    for old, new, expected in (
        ("scale_uncertainty = 0.005", "", "accelerometer.scale_uncertainty"),
        ('acceleration = ["ax", "ay", "az"]\n', "", "accelerations, whose integral"),
        ("[launch]", '[windows]\nexit = "20 ms"\n[launch]', "windows"),
    ):
        path.write_text(SHEET.replace(old, new, 1))
        assert expected in refused(path, scene)


def test_another_inclination_is_told(runs, tmp_path):
    scene = runs[0][0].replace({"gravity.x": "-5 m/s**2"})
    (found,) = stage.analysed([written(tmp_path, runs)], scene)[1]
    assert any("another inclination" in note for note in found.notes)


def test_missing_samples_are_refused(runs, tmp_path):
    """Eight samples are missing on the rail."""
    kept = lambda table: np.delete(table, np.arange(1000, 1008), axis=0)  # noqa: E731
    words = refused(written(tmp_path, runs, rows=kept), runs[0][0])
    assert "samples missing or clipped" in words
