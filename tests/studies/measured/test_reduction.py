"""The change of rate and its budget: exact parts, coverage over many sensors, and controls that
miss it."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

from tests.studies.measured.sensor import Channel, Sensor
from tests.studies.measured.synthetic import INTERVAL, QUIET, log, motion, samples, sheet, spans
from tipoff.faults import SceneError
from tipoff.studies.measured import analysis
from tipoff.studies.measured.log import calibrated
from tipoff.studies.measured.reduction import reduced

SCALE, SKEW, BIAS_INSTABILITY, G, NOISE = 2e-3, 2e-3, 2e-4, 2e-5, 7e-5
UNCERTAIN = {
    "bias_instability": BIAS_INSTABILITY,
    "scale": SCALE,
    "misalignment": SKEW,
    "g_sensitivity": G,
}


def sensor(rng, g=G):
    """A gyro triad whose errors are draws of what the sheet says of them; its bias is anything."""
    skew = SKEW * rng.standard_normal((3, 3))
    np.fill_diagonal(skew, 0.0)
    gyro = Channel(rng.normal(0.0, 0.01, 3), SCALE * rng.standard_normal(3), NOISE, 2e-4, 10.0)
    force = Channel(np.zeros(3), np.zeros(3), 2e-3, 0.0, 1000.0)
    return Sensor(
        gyro,
        force,
        skew,
        g * rng.standard_normal((3, 3)),
        np.zeros(3),
        293.15,
        BIAS_INSTABILITY,
        np.eye(3),
    )


def trials(count, ask, windows, g=G):
    """Errors (count,3) over the stated expanded uncertainty."""
    found = []
    for seed in range(count):
        rng = np.random.default_rng([9, seed])
        start = 0.002 * rng.standard_normal(3)
        change = 0.15 * rng.standard_normal(3)
        result = reduced(
            ask, calibrated(ask, log(sensor(rng, g), start, start + change, rng)), windows, "test"
        )
        found.append((result.change - change) / (result.factor * result.combined))
    return np.array(found)


def test_stated_intervals_cover_at_their_rate():
    """95 % of components within U, up to what 3 x 250 draws can tell (99.9 %, binomial); all parts
    of a size."""
    ask = sheet(gyro={"uncertainty": UNCERTAIN, "resolution": 2e-4})
    inside = (np.abs(trials(250, ask, spans())) <= 1.0).mean()
    assert inside == pytest.approx(0.95, abs=3.3 * np.sqrt(0.95 * 0.05 / 750))


def test_the_whole_chain_from_raw_samples_covers_too():
    """Events found, windows laid, rates reduced, from 12 sensors; fewer than a chance of 1e-3
    allows may not hold their truth."""
    ask, inside = sheet(gyro={"uncertainty": UNCERTAIN, "resolution": 2e-4}), []
    for seed in range(12):
        rng = np.random.default_rng([11, seed])
        start, change = 0.002 * rng.standard_normal(3), 0.15 * rng.standard_normal(3)
        found = analysis.drop_of(ask, log(sensor(rng), start, start + change, rng), "test")
        inside += (
            np.abs(found.reduced.change - change) <= found.reduced.factor * found.reduced.combined
        ).tolist()
    assert sum(inside) >= binom.ppf(1e-3, len(inside), 0.95)


def test_controls_fail_to_cover():
    """Noise alone in the budget is too little; and a reference taken while hanging feels g through
    the g-sensitivity."""
    alone = sheet(gyro={"uncertainty": dict.fromkeys(UNCERTAIN, 0.0), "resolution": 2e-4})
    assert (np.abs(trials(80, alone, spans())) <= 1.0).mean() < 0.85
    hanging = spans()._replace(reference=(0.6, 0.9))
    told = sheet(gyro={"uncertainty": UNCERTAIN | {"g_sensitivity": 1e-3}, "resolution": 2e-4})
    blind = sheet(gyro={"uncertainty": UNCERTAIN | {"g_sensitivity": 0.0}, "resolution": 2e-4})
    # in free fall there is nothing to feel
    assert (np.abs(trials(80, blind, spans(), g=1e-3)) <= 1.0).mean() > 0.9
    assert (np.abs(trials(80, blind, hanging, g=1e-3)) <= 1.0).mean() < 0.3
    assert (np.abs(trials(80, told, hanging, g=1e-3)) <= 1.0).mean() > 0.9


def test_without_errors_the_change_is_exact_and_its_parts_are_their_formulas():
    before, after = np.array([0.01, -0.02, 0.03]), np.array([0.2, 0.0, -0.3])
    ask = sheet(gyro={"uncertainty": UNCERTAIN | {"bias_instability": 0.0, "temperature": 1e-3}})
    raw = log(
        QUIET._replace(gyro=QUIET.gyro._replace(density=1e-9)),
        before,
        after,
        np.random.default_rng(1),
    )
    found = reduced(
        ask, calibrated(ask, raw._replace(temperature=293.15 + 2.0 * raw.time)), spans(), "test"
    )
    change = after - before
    np.testing.assert_allclose(found.change, change, atol=1e-8)
    np.testing.assert_allclose(found.parts["scale"], SCALE * np.abs(change), rtol=1e-5)
    np.testing.assert_allclose(
        found.parts["misalignment"],
        SKEW * np.hypot(change[[1, 0, 0]], change[[2, 2, 1]]),
        rtol=1e-5,
    )
    middle = np.mean(spans().settled) - np.mean(spans().reference)
    np.testing.assert_allclose(found.parts["temperature"], 1e-3 * 2.0 * middle, rtol=1e-2)
    assert found.parts["g-sensitivity"].max() < 1e-12
    np.testing.assert_allclose(found.factor, 1.96, atol=1e-3)  # all but known: normal


def test_a_tumble_is_told_at_the_instant_of_simulations():
    """Rates of a free body that bend like w' = k w^2: the straight line at the instant misses them
    by less than the part that stands for it, times sqrt(3), the half width of its rectangle.
    Control: the mean over the window misses it by more."""
    time, rate, _ = motion([0.0] * 3, [0.0] * 3)
    start, speed, k = spans().settled[0], np.array([0.8, -0.5, 0.3]), 0.4
    later = time >= spans().instant - 1e-9
    rate[later] = speed / (1.0 - k * speed * (time[later, None] - spans().instant))
    rate += 2e-5 * np.random.default_rng(2).standard_normal(rate.shape)
    found = reduced(sheet(), samples(rate), spans(), "test")
    assert start > spans().instant
    assert (
        np.abs(found.change - speed)
        <= np.sqrt(3.0) * found.parts["bent line"] + 4.0 * found.parts["noise"]
    ).all()
    mean = rate[(time >= start) & (time <= spans().settled[1])].mean(axis=0)
    assert (np.abs(mean - speed) > 5.0 * np.abs(found.change - speed)).all()


def test_coloured_noise_is_not_taken_for_white():
    """The spread of many estimates is the stated noise; taken as white it would be a third of
    it."""
    windows, errors, stated, taus = spans(), [], [], []
    length = len(motion([0.0] * 3, [0.0] * 3)[0])
    for seed in range(120):
        noise = lfilter(
            [1.0],
            [1.0, -0.8],
            np.random.default_rng([4, seed]).standard_normal((length, 3)),
            axis=0,
        )
        found = reduced(sheet(), samples(noise), windows, "test")
        errors.append(found.change)
        stated.append(found.parts["noise"])
        taus.append(found.correlation)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(
        np.sqrt(np.mean(np.square(stated))), rel=0.1
    )
    assert np.mean(taus) == pytest.approx(9.0, rel=0.15)


def test_a_payload_that_still_hits_something_is_refused():
    """Control: the same without the blow passes."""
    time, rate, _ = motion([0.0] * 3, [0.1] * 3)
    rate = rate + 2e-3 * np.random.default_rng(3).standard_normal(rate.shape)
    reduced(sheet(), samples(rate), spans(), "test")
    rate[time > np.mean(spans().settled), 1] += 0.02
    with pytest.raises(SceneError, match="scatter about y"):
        reduced(sheet(), samples(rate), spans(), "test")


def test_rounding_coarser_than_the_noise_does_not_average_out():
    """Three tenths of a step off, forever: the stated uncertainty must hold it. Control: averaged
    like noise it would not."""
    step, (time, rate, _) = 1e-3, motion([0.0] * 3, [0.0] * 3)
    rate[time > spans().instant - INTERVAL] = 10.3 * step
    rounded = step * np.round(
        (rate + 1e-5 * np.random.default_rng(5).standard_normal(rate.shape)) / step
    )
    found = reduced(sheet(gyro={"resolution": step}), samples(rounded), spans(), "test")
    error = np.abs(found.change - 10.3 * step)
    assert error == pytest.approx(0.3 * step) and (error < found.factor * found.combined).all()
    assert (error > 2.0 * step * np.sqrt((1.0 / 280.0 + 1.0 / 100.0) / 12.0)).all()
