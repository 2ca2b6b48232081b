"""O41 and the other kinds of thrust: impulse, cut, fit, and the compiled law against numpy."""

import json
import math

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.exact.thrust import gaussian_peak, kept_by_cut
from tests.scenes.support import small
from tipoff.mechanics.laws import thrust
from tipoff.mechanics.laws.thrust import Pulses, Thrust
from tipoff.scenes import SceneError, load, parse
from tipoff.scenes.effects.measured import MeasuredCurve, fit_gaussian

DURATION = 0.05
O41 = {"kind": "gaussian", "impulse": "100 N*s", "width": "4 ms", "centre": "20 ms"}


def table(**keys):
    return parse(small(thrust=keys), bare_numbers_are_si=True).thrust


@pytest.mark.case("O41")
def test_peak_from_impulse():
    record = table(**O41).record()
    assert record.pulses.peaks[0] == pytest.approx(9973.557, rel=1e-6)
    assert record.pulses.peaks[0] == pytest.approx(gaussian_peak(100.0, 4e-3), rel=1e-14)


@pytest.mark.case("O41")
@pytest.mark.parametrize(
    "rescale, speed, words", [(False, 4.986501, "not rescaled"), (True, 5.0, "rescaled")]
)
def test_cut_at_three_sigma(rescale, speed, words):
    """A point mass of 20 kg, stepped through the compiled law, has the speed the description
    promises."""
    cut = table(**O41, cutoff=3.0, rescale=rescale)
    said = cut.describe(DURATION)
    time = np.linspace(8e-3, 32e-3, 24001)
    stepped = np.trapezoid(thrust.sample(cut.record(), time), time) / 20.0
    # The trapezium of a cut Gaussian errs by h^2/12 times the jump of its slope, 3e-11 of the speed
    # here.
    assert stepped == pytest.approx(speed, rel=1e-6)
    assert said["impulse_delivered_Ns"] / 20.0 == pytest.approx(stepped, rel=1e-9)
    assert said["impulse_requested_Ns"] == pytest.approx(100.0, rel=1e-14)
    assert said["impulse_delivered_Ns"] / 100.0 == pytest.approx(
        1.0 if rescale else 0.9973002, rel=1e-7
    )
    assert said["rescaled"] == ("yes" if rescale else "no")
    assert said["cutoff_widths"] == 3.0
    assert f"cut at 3 widths and {words}" in said["text"]


@pytest.mark.case("O41")
def test_the_two_readings_differ_by_more_than_the_tolerance():
    """Control: one in place of the other is an error of 0.27 %, 2700 times the tolerance."""
    assert 1.0 - kept_by_cut(3.0) == pytest.approx(2.7e-3, rel=1e-3)


def test_a_description_without_a_cut():
    said = table(**O41).describe(DURATION)
    assert "not cut" in said["text"] and said["cutoff_widths"] == "none"
    assert said["impulse_delivered_Ns"] == pytest.approx(100.0, rel=1e-6)
    assert json.loads(json.dumps(said, allow_nan=False)) == said


def test_the_part_before_ignition_is_not_delivered():
    said = table(**O41 | {"centre": "4 ms"}).describe(DURATION)
    assert said["impulse_delivered_Ns"] == pytest.approx(
        50.0 * (1.0 + math.erf(1.0 / math.sqrt(2.0))), rel=1e-12
    )


@pytest.mark.parametrize("cutoff", [1.0, 2.0, 3.0])
def test_rescaling_restores_the_impulse_of_unequal_pulses(cutoff):
    """One window serves all pulses, so each loses another share of itself."""
    pulses = [
        {"impulse": 60.0, "width": 1e-3, "centre": 0.015},
        {"impulse": 40.0, "width": 4e-3, "centre": 0.025},
    ]
    said = table(kind="gaussians", components=pulses, cutoff=cutoff, rescale=True).describe(
        DURATION
    )
    assert said["impulse_delivered_Ns"] == pytest.approx(100.0, rel=1e-12)


