"""``tipoff flight``: what it writes, what it takes from options, what it refuses, and its section
of the page."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies.shown import html
from tests.studies.synthetic import undrawn
from tipoff.files import write_json
from tipoff.scenes import load
from tipoff.studies.cli import app
from tipoff.studies.flight import page as section
from tipoff.studies.flight import stage as flight
from tipoff.studies.flight import summary
from tipoff.studies.flight.results import Condition
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.render.table import Noted
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

xarray = pytest.importorskip("xarray")


@pytest.fixture
def uncalibrated(monkeypatch):
    """The surrogate with the constants of the scene, which no reference has to be run for."""

    def surrogate(study, model=None, condition=None):
        return Surrogate(study.condition(condition) if condition else study.scene, None, None)

    monkeypatch.setattr(population, "surrogate", surrogate)


def call(*arguments):
    return CliRunner(env={"COLUMNS": "400"}).invoke(app, ["flight", *map(str, arguments)])


def test_conditions_and_cases_are_flown_and_kept(tmp_path, uncalibrated, figures, monkeypatch):
    asked = ("--condition", "phi35", "--condition", "phi60", "--cases", 60, "--out", tmp_path)
    first = call(*asked)
    assert first.exit_code == 0, first.output
    assert "flight.nc" in first.stdout
    folder = tmp_path / "reference"
    found = json.loads((folder / "flight.json").read_text())
    assert [item["condition"] for item in found["conditions"]] == ["phi35", "phi60"]
    assert [item["condition"] for item in found["curves"]] == ["phi35", "phi60"]
    row, curve = found["conditions"][0]["flown"], found["curves"][0]
    assert row["miss_m"] == pytest.approx(np.hypot(row["miss_y_m"], row["miss_z_m"]))
    assert row["miss_m"] > 10.0 * row["tip_off_miss_m"] > 0.0  # the orbit bends the way of all
    assert curve["pointing_deg"][-1] == pytest.approx(row["pointing_deg"], rel=1e-5)
    assert curve["to_target_m"][-1] == pytest.approx(
        [100.0, row["miss_y_m"], row["miss_z_m"]], rel=1e-4
    )
    assert min(curve["clearance_m"]) == pytest.approx(1e-3 * row["clearance_mm"], abs=1e-5)
    median = found["cases"]["quantiles"]["miss_m"][summary.SHARES.index(0.5)]
    assert median["low"] < median["value"] < median["high"]
    assert found["cases"]["touch"]["of"] == 60 and found["cases"]["not_reached"]["count"] == 0
    with xarray.open_dataset(folder / found["data"], engine="h5netcdf") as data:
        assert data.miss_m.shape == (60,) and data.condition.values.tolist() == ["phi35", "phi60"]
        assert np.median(data.miss_m) == pytest.approx(median["value"], rel=0.02)
        assert float(data.condition_miss_m[0]) == pytest.approx(row["miss_m"])
    assert sorted(path.name for path in (folder / "figures").glob("flight-*.svg")) == [
        "flight-axis.svg",
        "flight-clearance.svg",
        "flight-miss.svg",
        "flight-path.svg",
    ]

    with xarray.open_dataset(folder / found["data"], engine="h5netcdf") as data:
        # what the payload left its rail with stands beside its flight, by the same name everywhere
        for item in answers.ALL:
            kept = data[item.name].values
            assert np.median(kept) == pytest.approx(
                found["cases"]["quantiles"][item.name][summary.SHARES.index(0.5)]["value"],
                abs=0.1 * np.ptp(kept),
            )
            assert float(data[f"condition_{item.name}"][0]) == row[item.name]
    assert row["rate_deg_s"] == pytest.approx(
        np.linalg.norm([row[f"rate_{axis}_deg_s"] for axis in "xyz"])
    )
    assert (
        row["rate_deg_s"] > 0.1
        and row["lateral_velocity_mm_s"] > 0.1
        and row["direction_error_deg"] > 0.0
    )

    stamp = (folder / "flight.json").stat().st_mtime_ns
    # nothing changed
    assert call(*asked).exit_code == 0 and (folder / "flight.json").stat().st_mtime_ns == stamp
    undrawn(monkeypatch)  # laid out once is enough
    further = json.loads(call(*asked, "--set", "flight.range=1 km", "--json").stdout)
    assert (
        further["flight"]["range_m"] == 1000.0
        and further["conditions"][0]["flown"]["miss_m"] > 50.0 * row["miss_m"]
    )
    # another flight of the same ejections
    assert further["cases"]["store"] == found["cases"]["store"]

    study = Study(
        load("reference").replace({"flight.range": "1 km"}), folder, Settings(), ("phi35", "phi60")
    )
    assert flight.STAGE.stored(study).key == further["key"]
    assert (
        flight.STAGE.stored(Study(load("reference"), folder, Settings(), ("phi35", "phi60")))
        is None
    )
    assert (
        flight.STAGE.stored(Study(load("reference").replace({"flight": None}), folder, Settings()))
        is None
    )
    write_json(
        folder / "flight.json", further | {"asked": further["asked"] | {"vary": "gone.toml"}}
    )
    assert flight.STAGE.stored(study) is None
    drawn = html(section.draw(flight.STAGE.read(found)))
    assert "<figure>flight-miss</figure>" in drawn and "0 of 60 touch" in drawn


def test_without_an_exit_there_is_no_flight(tmp_path, uncalibrated):
    result = call(
        "--condition", "phi35", "--cases", 4, "--set", "duration=20 ms", "--out", tmp_path
    )
    assert result.exit_code == 2 and "duration" in result.stderr
    assert not (tmp_path / "reference" / "flight.json").exists()


def test_limitations_are_remarked():
    def remarks(scene, limit_open):
        return section.remarks(summary.orbit(load(scene)), limit_open)

    assert any("flight.envelope" in line for line in remarks("channel", 0))
    (line,) = remarks("reference", 3)
    assert line.startswith("3 cases")
    assert remarks("reference", 0) == []


def test_a_condition_without_a_flight_shows_its_status():
    table = section.table_of_conditions([Condition("phi0", "jammed", None)], ["miss_m"], [])
    assert table.rows == [(Noted("phi0", "jammed"), None)]


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--set", "flight=absent"], '--set flight.altitude="500 km" --set flight.range="100 m"'),
        (["--set", "flight.range=-5 m"], "flight.range"),
        (["--set", "flight.range=5 kg"], "flight.range"),
        (["--set", "flight.altitude=absent"], "one of altitude and mean_motion"),
        (["--set", "flight.mean_motion=1e-3 rad/s"], "one of altitude and mean_motion"),
        (["--set", "gravity.z=-9.81 m/s**2"], "fall freely"),
        (
            ["--set", "flight.envelope.0.high.0=-2 m"],
            "a corner whose coordinates are at least those of low",
        ),
        (["--vary", "nothing"], "paper"),
    ],
)
def test_bad_input_is_refused_and_nothing_written(tmp_path, arguments, words):
    result = call("--out", tmp_path / "out", *arguments)
    assert result.exit_code == 2, result.output
    assert words in result.stderr and "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


def test_the_flight_itself_does_not_vary(tmp_path):
    errors = tmp_path / "errors.toml"
    errors.write_text(
        'cases = 8\n[vary."flight.azimuth"]\ndistribution = "uniform"\nlow = "0 deg"\nhigh = "1 '
        'deg"\n'
    )
    result = call("--out", tmp_path / "out", "--vary", errors)
    assert (
        result.exit_code == 2
        and "vary.flight.azimuth" in result.stderr
        and not (tmp_path / "out").exists()
    )
