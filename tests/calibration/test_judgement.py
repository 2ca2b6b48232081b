"""Curves are judged before their fit is believed: wrong units, signs, axes and offsets in time, and
sound curves with noise or with the error of another model."""

import dataclasses
import functools

import numpy as np
import pytest

from tests.calibration.noisy import inside
from tests.highfi.support import tiny
from tipoff import calibration, highfi, lowfi
from tipoff.calibration import Curves
from tipoff.calibration.search import Plan
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import changes
from tipoff.scenes.calibration import Calibration
from tipoff.studies.calibration import page, stage
from validation.recovery.draws import LOCAL, noisy

CONDITIONS = ("phi15", "phi60")
CLEARANCE, FRICTION, LINE = "contact.clearance", "friction.dynamic", "thrust_offset.eccentricity.y"
TRUE = 0.22e-3
TURN = np.degrees(1.0)
EXCHANGED = np.eye(3)[[0, 2, 1]]


@functools.cache
def compliance() -> RailCompliance:
    return highfi.condense(tiny(), 8e-3)


@functools.cache
def curves(clearance: float = TRUE) -> dict[str, Curves]:
    scene, still = tiny().replace({CLEARANCE: clearance}), lowfi.Numerics(modes=0)
    return {
        name: Curves.from_trajectory(
            lowfi.run(scene.condition(name), compliance=compliance(), numerics=still)
        )
        for name in CONDITIONS
    }


def fitted(references: dict[str, Curves], *names: str) -> Calibration:
    fit = list(names or [CLEARANCE])
    return calibration.run(tiny(), references, plan=LOCAL, compliance=compliance(), fit=fit)


def shifted(curve: Curves, offset: float) -> Curves:
    """Late by ``offset`` (s)."""
    velocity, *rate = (
        np.interp(curve.time - offset, curve.time, column)
        for column in (curve.velocity, *curve.rate.T)
    )
    return curve._replace(velocity=velocity, rate=np.column_stack(rate))


def turned(curve: Curves, turn: np.ndarray) -> Curves:
    return curve._replace(rate=curve.rate @ turn.T, settled=curve.settled @ turn.T)


def quicker(curve: Curves, factor: float) -> Curves:
    return curve._replace(velocity=factor * curve.velocity)


def refusal(references: dict[str, Curves], *names: str) -> str:
    with pytest.raises(calibration.CalibrationError) as refused:
        fitted(references, *names)
    return str(refused.value)


RATES = [
    (TURN * np.eye(3), "values in deg/s with the unit rad/s"),
    (np.eye(3) / TURN, "values in rad/s with the unit deg/s"),
    (30.0 / np.pi * np.eye(3), "values in rpm with the unit rad/s"),
    (EXCHANGED, "rate_y and rate_z are exchanged"),
    (np.diag([1.0, 1.0, -1.0]), "the sign of rate_z"),
    (np.eye(3)[[1, 2, 0]], "axes: rate_x is the column rate_z"),
]


@pytest.mark.parametrize(("turn", "words"), RATES)
def test_rates_of_another_unit_sign_or_axis_are_refused_with_the_cause(turn, words):
    """Two per cent of noise. Control: without a turn, below."""
    generator = np.random.default_rng(1)
    wrong = {name: noisy(turned(item, turn), 0.02, generator) for name, item in curves().items()}
    told = refusal(wrong)
    assert told.count(f"Likely cause: {words}") == 2, told
    assert "rates of phi15 differ from the model" in told