def test_the_law_is_the_sum_of_its_pulses():
    pulses = [
        {"peak": 4e3, "width": 2e-3, "centre": 0.01},
        {"peak": -1e3, "width": 5e-3, "centre": 0.02},
    ]
    record = table(kind="gaussians", components=pulses).record()
    time = np.random.default_rng(1).uniform(0.0, DURATION, 5000)
    expected = sum(
        p["peak"] * np.exp(-0.5 * ((time - p["centre"]) / p["width"]) ** 2) for p in pulses
    )
    assert np.allclose(thrust.sample(record, time), expected, rtol=1e-13, atol=1e-9)
    assert thrust.shortest_feature(record) == 2e-3


def test_python_and_the_compiled_law_give_the_same_bits():
    """Few values come from Python, many from the compiled law. The estimate has them but for the last
    bits."""
    pulses = Pulses(*np.array([[900.0, 300.0], [9e-3, 21e-3], [2e-3, 5e-3]]), 1e-3, 30e-3)
    record = Thrust(pulses, None)
    time = np.random.default_rng(3).uniform(-5e-3, 40e-3, 2000)
    many, few = (
        thrust.sample(record, time),
        [thrust.sample(record, part)[0] for part in time[:, None]],
    )
    assert (many == few).all() and 0 < np.count_nonzero(many) < len(many)
    about = thrust.estimated(record, time)
    np.testing.assert_allclose(about, many, rtol=1e-14)


def test_outside_the_cut_there_is_nothing():
    record = table(**O41, cutoff=2.0).record()
    assert np.array_equal(thrust.corners(record, DURATION), [12e-3, 28e-3])
    assert thrust.sample(record, np.array([12e-3 - 1e-9, 28e-3 + 1e-9])).tolist() == [0.0, 0.0]
    assert (thrust.sample(record, np.array([12e-3 + 1e-9, 28e-3 - 1e-9])) > 1000.0).all()


def curve_file(folder, time, force):
    path = folder / "curve.csv"
    rows = "".join(f"{t!r},{f!r}\n" for t, f in zip(time.tolist(), force.tolist()))
    path.write_text("\ufefftime_s,force_N\n" + rows, encoding="utf-8")
    return str(path)


def test_measured_points_are_interpolated(tmp_path):
    rng = np.random.default_rng(2)
    time, force = np.sort(rng.uniform(0.001, 0.04, 40)), rng.normal(3e3, 1e3, 40)
    record = table(kind="measured", file=curve_file(tmp_path, time, force)).record()
    asked = rng.uniform(0.0, DURATION, 5000)
    assert np.allclose(
        thrust.sample(record, asked),
        np.interp(asked, time, force, left=0.0, right=0.0),
        rtol=1e-12,
        atol=1e-9,
    )
    assert thrust.impulse(record, DURATION) == pytest.approx(np.trapezoid(force, time), rel=1e-13)
    assert np.array_equal(thrust.corners(record, DURATION), time)
    assert thrust.shortest_feature(record) == pytest.approx(np.diff(time).min(), rel=1e-12)


@pytest.mark.case("X27")
def test_a_time_that_stands_twice_is_a_jump(tmp_path):
    """Both sides of it act: the points of a constant push give its record."""
    time, force = np.array([2e-3, 2e-3, 12e-3, 12e-3]), np.array([0.0, 500.0, 500.0, 0.0])
    found = table(kind="measured", file=curve_file(tmp_path, time, force))
    pushed = table(kind="constant", force=500.0, start=2e-3, duration=10e-3)
    for ours, theirs in zip(found.record().curve, pushed.record().curve):
        assert np.array_equal(ours, theirs)
    assert found.requested() == pytest.approx(pushed.requested(), rel=1e-14)
    assert thrust.impulse(found.record(), DURATION) == pytest.approx(5.0, rel=1e-14)


@pytest.mark.case("X27")
def test_the_force_before_a_jump_counts(tmp_path):
    """A ramp of 20 us that ends in a jump to nothing has its peak at the jump, and burns out there."""
    time, force = np.array([1e-3, 1.02e-3, 1.02e-3, 2e-3]), np.array([0.0, 1000.0, 0.0, 0.0])
    record = table(kind="measured", file=curve_file(tmp_path, time, force)).record()
    assert thrust.peak(record, DURATION) == pytest.approx(1000.0, rel=1e-9)
    assert thrust.burnout(record, 0.5, DURATION) == pytest.approx(1.02e-3, rel=1e-12)


