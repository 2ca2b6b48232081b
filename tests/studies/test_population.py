"""Many cases on the surrogate of a study: the store, what is outside a calibration, and the quantities that are reported."""

from dataclasses import replace

import numpy as np
import pytest

import lowfi
from lowfi.numerics import Numerics
from lowfi.rows import Listed
from scenes import load
from scenes.calibration import Calibration
from studies.populations import answers, population, regime
from studies.populations.population import Surrogate
from studies.settings import Settings
from studies.study import Study

SCENE = load("reference")
FITTED = Calibration({}, [], [], [], [], [], [], np.zeros((0, 0)), [], {}, [], 0.0,
                     valid={name: [value, value] for name, value in SCENE.loads.items()},
                     provenance={"geometry_hash": SCENE.geometry_hash})
ROWS = [{"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.26e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.20e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 8.0, "thrust.peak": 6000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 7000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 6200.0}]


def columns_of(rows):
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}


def test_cases_outside_a_calibration_are_those_it_says_are():
    found = regime.outside(Surrogate(SCENE, FITTED, None), columns_of(ROWS), len(ROWS))
    assert found.tolist() == [bool(FITTED.outside(SCENE.replace(row))) for row in ROWS] == [False, False, True, True, True, False]


@pytest.mark.parametrize("model, expected", [(Surrogate(SCENE, None, None), False),
                                             (Surrogate(SCENE.replace({"thrust.peak": "9 kN"}), FITTED, None), True)])
def test_offsets_do_not_decide_what_is_outside(model, expected):
    offsets = {"thrust_offset.misalignment.radial": np.linspace(0.0, 6.0, 7)}
    assert regime.outside(model, offsets, 7).tolist() == [expected] * 7
    assert regime.outside(Surrogate(SCENE, FITTED, None), {"rail.thickness": np.array([4e-3])}, 1).all()


def test_calibration_without_ranges_judges_the_rail_alone():
    """Nothing is outside ranges that do not exist; rail and pads are known all the same."""
    endless = replace(FITTED, valid={})
    assert regime.outside(Surrogate(SCENE, endless, None), columns_of(ROWS), len(ROWS)).tolist() == [False] * len(ROWS)
    other = Surrogate(SCENE.replace({"rail.thickness": "3 mm", "rail.mount_width": "3 mm"}), endless, None)
    assert regime.outside(other, columns_of(ROWS), len(ROWS)).all()


def test_cases_are_kept_and_not_run_again(tmp_path, monkeypatch):
    study = Study(SCENE, tmp_path, Settings(workers=1))
    rows = ([{"thrust_offset.misalignment.radial": angle} for angle in (0.3, 0.6)]
            + [{"thrust_offset.misalignment.radial": float("nan")}])
    found = population.run(study, "trial", Surrogate(SCENE, None, None), Listed(rows))
    alone = lowfi.run(SCENE.replace(rows[1]), numerics=Numerics(relative_tolerance=population.TOLERANCE)).outcome
    assert found.counts == {"asked": 3, "ok": 2, "refused": 1, "failed": 0} and found.settled.tolist() == [True, True, False]
    values = {item.name: item.of(found.results)[1] for item in answers.ALL}
    assert [values[f"rate_{axis}_deg_s"] for axis in "xyz"] == np.degrees(alone.rate).tolist()
    assert (values["lateral_velocity_mm_s"] == 1e3 * alone.lateral_velocity
            and values["direction_error_deg"] == np.degrees(alone.direction_error))
    assert [values[f"attitude_{axis}_deg"] for axis in "xyz"] == np.degrees(alone.exit_attitude).tolist()
    monkeypatch.setattr("lowfi.fill.completed", lambda *_: pytest.fail("ran a stored case again"))
    again = population.run(study, "trial", Surrogate(SCENE, None, None), Listed(rows))
    assert np.array_equal(again.results.rate, found.results.rate, equal_nan=True) and (tmp_path / again.store).is_dir()
