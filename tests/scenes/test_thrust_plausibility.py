"""A thrust in another unit, a load cell that does not read zero, records that begin or end with thrust,
and fits that are poor: each is named with numbers, and sound thrusts are not."""

import math

import numpy as np
import pytest

from tests.scenes.support import refused, small
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes import implausible, load, parse

BURN, PEAK = (0.2, 0.8), 200.0  # s, N
IMPULSE = PEAK * (BURN[1] - BURN[0]) * 2.0 / np.pi  # of a half sine


def half_sine(time):
    share = np.clip((time - BURN[0]) / (BURN[1] - BURN[0]), 0.0, 1.0)
    return PEAK * np.sin(np.pi * share)


def written(folder, time, force, **keys):
    """A scene without a stated duration and with this record of a thrust."""
    rows = "".join(
        f"{t!r},{f!r}\n" for t, f in zip(np.asarray(time).tolist(), np.asarray(force).tolist())
    )
    (folder / "curve.csv").write_text("time_s,force_N\n" + rows)
    table = {"kind": "measured", "file": str(folder / "curve.csv")} | keys
    raw = small(thrust=table, output={"interval": "1 ms"})
    del raw["duration"]
    return parse(raw)


def of_thrust(scene):
    return [words for words in scene.warnings if words.startswith("thrust")]


TIME = np.linspace(0.0, 5.0, 5001)


@pytest.mark.parametrize(
    "first, last", [(4.0, 4.0), (-3.0, -3.0), (0.0, 6.0), (4.0, -1.0), (5.0, 0.0)]
)
@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_a_reading_without_thrust_is_named_and_subtracted(tmp_path, first, last, noise):
    """A drifting zero under a half sine of 76.4 N s: the impulse that it adds is the mean of its ends
    times 5 s. Control: without the drift nothing is said."""
    scatter = noise * np.random.default_rng(3).standard_normal(TIME.size)
    drift = first + (last - first) * TIME / TIME[-1]
    scene = written(tmp_path, TIME, half_sine(TIME) + drift + scatter)
    (words,) = of_thrust(scene)
    added = 0.5 * (first + last) * TIME[-1]
    assert words.startswith("thrust.baseline: the force does not return to zero: ")
    told = float(words.partition("this adds ")[2].partition(" N s")[0])
    # the level before the burn, of 0.2 s, may be off by the drift in a quarter of it, and by noise
    off = 0.05 * abs(last - first) / TIME[-1] + 4.0 * 1.2533 * noise / 10.0
    assert told == pytest.approx(added, abs=0.5 * off * TIME[-1] + 1e-3)
    if noise == 0.0 and first == last:
        assert f"{first:g} N before ignition, {last:g} N after burn-out" in words
        assert f"{100.0 * added / IMPULSE:+.3g} % of the 76.39 N s without it" in words
        assert f'thrust.baseline = ["{first:g} N", "{last:g} N"]' in words
    straight = [f"{first} N", f"{last} N"]
    corrected = written(tmp_path, TIME, half_sine(TIME) + drift + scatter, baseline=straight)
    assert of_thrust(corrected) == [] and corrected.hash != scene.hash
    found = thrust_law.impulse(corrected.thrust.record(), 5.0)
    assert found == pytest.approx(IMPULSE + np.trapezoid(scatter, TIME), rel=1e-5)
    assert thrust_law.impulse(scene.thrust.record(), 5.0) - found == pytest.approx(added, abs=1e-9)
    assert of_thrust(written(tmp_path, TIME, half_sine(TIME) + scatter)) == []


def test_a_baseline_of_a_record_with_few_points(tmp_path):
    """Both ends read 4 N. Control: a record that begins at zero and ends so."""
    time, force = np.array([0.0, 0.2, 0.5, 0.8, 5.0]), np.array([4.0, 4.0, 204.0, 4.0, 4.0])
    (words,) = of_thrust(written(tmp_path, time, force))
    assert "this adds 20 N s" in words and '["4 N", "4 N"]' in words
    assert of_thrust(written(tmp_path, time, force - 4.0)) == []


@pytest.mark.parametrize(
    "time, force, words",
    [
        ([0.12, 0.3, 0.6], [150.0, 200.0, 0.0], "first point: 150 N at 0.12 s, 75 % of the peak"),
        ([0.0, 0.3, 0.6], [0.0, 200.0, 80.0], "last point: 80 N at 0.6 s, 40 % of the peak"),
        (np.linspace(0.0, 0.4, 401), None, "last point: "),
    ],
)
def test_a_record_that_begins_or_ends_with_thrust_is_named(tmp_path, time, force, words):
    """The thrust is zero outside the record. Control: two rows with one time say so."""
    force = half_sine(time) if force is None else force
    (found,) = of_thrust(written(tmp_path, time, force))
    assert found.startswith(f"thrust.file, {words}")
    jumps = [time[0], *time, time[-1]], [0.0, *force, 0.0]
    keep = slice(1 if time[0] == 0.0 else 0, len(jumps[0]) - (1 if force[-1] == 0.0 else 0))
    assert of_thrust(written(tmp_path, *(column[keep] for column in jumps))) == []


@pytest.mark.parametrize(
    "time, force",
    [
        ([0.0, 0.1, 0.2], [500.0, 300.0, 0.0]),  # a spring
        ([0.0, 0.0, 0.1, 0.1], [0.0, 50.0, 50.0, 0.0]),  # a constant push
        (np.linspace(0.0, 0.1, 101), 50.0 + 0.0 * np.linspace(0.0, 0.1, 101)),
        (np.linspace(0.0, 1.0, 1001), 200.0 * np.exp(-8.0 * np.linspace(0.0, 1.0, 1001))),  # a tank
    ],
)
def test_sound_thrusts_have_no_offset(tmp_path, time, force):
    found = of_thrust(written(tmp_path, time, force))
    assert not any("baseline" in words for words in found)