def test_the_unit_is_named_where_rates_begin_with_contact():
    """A payload that drifts to its walls does not turn before, and where it touches depends on the clearance.
    So the scene's values and those of the fit explain the right curves no better than the wrong ones: the
    points of the search between them do. Control: the right unit is fitted."""
    drifting = {"thrust_offset": "absent", "initial.velocity.y": 0.1, "initial.velocity.z": 0.03}
    exact, asked = {}, tiny().replace(drifting)
    for name in CONDITIONS:
        own = asked.replace({CLEARANCE: TRUE}).condition(name)
        run = lowfi.run(own, compliance=compliance(), numerics=lowfi.Numerics(modes=0))
        exact[name] = noisy(Curves.from_trajectory(run), 0.02, np.random.default_rng(5))

    def fit(references):
        return calibration.run(
            asked, references, plan=LOCAL, compliance=compliance(), fit=[CLEARANCE]
        )

    assert fit(exact).values == pytest.approx([TRUE], rel=0.05)
    with pytest.raises(calibration.CalibrationError) as refused:
        fit({name: turned(item, TURN * np.eye(3)) for name, item in exact.items()})
    assert str(refused.value).count("Likely cause: values in deg/s with the unit rad/s") == 2, str(
        refused.value
    )


@pytest.mark.parametrize("turn", [TURN * np.eye(3), np.diag([1.0, 1.0, -1.0])])
def test_the_one_wrong_curve_is_named(turn):
    told = refusal(curves() | {"phi60": turned(curves()["phi60"], turn)})
    assert "rates of phi60" in told and "phi15" not in told


@pytest.mark.parametrize("swapped", [("phi60", "phi15"), ("phi15", "phi15")])
def test_curves_of_another_condition_are_named(swapped):
    """Both exchanged, and one file given twice."""
    wrong = {
        name: noisy(curves()[own], 0.02, np.random.default_rng(place))
        for place, (name, own) in enumerate(zip(CONDITIONS, swapped))
    }
    told = refusal(wrong)
    lines = {
        name: line
        for line in told.splitlines()
        for name in CONDITIONS
        if f"rates of {name} " in line
    }
    for name, own in zip(CONDITIONS, swapped):
        words = f"Likely cause: these are the curves of {own}"
        assert (words in lines.get(name, "")) == (name != own), told


@pytest.mark.parametrize("clearance", [0.1e-3, 1e-3])
def test_curves_of_which_the_fit_explains_nothing_are_refused(clearance):
    """The clearance is beyond the bounds of the fit, whose free flight is right. Control: one within
    the bounds is fitted, in the tests of offsets."""
    told = refusal(curves(clearance))
    assert "differ from the model by 1" in told and "a fitted value is beyond its bounds" in told


@pytest.mark.parametrize(("turn", "words"), [RATES[0], RATES[3]])
def test_the_cause_is_named_also_where_the_line_of_thrust_is_fitted(turn, words):
    """It is 0.1 mm off, with 2 % of noise. Free flight depends on the fit then, so the search itself is
    judged. Its points have a line of thrust for the wrong curves, and hardly one explains the right ones."""
    wrong, scene = {}, tiny().replace({CLEARANCE: TRUE})
    for name in CONDITIONS:
        own = scene.condition(name)
        off = own.replace(changes.overrides(own, {LINE: 1e-4}))
        run = lowfi.run(off, compliance=compliance(), numerics=lowfi.Numerics(modes=0))
        exact = noisy(Curves.from_trajectory(run), 0.02, np.random.default_rng(5))
        wrong[name] = turned(exact, turn)
    assert refusal(wrong, CLEARANCE, LINE).count(words) == 2


