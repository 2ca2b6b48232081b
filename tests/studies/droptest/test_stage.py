"""The stage on shipped logs: result, words, figures and the section of the page; simulated logs are called so everywhere."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from scenes import load
from scenes.calibration import Calibration
from scenes.faults import SceneError
from studies.cli import app
from studies.droptest import shipped
from studies.report import droptest as page
from studies.report.markup import Html
from studies.settings import Settings
from studies.stages import calibrate
from studies.stages import droptest as stage
from studies.study import Study, StudyError
from tests.studies.droptest.test_log import SHEET, TABLE

pytest.importorskip("zarr")


@pytest.fixture
def fitted(monkeypatch):
    """A calibration without constants in place of one that takes the reference minutes to make."""
    scene = load("reference")
    found = Calibration({}, [], [], [], [], [], [], np.empty((0, 0)), [], {}, [], 0.0,
                        {key: [value, value] for key, value in scene.loads.items()}, {"geometry_hash": scene.geometry_hash})
    monkeypatch.setattr(calibrate, "load", lambda study: found)


def call(*arguments):
    return CliRunner().invoke(app, ["droptest", *(str(argument) for argument in arguments)])


def test_shipped_logs_from_command_to_page(tmp_path, fitted):
    result = call("--cases", 200, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    for words in ("3 drop tests against 200 settled of 200 cases of the surrogate, calibrated", "SIMULATED",
                  "(SIMULATED log), CFC 60", "settling rule kept", "it is no validation",
                  "100.0 % with one three times too wide", "7 samples clipped"):
        assert words in result.stdout
    found = json.loads((tmp_path / "reference" / "droptest.json").read_text())
    assert found["simulated_logs"] and all(row["simulated"] and "SIMULATED" in row["description"] for row in found["tests"])
    assert all(f"{kind}{end}" in str(found["files"]) for kind in ("droptest-rates", "droptest-cloud") for end in (".png", ".svg"))
    for row in found["tests"]:
        parts = np.array(list(row["budget_deg_s"].values()))
        np.testing.assert_allclose(np.sqrt((parts**2).sum(axis=0)), row["standard_uncertainty_deg_s"], rtol=1e-12)
        assert all(1.0 / 201 <= p <= 1.0 for p in (*row["p"], row["p_distance"]))
    assert found["power"][2]["passes_one_axis"] == pytest.approx(200 * 199 / (203 * 202))
    again = call("--cases", 200, "--out", tmp_path, "--json")
    assert json.loads(again.stdout) == found and "nothing changed" in again.stderr
    study = Study(load("reference"), tmp_path / "reference", Settings(), ())
    assert stage.stored(study)["tests"] == found["tests"]
    assert stage.stored(Study(load("reference").replace({"payload.mass": "9 kg"}), tmp_path / "reference", Settings())) is None
    charts = []
    drawn = page.draw(found, lambda chart, words: charts.append(chart.name) or Html(words))
    assert charts == ["droptest-rates", "droptest-cloud"] and drawn.count("SIMULATED") == 1 and "no validation" in drawn


def test_bad_logs_are_listed_and_nothing_is_written(tmp_path):
    """Every fault of every log, before anything runs."""
    (tmp_path / "simulated0.csv").write_text(TABLE)
    for name, change in (("a", ("deg/s\"\nacceleration", "m\"\nacceleration")), ("b", ("44.4 ms", "44.4 kg"))):
        (tmp_path / f"{name}.toml").write_text(SHEET.replace(*change))
    good = shipped.sheets()[0]
    result = call(*(tmp_path / f"{name}.toml" for name in ("a", "b", "none")), good, good, "--out", tmp_path / "out")
    assert result.exit_code == 2 and not (tmp_path / "out").exists()
    assert "4 faults" in result.stderr and "Traceback" not in result.output
    assert all(words in result.stderr for words in ("a.toml: units.rate", "b.toml: windows.exit", "none.toml", "given twice"))


def population(rates, exits=0.0444):
    results = SimpleNamespace(rate=np.radians(rates), exit_time=np.where(np.isfinite(rates[:, 0]), exits, np.nan))
    return SimpleNamespace(results=results, settled=np.isfinite(rates[:, 0]), outside=np.zeros(len(rates), dtype=bool),
                           store="none", counts={"asked": len(rates), "ok": len(rates), "refused": 0, "failed": 0})


def test_cases_that_do_not_settle_are_left_out_and_counted_and_too_few_are_refused(tmp_path):
    study, drops = Study(load("reference"), tmp_path, Settings()), [stage.analyse(path) for path in shipped.sheets()[:1]]
    rates = np.random.default_rng(1).normal(0.0, 8.0, (100, 3))
    rates[:30] = np.nan
    found = stage.result(study, drops, population(rates))
    assert found["cases"]["settled"] == 70 and np.isfinite(found["cases"]["shown_deg_s"]).all()
    with pytest.raises(StudyError, match="only 10 of 40"):
        stage.result(study, drops, population(rates[:40]))


@pytest.mark.parametrize("width, p", [(8.0, "do not contradict"), (0.05, "contradict"), (2000.0, "contradict")])
def test_verdict_for_models_that_fit_that_are_too_narrow_and_too_wide(tmp_path, width, p):
    """Three tests of one size, in a cloud of about that size, one far too small and one far too large; in its range they are."""
    study, drops = Study(load("reference"), tmp_path, Settings()), [stage.analyse(path) for path in shipped.sheets()]
    rates = np.random.default_rng(2).normal(0.0, width, (400, 3))
    found = stage.result(study, drops, population(rates)) | {"surrogate": "calibrated"}
    line = next(line for line in stage.summary("reference", found) if "together" in line)
    assert f"the tests {p} the" in line
    assert found["together"]["inside_range"] is (width > 1.0)


def test_what_does_not_match_the_scene_is_said(tmp_path):
    study, drops = Study(load("tiny"), tmp_path, Settings()), [stage.analyse(shipped.sheets()[0])]
    found = stage.result(study, drops, population(np.random.default_rng(3).normal(0.0, 8.0, (100, 3)), exits=0.012))
    notes = " ".join(found["tests"][0]["notes"])
    assert "of the scene reference, the simulated cases of tiny" in notes and "the simulated cases after 12 to 12 ms" in notes


def test_a_sheet_alone_is_no_log(tmp_path):
    with pytest.raises(SceneError, match="valid TOML"):
        stage.analyse(shipped.sheets()[0].with_suffix(".csv"))