@pytest.mark.parametrize("use", ["curve", "fit"])
def test_the_fit_recovers_a_gaussian(tmp_path, use):
    time = np.linspace(0.0, 0.03, 121)
    force = 6e3 * np.exp(-0.5 * ((time - 0.012) / 2e-3) ** 2)
    measured = table(kind="measured", file=curve_file(tmp_path, time, force), use=use)
    said = measured.describe(DURATION)
    assert (said["fit_peak_N"], said["fit_centre_s"], said["fit_width_s"]) == pytest.approx(
        (6e3, 0.012, 2e-3), rel=1e-8
    )
    assert said["fit_relative_residual"] < 1e-8
    assert said["fit_impulse_Ns"] == pytest.approx(said["curve_impulse_Ns"], rel=1e-6)
    assert said["use"] == use
    assert ("the points act" if use == "curve" else "the Gaussian fit acts") in said["text"]
    assert (measured.record().pulses is None) == (use == "curve")
    assert json.loads(json.dumps(said, allow_nan=False)) == said


def test_a_poor_fit_is_reported(tmp_path):
    """A square push has no Gaussian shape: the residual shows it, and the two impulses differ."""
    time = np.linspace(0.0, 0.04, 161)
    force = np.where(np.abs(time - 0.02) < 0.01 - 1e-9, 1e3, 0.0)
    said = table(kind="measured", file=curve_file(tmp_path, time, force)).describe(DURATION)
    assert said["fit_relative_residual"] > 0.05
    assert abs(said["fit_impulse_Ns"] - said["curve_impulse_Ns"]) > 0.1


def test_an_endless_gaussian_is_no_fit(tmp_path):
    """A flat curve is fitted to 1e-10 by a pulse so wide that it would never end."""
    file = curve_file(tmp_path, np.linspace(0.0, 0.02, 81), np.full(81, 1e3))
    assert "no Gaussian fits" in table(kind="measured", file=file).describe(DURATION)["text"]
    with pytest.raises(ValueError, match="that a Gaussian fits"):
        table(kind="measured", file=file, use="fit")


def test_a_curve_without_a_fit_warns_of_no_covariance(tmp_path, recwarn):
    """Four points of one force: least squares ends at a pulse that is too wide to have one."""
    file = curve_file(tmp_path, np.linspace(0.0, 0.15, 4), np.full(4, 100.0))
    assert "no Gaussian fits" in table(kind="measured", file=file).describe(DURATION)["text"]
    assert not recwarn.list


def test_the_fit_of_a_curve_is_searched_once(tmp_path, monkeypatch):
    """Not by each of the conditions of a scene: a search that does not converge takes a second."""
    calls, search = [], scipy.optimize.curve_fit

    def counted(*arguments, **options):
        calls.append(arguments)
        return search(*arguments, **options)

    monkeypatch.setattr(scipy.optimize, "curve_fit", counted)
    file = curve_file(tmp_path, np.array([0, 4e-3, 0.01, 0.021]), np.array([0, 6e3, 5e3, 0]))
    whole = load("reference")
    assert whole.conditions
    with pytest.raises(SceneError, match="did not converge"):
        whole.replace({"thrust": {"kind": "measured", "file": file, "use": "fit"}})
    scene = whole.replace({"thrust": {"kind": "measured", "file": file}})
    assert "no Gaussian fits" in scene.thrust.describe(DURATION)["text"]
    assert len(calls) == 1


def test_where_no_gaussian_fits(tmp_path):
    file = curve_file(tmp_path, np.array([0.0, 0.01]), np.array([0.0, 5.0]))
    assert "no Gaussian fits" in table(kind="measured", file=file).describe(DURATION)["text"]
    with pytest.raises(ValueError, match="Gaussian"):
        table(kind="measured", file=file, use="fit")
    with pytest.raises(ValueError, match="positive impulse"):
        fit_gaussian(MeasuredCurve(np.linspace(0.0, 1.0, 9), np.zeros(9)))


