"""How long a calibration takes, said beforehand: from costs that are made up, and never at the
price of a second."""

import json
import time
from dataclasses import replace

import h5py
import pytest

from tests.studies.calibration.test_page import FIT
from tipoff import scenes
from tipoff.calibration import parameters, refine, search
from tipoff.files import sealed, write_json
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.studies.calibration import forecast, page, stage
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study


def study(folder, **settings) -> Study:
    return Study(
        scenes.load("clamped"),
        folder / "clamped",
        replace(defaults("clamped"), workers=2, **settings),
    )


def asked(of: Study) -> list:
    return [of.highfi(name) for name in of.fitted()]


def stored(path, **cost):
    """A run's file as the forecast sees it."""
    with sealed(path) as temporary, h5py.File(temporary, "w") as file:
        file.attrs["cost"], file.attrs["numerics"] = (
            json.dumps(cost),
            json.dumps({"element_size": 0.002}),
        )


@pytest.mark.parametrize(
    "seconds, said",
    [
        (0.2, "1 s"),
        (7.4, "7 s"),
        (23.0, "25 s"),
        (96.0, "1 min 40 s"),
        (121.0, "2 min"),
        (1900.0, "32 min"),
        (9000.0, "2.5 h"),
    ],
)
def test_times_are_said_to_a_tenth(seconds, said):
    assert forecast.span(seconds) == said


def test_the_line_counts_waves_of_runs():
    """Five runs of 33 s, two at a time, are three waves."""
    after = forecast.work("the search", 20.0)
    assert forecast.words(5, 2, (99.0, ""), after).startswith(
        "5 reference runs to make, 2 at a time: about 1 min 40 s"
    )
    assert forecast.words(5, 2, (99.0, ""), after).endswith("; then the search, about 20 s")
    assert forecast.words(1, 1, (33.0, ""), after).startswith("1 reference run to make: about 35 s")
    assert forecast.words(0, 0, None, after) == "no reference run to make; the search, about 20 s"
    assert forecast.words(2, 2, None, forecast.work("the search", None)).endswith(
        "is stored; then the search"
    )


def test_time_follows_elements_steps_and_speed(tmp_path):
    """170,000 steps at 10 ns on the 19,360 elements of 2 mm take 32.9 s; 1 mm is eight times the
    elements, twice the steps."""
    of = study(tmp_path)
    stored(
        of.folder / "highfi" / "phi0-coarse.nc",
        ns_per_element_step=10.0,
        elements=19360,
        steps=170_000,
    )
    for name, seconds in (("first", 2.0), ("second", 0.01), ("second-compliant-1", 0.001)):
        stored(of.folder / "lowfi" / f"{name}.nc", wall_s=seconds)
    known = forecast.pace(of)
    assert known.ns == 10.0 and known.source == ""
    each, _ = forecast.reference_seconds(asked(of)[0], known)
    assert each == pytest.approx(1e-8 * 19360 * 170_000)
    finer, _ = forecast.reference_seconds(asked(study(tmp_path, element_size=0.001))[0], known)
    # a step of 10 ns for each of 19,360 elements; 5 ns of each are its own, eight times as many on half the size
    assert finer == pytest.approx(2.0 * 170_000 * 19360 * (5e-9 + 8.0 * 5e-9))
    coarse = known._replace(ns=30.0, element_size=0.004, elements=2420, steps=85_000)
    fine, _ = forecast.reference_seconds(asked(of)[0], coarse)
    assert fine == pytest.approx(170_000 * (2420 * 25e-9 + 19360 * 5e-9))  # not 8 * 30 ns
    line = forecast.calibration(of, asked(of))
    assert (
        "5 reference runs to make, 2 at a time: about 1 min 40 s" in line
        and "the search, about 35 s" in line
    )
    made = asked(of)[1]
    stored(of.store.path(made), ns_per_element_step=10.0, elements=19360, steps=170_000)
    assert "4 reference runs to make, 2 at a time: about 1 min 10 s" in forecast.calibration(
        of, asked(of)
    )


def test_a_calibration_on_curves_says_its_own(tmp_path):
    """10 ms a run: a search takes its evaluations of two conditions."""
    of = study(tmp_path)
    stored(of.folder / "lowfi" / "one.nc", wall_s=0.01)
    free = parameters.free(of.scene)
    assert (
        forecast.search(of, 2)
        == f"the search, about {forecast.span(0.02 * search.evaluations(len(free)))}"
    )


