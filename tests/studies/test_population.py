"""Many cases on the surrogate of a study: the store, what is outside a calibration, and the quantities that are reported."""

from dataclasses import replace

import numpy as np
import pytest

import lowfi
from lowfi.numerics import Numerics
from lowfi.rows import Listed, numbers
from scenes import load, moments, validity
from scenes.calibration import Calibration
from scenes.effects import thrust_offset
from studies.populations import answers, population, regime
from studies.populations.population import Surrogate
from studies.settings import Settings
from studies.study import Study
from studies.sweeps import factors

SCENE = load("reference")
FITTED = Calibration({}, [], [], [], [], [], [], np.zeros((0, 0)), [], {}, [], 0.0,
                     valid=validity.ranges([SCENE.loads]),
                     provenance={"geometry_hash": SCENE.geometry_hash})
FITTED_HERE = Surrogate(SCENE, FITTED, None)
ROWS = [{"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.26e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.20e-3, "payload.mass": 9.9, "thrust.peak": 6000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 8.0, "thrust.peak": 6000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 7000.0},
        {"contact.clearance": 0.25e-3, "payload.mass": 9.9, "thrust.peak": 6200.0}]


def columns_of(rows):
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}


def test_cases_outside_a_calibration_are_those_it_says_are():
    found = regime.outside(FITTED_HERE, columns_of(ROWS), len(ROWS))
    assert found.tolist() == [bool(FITTED.outside(SCENE.replace(row))) for row in ROWS] == [False, False, True, True, True, False]


@pytest.mark.parametrize("model, expected", [(Surrogate(SCENE, None, None), False),
                                             (Surrogate(SCENE.replace({"thrust.peak": "9 kN"}), FITTED, None), True)])
def test_the_angle_of_an_error_does_not_decide_what_is_outside(model, expected):
    offsets = {"thrust_offset.misalignment.radial": np.linspace(0.0, 6.0, 7)}
    assert regime.outside(model, offsets, 7).tolist() == [expected] * 7
    assert regime.outside(FITTED_HERE, {"rail.thickness": np.array([4e-3])}, 1).all()


def test_an_error_larger_than_those_of_the_fit_is_outside():
    """The sweep of one error at a time, whose 0.1 deg at an arm of 0.1 m are 0.17 mm of eccentricity. Control: the ranges of
    thrust and clearance tell none of the cases apart."""
    alone = Surrogate(factors.alone(SCENE), FITTED, None)
    cases = factors.cases(factors.angles(8))
    inputs = dict(zip(cases.keys, numbers(cases.keys, cases.rows(0, 240)).T))
    found = regime.outside(alone, inputs, 240).reshape(3, len(factors.SIZES), 8)
    limit = 1.0 + validity.MARGIN
    largest = limit * 0.1, *[limit * 100.0 * np.sin(np.radians(0.1))] * 2  # deg, mm, mm
    assert found.tolist() == [[[size > most] * 8 for size in factors.SIZES] for most in largest]
    of_thrust = {key: span for key, span in FITTED.valid.items() if key != "moment_impulse_nms"}
    assert not regime.outside(alone._replace(calibration=replace(FITTED, valid=of_thrust)), inputs, 240).any()
    at_once = regime.outside(alone, {"thrust_offset.misalignment.axial": np.linspace(0.0, 0.02, 10**6)}, 10**6)
    assert at_once.sum() == pytest.approx(10**6 * (1.0 - limit * np.radians(0.1) / 0.02), rel=1e-4)


def test_a_nan_stands_for_the_scene_s_own_number():
    """Lists of cases with different keys have it where a case does not change a number."""
    nothing, other = np.array([np.nan, np.nan]), np.array([np.nan, 9e9])
    for key in ("contact.clearance", "payload.mass", "thrust.peak", "thrust_offset.misalignment.axial"):
        assert not regime.outside(FITTED_HERE, {key: nothing}, 2).any()
        assert regime.outside(FITTED_HERE, {key: other if "axial" not in key else np.array([np.nan, 0.1])}, 2).tolist() == [
            False, True]


def test_moment_impulses_of_many_cases_are_those_of_their_scenes():
    random = np.random.default_rng(1)
    inputs = {f"{table}.{name}": random.uniform(0.0, most, 20)
              for table, size in (("thrust_offset.misalignment", 0.1), ("thrust_offset.eccentricity", 1e-3),
                                  ("mass_offset.eccentricity", 1e-3)) for name, most in (("axial", size), ("radial", 6.0))}
    inputs |= {"thrust.arm": random.uniform(0.05, 0.2, 20), "thrust.peak": random.uniform(1e3, 9e3, 20)}
    expected = []
    for values in zip(*inputs.values()):
        scene = SCENE.replace(dict(zip(inputs, map(float, values))))
        record = thrust_offset.record(scene.thrust_offset, scene.mass_offset, scene.thrust.arm)
        expected.append(scene.loads["thrust_impulse_ns"] * np.cross(record.arm, record.direction))
    impulse = SCENE.loads["thrust_impulse_ns"] * inputs["thrust.peak"] / SCENE.thrust.peak
    assert moments.moment_impulses(SCENE, inputs, impulse) == pytest.approx(np.array(expected), rel=1e-12, abs=1e-14)
    assert moments.transverse(SCENE, inputs, impulse) == pytest.approx(np.linalg.norm(np.array(expected)[:, 1:], axis=1), rel=1e-12)


def test_calibration_without_ranges_judges_the_rail_alone():
    """Nothing is outside ranges that do not exist; rail and pads are known all the same."""
    endless = replace(FITTED, valid={})
    assert regime.outside(Surrogate(SCENE, endless, None), columns_of(ROWS), len(ROWS)).tolist() == [False] * len(ROWS)
    other = Surrogate(SCENE.replace({"rail.thickness": "3 mm", "rail.mount_width": "3 mm"}), endless, None)
    assert regime.outside(other, columns_of(ROWS), len(ROWS)).all()


@pytest.mark.parametrize("walls", [False, True])
def test_rails_swing_on_walls_alone(tmp_path, monkeypatch, walls):
    """A law of contact knows no modes, so that a scene with them would be refused on springs, case by case."""
    monkeypatch.setattr(population.calibrate, "load", lambda _: FITTED)
    monkeypatch.setattr(population.wall_stage, "load", lambda *_: "walls")
    study = Study(SCENE.replace({"flexibility": {"modes": 2}}), tmp_path, Settings())
    model = population.surrogate(study, walls)
    assert (model.scene.flexibility is not None) == walls and (model.walls == "walls") == walls
    assert population.surrogate(Study(SCENE, tmp_path, Settings())).scene.hash == SCENE.hash


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