@pytest.mark.parametrize(("turn", "words"), RATES[:2])
def test_the_unit_is_named_where_all_errors_of_mounting_are_candidates(turn, words):
    """Of a payload in free flight, whose line of thrust is 0.1 mm off: the search has hardly a point
    that explains the curves in the right unit. Control: the right unit is fitted."""
    free = tiny().replace({"contact": "absent", "friction": "absent"})
    exact = {}
    for name in CONDITIONS:
        own = free.condition(name)
        run = lowfi.run(own.replace(changes.overrides(own, {LINE: 1e-4})))
        exact[name] = noisy(Curves.from_trajectory(run), 0.02, np.random.default_rng(5))
    plan = Plan(points=32, starts=1, evaluations=30, polish=6)
    found = calibration.run(free, exact, plan=plan)
    assert max(row["rate_relative_l2"] for row in found.residuals.values()) < 0.05
    with pytest.raises(calibration.CalibrationError) as refused:
        calibration.run(free, {n: turned(c, turn) for n, c in exact.items()}, plan=plan)
    assert str(refused.value).count(f"Likely cause: {words}") == 2, str(refused.value)


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1000.0, "values in mm/s with the unit m/s"),
        (0.001, "values in km/s with the unit m/s"),
        (3.6, "values in km/h with the unit m/s"),
        (-1.0, "the sign"),
        (1.2, "thrust, mass or unit is not that of the scene"),
    ],
)
def test_v_x_that_is_not_impulse_over_mass_is_refused(factor, words):
    wrong = curves() | {"phi15": quicker(curves()["phi15"], factor)}
    told = refusal(wrong)
    assert f"Likely cause: {words}" in told and "velocity_x of phi15" in told
    assert "phi60" not in told


def test_v_x_of_another_shape_is_refused():
    ramp = {
        n: c._replace(velocity=c.velocity[-1] * c.time / c.time[-1]) for n, c in curves().items()
    }
    assert "thrust curve, or another column" in refusal(ramp)


@pytest.mark.parametrize("offset", [3e-4, 1e-3, -3e-4, 5e-5])
def test_an_offset_in_time_is_fitted_and_said(offset):
    """The interval contains the true clearance. An offset of less than a sample is fitted without a
    word in the verdict. Control: without the offset the clearance is wrong, in the test of the kept
    record below."""
    found = fitted({name: shifted(item, offset) for name, item in curves().items()})
    assert inside(found.with_model_error, [TRUE]).all()
    assert found.values == pytest.approx([TRUE], rel=2e-3)
    said = f"the curves of phi15 are {1e3 * abs(offset):.4g}"
    assert (said in found.verdict) == (abs(offset) > 1e-4), found.verdict
    assert ("late" if offset > 0.0 else "early") in found.provenance["offsets in time"]


@pytest.mark.parametrize(("noise", "seed"), [(0.0, 0), (0.02, 1), (0.1, 2), (0.1, 3)])
def test_sound_curves_with_noise_are_fitted(noise, seed):
    generator = np.random.default_rng(seed)
    found = fitted({name: noisy(item, noise, generator) for name, item in curves().items()})
    assert found.values == pytest.approx([TRUE], rel=0.05)
    assert "late" not in found.verdict and "early" not in found.verdict


def test_a_model_that_errs_in_contact_is_no_wrong_curve():
    """Springs miss curves of compliant contact by a third and several deg/s."""
    plan = Plan(points=4, starts=1, evaluations=8, polish=2)
    found = calibration.run(tiny(), curves(), plan=plan)
    assert max(row["rate_relative_l2"] for row in found.residuals.values()) > 0.1
    assert "which is model error or an input that is not fitted" in found.verdict
    wrong = {name: turned(item, TURN * np.eye(3)) for name, item in curves().items()}
    with pytest.raises(calibration.CalibrationError, match="values in deg/s with the unit rad/s"):
        calibration.run(tiny(), wrong, plan=plan)


def test_a_kept_value_is_not_beside_the_interval_of_the_fit():
    """The table shows the fitted value beside its interval, and the kept one in a column of its own;
    the residuals are those of the kept values."""
    generator = np.random.default_rng(4)
    found = fitted({n: noisy(c, 0.02, generator) for n, c in curves(0.25e-3).items()})
    assert found.verdict.startswith("nothing needs fitting") and found.constants == {}
    assert found.values == [0.25e-3] and found.fitted != found.values
    ((low, high),) = found.with_model_error
    assert 0.5 * (low + high) == pytest.approx(found.fitted[0], rel=1e-9)
    table = page.draw(stage.fit_of(found, "calibration.toml"))[1]
    heads = [getattr(column, "head", column) for column in table.columns]
    assert "kept, the scene's" in str(heads)
    same = dataclasses.replace(found, fitted=[])
    assert same.estimates == same.values