def test_a_fit_on_compliant_contact_counts_its_own_runs_and_parameters(tmp_path):
    """4 ms a run of this model, whatever springs take. Control: more parameters take longer."""
    of = study(tmp_path)
    for name, seconds in (("a-compliant-1", 0.004), ("b", 1.0)):
        stored(of.folder / "lowfi" / f"{name}.nc", wall_s=seconds)
    three = search.evaluations(3) + refine.evaluations(3)
    expected = f"the search, about {forecast.span(0.008 * three)}"
    assert forecast.search(of, 2, COMPLIANT) == expected
    named = ["contact.clearance", "friction.dynamic", "thrust.arm"]
    assert forecast.search(of, 2, COMPLIANT, named) == expected
    assert forecast.search(of, 2, COMPLIANT, ["all"]) != expected


def test_curves_are_fitted_after_the_time_was_said(tmp_path, capsys, monkeypatch):
    """Control: a second call fits nothing and says nothing of it."""
    monkeypatch.setattr(stage, "fit", lambda *asked: (FIT, []))
    path = tmp_path / "phi15.csv"
    lines = [f"{0.5 * n},{0.1 * n},1,2,3" for n in range(120)]
    path.write_text(
        "\n".join(
            ["time [ms],velocity_x [m/s],rate_x [deg/s],rate_y [deg/s],rate_z [deg/s]", *lines]
        )
    )
    stage.from_files(study(tmp_path), [("phi15", str(path))])
    assert "the search, about" in capsys.readouterr().err
    stage.from_files(study(tmp_path), [("phi15", str(path))])
    assert "the search" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "ends, said",
    [
        ([1.0, 3.0], "1 to 3"),
        ([1.99995e-4, 2.00005e-4], "0.000199995 to 0.000200005"),
        ([-2.004e-4, 2.2e-4], "-0.0002 to 0.0002"),
        ([None, None], "not determined by the curves"),
    ],
)
def test_a_narrow_interval_shows_its_width(ends, said):
    """Control: with four digits both ends would be 0.0002."""
    assert page.interval([end if end is None else float(end) for end in ends]) == said


def test_a_fit_of_other_parameters_is_another_result(tmp_path, monkeypatch):
    """From files and on the reference. Control: the same parameters again."""
    fitted = []
    monkeypatch.setattr(stage, "fit", lambda *asked: (fitted.append(asked[4]) or FIT, []))
    monkeypatch.setattr(stage, "require_success", lambda *asked: None)
    path, names = tmp_path / "phi15.csv", ("contact.clearance", "friction.dynamic")
    head = "time [ms],velocity_x [m/s],rate_x [deg/s],rate_y [deg/s],rate_z [deg/s]"
    path.write_text("\n".join([head, *(f"{0.5 * n},{0.1 * n},1,2,3" for n in range(120))]))
    of = study(tmp_path)
    monkeypatch.setattr(type(of.store), "fill", lambda *asked: [])
    for chosen in ([names[0]], [names[0]], list(names)):
        stage.from_files(of, [("phi15", str(path))], None, COMPLIANT, chosen)
        stage.on_reference(of, COMPLIANT, chosen)
    assert fitted == [[names[0]], [names[0]], list(names), list(names)]


def test_speed_comes_from_the_nearest_measurement(tmp_path):
    of = study(tmp_path)
    assert "typical" in forecast.pace(of).source
    write_json(
        tmp_path / "bench" / "highfi.json",
        {
            "rows": [
                {"element_size_m": 0.002, "ns_one_thread": 9.0},
                {"element_size_m": 0.0005, "ns_one_thread": 30.0},
            ]
        },
    )
    assert forecast.pace(of).ns == 9.0 and "benchmark" in forecast.pace(of).source
    stored(tmp_path / "other" / "highfi" / "a.nc", ns_per_element_step=20.0, elements=5, steps=7)
    assert (
        forecast.pace(of).ns == 20.0
        and forecast.pace(of).steps is None
        and "other" in forecast.pace(of).source
    )
    (of.folder / "highfi").mkdir(parents=True)
    (of.folder / "highfi" / "broken.nc").write_text("no file of this kind")
    assert forecast.pace(of).ns == 20.0


def test_a_slow_or_failing_look_delays_nothing(tmp_path, monkeypatch):
    """Control: without the limit the line would take as long as the look."""
    of = study(tmp_path)
    forecast.calibration(of, asked(of))  # what is loaded once does not count
    monkeypatch.setattr(forecast, "PATIENCE", 0.1)
    monkeypatch.setattr(forecast, "pace", lambda study: time.sleep(1.5))
    began = time.monotonic()
    assert "duration unknown" in forecast.calibration(of, asked(of))
    assert time.monotonic() - began < 1.0
    monkeypatch.setattr(forecast, "pace", lambda study: 1 / 0)
    assert "duration unknown" in forecast.calibration(of, asked(of))
