"""The error of the springs comes from a calibration of the present scene and code alone."""

from dataclasses import replace

from tests.studies.calibration.test_page import FIT
from tipoff.files import write_json
from tipoff.scenes import load
from tipoff.studies.limits import constants
from tipoff.workspace.settings import Settings
from tipoff.workspace.stage import Made
from tipoff.workspace.study import Study

RESIDUALS = {"phi15": {"settled_rate_error_deg_s": 0.5}}


def test_residuals_of_another_calibration_are_not_taken(tmp_path, monkeypatch):
    """Control: those of the present one are."""
    study = Study(load("reference"), tmp_path, Settings())
    write_json(study.path("calibration.json"), {"key": "another", "residuals": RESIDUALS})
    assert constants.margin(study, "springs").deg_s is None
    found = Made(replace(FIT, residuals=RESIDUALS), {})
    monkeypatch.setattr(constants.calibrate, "stored", lambda _: found)
    assert constants.margin(study, "springs").deg_s["x"] == 0.5