@pytest.mark.parametrize(
    "factor, unit",
    [
        (1e3 / 9.80665, "gf"),
        (1e3, "mN"),
        (1e-3, "kN"),
        (1.0 / 4.4482216, "lbf"),
        (1 / 9.80665, "kgf"),
    ],
)
def test_the_unit_of_a_force_that_is_labelled_n(tmp_path, factor, unit):
    """76.4 N s on 10 kg are 7.64 m/s. lbf and kgf are seen where the speed is too low for a launch."""
    weaker = 0.02 if unit in ("lbf", "kgf") else 1.0
    force = weaker * half_sine(TIME)
    (words,) = of_thrust(written(tmp_path, TIME, factor * force))
    speed = weaker * IMPULSE / 10.0
    assert words.startswith(f"thrust, payload.mass: {factor * speed:.4g} m/s by the thrust")
    assert f"{speed:.4g} m/s if it is in {unit}" in words
    if weaker == 1.0:  # Control
        assert of_thrust(written(tmp_path, TIME, force)) == []


def test_speed_and_acceleration_are_those_of_a_point_mass():
    """A constant push of 50 kN on 9.9 kg and on a platform of 81.2 kg for 40 ms: the exit is at
    sqrt(2 a s), where both bodies move. Control: a tenth of it is silent."""
    scene = load("reference")
    push = {"kind": "constant", "force": 50e3, "duration": 0.04}
    (words,) = of_thrust(scene.replace({"thrust": push}))
    gain = 1.0 / 9.9 + 1.0 / 81.2
    way = 0.132 + 0.088
    assert (
        f": {50e3 * 0.04 * gain:.4g} m/s by the thrust, {(2 * 50e3 * gain * way) ** 0.5:.4g} m/s"
        in words
    )
    assert f"after {1e3 * way:.4g} mm, {50e3 / 9.9 / 9.80665:.4g} g at the peak" in words
    assert of_thrust(scene.replace({"thrust": push | {"force": 5e3}})) == []


def test_a_rocket_gains_speed_after_its_rail():
    """606 m/s at 20 g, 9.5 m/s of them on the rail. Controls: the same with its reaction on the
    platform, whose payload has left; and ten times the force."""
    scene = load("tiny").replace({"duration": None, "output.interval": "1 ms"})
    rocket = {"kind": "constant", "force": 2e3, "duration": 3.0, "reaction": "exhaust"}
    assert of_thrust(scene.replace({"thrust": rocket})) == []
    (words,) = of_thrust(scene.replace({"thrust": rocket | {"reaction": "platform"}}))
    assert 'has thrust.reaction = "exhaust"' in words
    (words,) = of_thrust(scene.replace({"thrust": rocket | {"force": 2e4}}))
    assert "6061 m/s by the thrust" in words and "reaction" not in words


def test_a_thrust_away_from_the_open_end_and_other_drives():
    scene = load("reference")
    push = {"kind": "constant", "force": -100.0, "duration": 0.1}
    (words,) = of_thrust(scene.replace({"thrust": push}))
    assert "away from the open end" in words
    slow = {"thrust": push | {"force": 1.0}, "platform": None}
    assert len(of_thrust(scene.replace(slow))) == 1
    assert of_thrust(scene.replace(slow | {"gravity.x": 1.0})) == []  # it slides out


def test_a_fit_whose_impulse_is_off_is_refused_unless_told_otherwise(tmp_path):
    """A trapezoid: the Gaussian is 6 % off. The message has the number that the key must exceed."""
    time = np.linspace(0.0, 1.0, 401)
    force = PEAK * np.clip(np.minimum(time - 0.2, 0.8 - time) / 0.02, 0.0, 1.0)
    raw = small(thrust={"kind": "measured", "file": str(tmp_path / "curve.csv"), "use": "fit"})
    written(tmp_path, time, force)
    (fault,) = refused(raw)
    assert fault.key == "thrust.use" and "fit_impulse_tolerance" in fault.expected
    fit = written(tmp_path, time, force).thrust.fit()
    late = 0.5 * (1.0 + math.erf(fit.centre / (math.sqrt(2.0) * fit.width)))  # after ignition
    off = late * fit.impulse / np.trapezoid(force, time) - 1.0
    assert abs(off) > 0.02 and f"{100.0 * off:+.3g} %" in fault.given
    assert f"{100.0 * fit.relative_residual:.3g} %" in fault.given
    raw["thrust"]["fit_impulse_tolerance"] = 0.99 * abs(off)
    assert [fault.key for fault in refused(raw)] == ["thrust.use"]
    raw["thrust"]["fit_impulse_tolerance"] = 1.01 * abs(off)
    (words,) = [words for words in parse(raw).warnings if words.startswith("thrust.use")]
    assert f"{100.0 * off:+.3g} %" in words
    # Control: a Gaussian
    raw["thrust"].pop("fit_impulse_tolerance")
    written(tmp_path, time, PEAK * np.exp(-0.5 * ((time - 0.5) / 0.08) ** 2))
    assert of_thrust(parse(raw)) == []


def test_all_faults_of_one_record_are_said(tmp_path):
    """Each has a key of its own, by which conditions are told apart."""
    scene = written(tmp_path, TIME, 1e3 * (half_sine(TIME) + 4.0))
    keys = [words.partition(":")[0] for words in implausible.of_all_conditions(scene)]
    assert [key for key in keys if key.startswith("thrust")] == [
        "thrust, payload.mass",
        "thrust.baseline",
    ]
