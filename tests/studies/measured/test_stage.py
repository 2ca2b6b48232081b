"""The stage on shipped logs: result, tables, figures and the section of the page; simulated logs are
marked everywhere."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies.measured.test_log import SHEET, TABLE
from tests.studies.shown import html
from tests.studies.synthetic import undrawn
from tipoff.faults import SceneError
from tipoff.scenes import load
from tipoff.scenes.calibration import Calibration
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.cli import app
from tipoff.studies.measured import analysis, page, stage
from tipoff.studies.measured.sheet import SAMPLES
from tipoff.studies.populations import answers
from tipoff.studies.render import document
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, StudyError

xarray = pytest.importorskip("xarray")


@pytest.fixture
def fitted(monkeypatch):
    """A calibration without constants in place of one that takes the reference minutes to make."""
    found = Calibration({}, [], [], [], [], [], [], np.empty((0, 0)), [], {}, [], 0.0)
    monkeypatch.setattr(calibrate, "load", lambda study: found)


def call(*arguments):
    return CliRunner(env={"COLUMNS": "400"}).invoke(
        app, ["measured", "--model", "springs", *map(str, arguments)]
    )


def test_shipped_logs_from_command_to_page(tmp_path, fitted, figures):
    result = call("--cases", 200, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert "model springs, calibrated; agreement: " in result.stdout
    found = json.loads((tmp_path / "reference" / "measured.json").read_text())
    assert found["simulated_logs"] and all(
        row["simulated"] and "SIMULATED" in row["description"] for row in found["tests"]
    )
    assert all(
        f"{kind}{end}" in str(found["files"])
        for kind in ("measured-rates", "measured-cloud")
        for end in (".png", ".svg")
    )
    for row in found["tests"]:
        parts = np.array(list(row["budget_deg_s"].values()))
        np.testing.assert_allclose(
            np.sqrt((parts**2).sum(axis=0)), row["standard_uncertainty_deg_s"], rtol=1e-12
        )
        assert all(1.0 / 201 <= p <= 1.0 for p in (*row["p"], row["p_distance"]))
    assert found["power"][2]["passes_one_axis"] == pytest.approx(200 * 199 / (203 * 202))
    data = tmp_path / "reference" / found["data"]
    assert (
        found["data"] == "measured.nc"
        and "measured.nc" in found["files"]
        and str(data) in result.stdout
    )
    # what a kill in the middle of writing would leave
    assert not list(data.parent.glob(".measured.nc*"))
    for row, path in zip(found["tests"], SAMPLES):
        _require_signals(data, row, analysis.analyse(path))
    again = call("--cases", 200, "--out", tmp_path, "--json")
    assert json.loads(again.stdout) == found and "nothing changed" in again.stderr
    study = Study(load("reference"), tmp_path / "reference", Settings(), ())
    assert stage.STAGE.stored(study).document["tests"] == found["tests"]
    assert (
        stage.STAGE.stored(
            Study(
                load("reference").replace({"payload.mass": "9 kg"}),
                tmp_path / "reference",
                Settings(),
            )
        )
        is None
    )
    assert html(page.draw(stage.STAGE.read(found))).count("<figure>measured-") == 2
    assert set(found["cases"]["quantiles"]) == {item.name for item in answers.ALL}


def _require_signals(data, row, drop):
    """The group of a test holds every sample, and the change of rate can be had from it again; of
    the curve in the result, thinned, every point is one of these. Control: it has no more than half
    of them."""
    with xarray.open_dataset(
        data, group=row["test"], engine="h5netcdf", decode_timedelta=False
    ) as kept:
        assert kept.sizes["time"] == drop.samples.time.size > 2 * len(row["curve"]["time_s"])
        np.testing.assert_array_equal(kept.rate_unfiltered, drop.samples.rate)
        np.testing.assert_array_equal(kept.specific_force_unfiltered, drop.samples.force)
        assert (
            kept.rate.units,
            kept.specific_force.units,
            kept.time.units,
            kept.temperature.units,
        ) == ("rad/s", "m/s2", "s", "K")
        at = np.searchsorted(kept.time, np.array(row["curve"]["time_s"]) + row["ignition_s"] - 1e-5)
        np.testing.assert_allclose(np.degrees(kept.rate[at]), row["curve"]["rate_deg_s"], atol=6e-5)
        calm = kept.windows.sel(window="reference").values
        before = kept.rate_unfiltered[(kept.time >= calm[0]) & (kept.time <= calm[1])].mean("time")
        np.testing.assert_allclose(np.degrees(before), row["before_deg_s"], rtol=1e-9)
        np.testing.assert_allclose(np.degrees(kept.change), row["change_deg_s"])
        assert (
            kept.doubtful.sum() == 7
            and kept.attrs["simulated"] == 1
            and kept.attrs["ignition_s"] == row["ignition_s"]
        )


def _tests_in(folder, *names):
    """Sheets that name one table, in folders of their own."""
    paths = [folder / name / "log.toml" for name in names]
    for path in paths:
        path.parent.mkdir()
        path.write_text(SHEET)
        (path.parent / "simulated0.csv").write_text(TABLE)
    return paths


def test_a_result_is_current_as_long_as_its_logs_are(tmp_path, fitted, monkeypatch):
    """An edited table, a sheet that moved, a file that is gone: no longer. Control: the files as
    they were, read in this order between all changes, are current again."""
    undrawn(monkeypatch)
    monday, tuesday = _tests_in(tmp_path, "monday", "tuesday")
    study = Study(load("reference"), tmp_path / "reference", Settings())
    made = stage.run(study, stage.MeasuredOptions((monday, tuesday), cases=60, model="springs"))
    found = made.document
    assert [row["test"] for row in found["tests"]] == ["monday/log", "tuesday/log"]
    for row, path in zip(found["tests"], (monday, tuesday)):  # groups of groups
        _require_signals(study.path(found["data"]), row, analysis.analyse(path))
    table, moved = tuesday.with_name("simulated0.csv"), tuesday.with_name("other.toml")
    assert stage.STAGE.stored(study) == made
    table.write_text(TABLE.replace("0.100,", "0.1001,"))
    assert stage.STAGE.stored(study) is None
    table.unlink()
    assert stage.STAGE.stored(study) is None
    table.write_text(TABLE)
    assert stage.STAGE.stored(study) == made
    tuesday.rename(moved)
    assert stage.STAGE.stored(study) is None
    renamed = stage.run(study, stage.MeasuredOptions((monday, moved), cases=60, model="springs"))
    assert [row.test for row in renamed.result.tests] == ["log", "other"]
    assert renamed.key != made.key
    assert stage.STAGE.stored(study) == renamed


def test_tests_are_judged_by_the_errors_condition_and_seed_that_are_asked_for(
    tmp_path, fitted, monkeypatch
):
    """Each changes the cases, and an edited file of errors makes a result old. Control: as the file
    was it is current again."""
    undrawn(monkeypatch)
    errors = tmp_path / "errors.toml"
    lines = (
        'cases = 9\nseed = 4\n[vary."thrust_offset.misalignment.axial"]\ndistribution = "uniform"\n'
        'low = "-{0} deg"\nhigh = "{0} deg"\n'
    )
    errors.write_text(lines.format("0.001"))
    reseeded = tmp_path / "reseeded.toml"
    reseeded.write_text(errors.read_text().replace("seed = 4", "seed = 5"))
    asked = ("--cases", 60, "--out", tmp_path, "--json", SAMPLES[0])
    paper, narrow, seeded, other = (
        json.loads(call(*asked, *more).stdout)
        for more in (
            (),
            ("--vary", errors),
            ("--vary", reseeded),
            ("--vary", errors, "--condition", "phi60"),
        )
    )
    assert len({found["key"] for found in (paper, narrow, seeded, other)}) == 4
    assert len({found["cases"]["store"] for found in (paper, narrow, seeded, other)}) == 4
    wide, close, moved = (
        np.array(found["cases"]["shown_deg_s"]) for found in (paper, narrow, other)
    )
    assert np.ptp(close, axis=0).max() < 0.1 * np.ptp(wide, axis=0).max()
    # the condition turns the errors about X
    assert np.ptp(close[:, 1]) < 1e-3 < 0.05 < np.ptp(moved[:, 1])
    assert narrow["varied"]["seed"] == 4 and seeded["varied"]["seed"] == 5
    assert narrow["request"]["vary"] == str(errors) and other["request"]["condition"] == "phi60"
    shown = document.terminal(page.draw(stage.STAGE.read(other)))
    assert f"of condition phi60; errors of {errors} (" in shown and "), seed 4" in shown
    study = Study(load("reference"), tmp_path / "reference", Settings())
    assert stage.STAGE.stored(study).document == other
    errors.write_text(lines.format("0.1"))
    assert stage.STAGE.stored(study) is None
    errors.write_text(lines.format("0.001"))
    assert stage.STAGE.stored(study).document == other


def test_bad_errors_are_listed_beside_bad_logs(tmp_path):
    result = call(tmp_path / "none.toml", "--vary", "nothing", "--out", tmp_path / "out")
    assert (
        result.exit_code == 2
        and "none.toml" in result.stderr
        and "an unknown name" in result.stderr
    )
    assert not (tmp_path / "out").exists()


def test_names_tell_folders_apart():
    places = [
        Path("/a/x/log.toml"),
        Path("/b/x/log.toml"),
        Path("/b/y/log.toml"),
        Path("/b/y/other.toml"),
    ]
    assert stage.short_names(places) == ["a/x/log", "b/x/log", "y/log", "other"]


def test_a_log_under_two_spellings_is_one(tmp_path):
    (path,) = _tests_in(tmp_path, "monday")
    with pytest.raises(SceneError, match="twice"):
        stage.analysed([path, tmp_path / "monday" / ".." / "monday" / "log.toml"], load("tiny"))


def test_bad_logs_are_listed_and_nothing_is_written(tmp_path):
    """Every fault of every log, before anything runs."""
    (tmp_path / "simulated0.csv").write_text(TABLE)
    for name, change in (
        ("a", ('deg/s"\nacceleration', 'm"\nacceleration')),
        ("b", ("44.4 ms", "44.4 kg")),
    ):
        (tmp_path / f"{name}.toml").write_text(SHEET.replace(*change))
    good = SAMPLES[0]
    result = call(
        *(tmp_path / f"{name}.toml" for name in ("a", "b", "none")),
        good,
        good,
        "--out",
        tmp_path / "out",
    )
    assert result.exit_code == 2 and not (tmp_path / "out").exists()
    assert "4 faults" in result.stderr and "Traceback" not in result.output
    assert all(
        words in result.stderr
        for words in ("a.toml: units.rate", "b.toml: windows.exit", "none.toml", "given twice")
    )


def population(rates, exits=0.0444):
    many, values = len(rates), np.where(np.isfinite(rates[:, 0]), np.arange(len(rates)), np.nan)
    results = SimpleNamespace(
        rate=np.radians(rates),
        exit_time=np.where(np.isfinite(rates[:, 0]), exits, np.nan),
        impulse_after_exit=np.where(np.isfinite(rates[:, 0]), 0.0, np.nan),
        lateral_velocity=1e-3 * values,
        direction_error=np.radians(values),
        exit_attitude=np.radians(values)[:, None] * np.ones((many, 3)),
    )
    return SimpleNamespace(
        results=results,
        settled=np.isfinite(rates[:, 0]),
        store="none",
        counts={"asked": len(rates), "ok": len(rates), "refused": 0, "failed": 0},
    )


def test_cases_that_do_not_settle_are_left_out_and_counted_and_too_few_are_refused(tmp_path):
    study, drops = (
        Study(load("reference"), tmp_path, Settings()),
        [analysis.analyse(path) for path in SAMPLES[:1]],
    )
    rates = np.random.default_rng(1).normal(0.0, 8.0, (100, 3))
    rates[:30] = np.nan
    found = stage.result(study, drops, population(rates))
    assert found.cases.settled == 70 and np.isfinite(found.cases.shown_deg_s).all()
    # 30 to 99 settled
    for name in ("lateral_velocity_mm_s", "direction_error_deg", "attitude_z_deg"):
        middle = next(row for row in found.cases.quantiles[name] if row.share == 0.5)
        assert middle.value == pytest.approx(64.5) and middle.low < 64.5 < middle.high
    dependent = stage.result(study, drops, population(rates), independent=False).cases.quantiles
    assert {(row.low, row.high) for rows in dependent.values() for row in rows} == {(None, None)}
    with pytest.raises(StudyError, match="only 10 of 40"):
        stage.result(study, drops, population(rates[:40]))


@pytest.mark.parametrize(
    "width, p", [(8.0, "do not contradict"), (0.05, "contradict"), (2000.0, "contradict")]
)
def test_verdict_for_models_that_fit_that_are_too_narrow_and_too_wide(tmp_path, width, p):
    """Three tests of one size, in a cloud of about that size, one far too small and one far too
    large; in its range they are."""
    study, drops = (
        Study(load("reference"), tmp_path, Settings()),
        [analysis.analyse(path) for path in SAMPLES],
    )
    rates = np.random.default_rng(2).normal(0.0, width, (400, 3))
    found = stage.result(study, drops, population(rates))
    table = next(
        part for part in page.table_of_comparison(found) if part.heads[0] == "all tests together"
    )
    assert f"The tests {p} the" in table.notes[0]
    both = found.together
    assert [row[1] for row in table.rows] == [both.p_distance, both.p_spread, both.p]
    assert both.inside_range is (width > 1.0)


def test_what_does_not_match_the_scene_is_said(tmp_path):
    study, drops = Study(load("tiny"), tmp_path, Settings()), [analysis.analyse(SAMPLES[0])]
    found = stage.result(
        study, drops, population(np.random.default_rng(3).normal(0.0, 8.0, (100, 3)), exits=0.012)
    )
    notes = " ".join(found.tests[0].notes)
    assert (
        "scene reference, the simulated cases to tiny" in notes
        and "simulated cases after 12 ms to 12 ms" in notes
    )


def test_a_sheet_alone_is_no_log(tmp_path):
    with pytest.raises(SceneError, match="valid TOML"):
        analysis.analyse(SAMPLES[0].with_suffix(".csv"))