def test_a_needle_between_two_points_is_no_fit(tmp_path):
    """Least squares put it beside the highest point. Control: a Gaussian at the same times."""
    time = np.array([0.0, 0.162, 0.857, 1.15, 1.225, 1.546, 2.415, 2.424])
    force = np.array([0.0, 3377.0, 578.0, 599.0, 635.0, 512.0, 611.0, 0.0])
    file = curve_file(tmp_path, time, force)
    assert "no Gaussian fits" in table(kind="measured", file=file).describe(DURATION)["text"]
    smooth = 3377.0 * np.exp(-0.5 * ((time - 1.15) / 0.3) ** 2)
    found = table(kind="measured", file=curve_file(tmp_path, time, smooth)).fit()
    assert found is not None and found.peak == pytest.approx(3377.0)


def test_a_measured_curve_counts_by_its_points(tmp_path):
    time, force = np.linspace(0.0, 0.02, 9), np.linspace(1.0, 9.0, 9)
    hashes = []
    for name, scale in (("a", 1.0), ("b", 1.0), ("c", 1.001)):
        (tmp_path / name).mkdir()
        hashes.append(
            parse(
                small(
                    thrust={
                        "kind": "measured",
                        "file": curve_file(tmp_path / name, time, force * scale),
                    }
                )
            ).hash
        )
    assert hashes[0] == hashes[1] != hashes[2]


def test_a_push_jumps_on_and_off():
    record = table(kind="constant", force=500.0, start=0.01, duration=0.02).record()
    assert thrust.sample(
        record, np.array([0.0, 0.00999, 0.01, 0.02, 0.02999, 0.03, 0.04])
    ).tolist() == [0, 0, 500, 500, 500, 0, 0]
    assert np.allclose(thrust.corners(record, DURATION), [0.01, 0.03])
    assert thrust.shortest_feature(record) == pytest.approx(0.02)
    assert table(kind="constant", force=500.0, duration=0.02).describe(DURATION)[
        "impulse_requested_Ns"
    ] == pytest.approx(10.0)


@settings(deadline=None)
@given(st.floats(0.001, 0.05))
def test_impulse_of_a_curve_that_outlasts_the_scene(duration):
    """The scene may end inside a segment: impulse is then the integral up to there, not up to the
    last whole segment."""
    record = thrust.Thrust(
        None, thrust.Curve(np.array([0.0, 0.02, 0.04]), np.array([0.0, 100.0, 0.0]))
    )
    exact = (
        2500.0 * duration**2 if duration < 0.02 else 2.0 - 2500.0 * max(0.04 - duration, 0.0) ** 2
    )
    assert thrust.impulse(record, duration) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("fraction", [1e-2, 1e-3])
def test_burnout(fraction):
    record = table(**O41).record()
    exact = 0.02 + 4e-3 * math.sqrt(-2.0 * math.log(fraction))
    found = thrust.burnout(record, fraction, DURATION)
    assert found == pytest.approx(exact, rel=1e-13)
    assert thrust.burnout(record, fraction, 0.02) == 0.02


def test_burnout_of_a_curve_is_its_jump():
    record = table(kind="constant", force=500.0, start=0.01, duration=0.0123).record()
    assert thrust.burnout(record, 1e-3, DURATION) == pytest.approx(0.0223, rel=1e-14)


def test_a_pulse_shorter_than_the_grid_is_not_missed():
    record = table(kind="gaussian", peak=1e3, width=1e-8, centre=0.0200012).record()
    assert thrust.peak(record, DURATION) == pytest.approx(1e3, rel=1e-9)
    assert 0.0200012 < thrust.burnout(record, 1e-3, DURATION) < 0.0200012 + 1e-7


@pytest.mark.parametrize("count", [1, 2])
def test_the_peak_of_pulses_that_begin_late_is_at_their_begin(count):
    pulses = Pulses(
        np.full(count, 1e3), np.linspace(0.01, 0.012, count), np.full(count, 4e-3), 0.0175, 0.03
    )
    record = Thrust(pulses, None)
    began = float(thrust.sample(record, np.array([0.0175]))[0])
    assert thrust.peak(record, DURATION) == began > 100.0


def test_no_thrust_is_burnt_out_at_once():
    assert (
        thrust.burnout(table(kind="constant", force=0.0, duration=0.01).record(), 1e-3, DURATION)
        == 0.0
    )
