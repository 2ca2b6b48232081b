"""Exit, settled means and jams of the reference: from its steps, however a run is sampled, and to
their order."""

import functools

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize

from tests.highfi.support import COARSE, Stopped, begun, tiny, whole
from tipoff import highfi, lowfi
from tipoff.highfi.dynamics.checkpoint import Checkpoint, restore
from tipoff.highfi.numerics import Numerics
from tipoff.mechanics.books import DONE
from tipoff.scenes import launch


def assert_same(found, expected) -> None:
    """Status and every number of the outcome, bit for bit."""
    assert found.status == expected.status and found.outcome == expected.outcome
    assert found.cost["dt_s"] == expected.cost["dt_s"]


def springs_of(scene):
    return lowfi.run(scene, "springs")


@functools.cache
def sampled_once():
    """The run that nothing interrupts, with one sample in the whole flight."""
    return highfi.run(tiny(output__interval="25 ms"), COARSE)


def assert_sampling_changes_no_bit(fine) -> None:
    """From the samples of ``fine`` to one in the whole flight."""
    seldom, once = highfi.run(tiny(output__interval="7 ms"), COARSE), sampled_once()
    assert fine.status == "exited" and np.abs(fine.pad_force).max() > 1.0
    assert [other.time.size for other in (seldom, once)] == [4, 1]
    for other in (seldom, once):
        assert_same(other, fine)


def test_sampling_changes_no_bit():
    """One sample in 0.1 ms."""
    assert_sampling_changes_no_bit(whole())


@pytest.mark.slow
def test_more_samples_change_no_bit():
    """One in 0.05 ms."""
    assert_sampling_changes_no_bit(highfi.run(tiny(output__interval="0.05 ms"), COARSE))


def test_an_interval_that_divides_no_peak():
    """The step divides the interval, so another interval has another step. They differ by less than
    one in the number of steps in 50 us, so the outcomes differ by a small part of the error of the
    scheme. So do long steps, whose number of steps divides the interval."""
    one, other = whole(), highfi.run(tiny(output__interval="0.73 ms"), COARSE)
    assert other.cost["dt_s"] != one.cost["dt_s"]
    assert other.outcome.exit_time == pytest.approx(one.outcome.exit_time, abs=3e-10)
    assert other.outcome.rate == pytest.approx(
        one.outcome.rate, abs=1e-5 * np.linalg.norm(one.outcome.rate)
    )


def straight(safety: float, step_everything: bool = True, **thrust) -> tuple[float, float, float]:
    """Errors of exit (s) and mean velocity (m/s) of a payload that is pushed along the rail and
    touches nothing, and the step (s). Its platform is as free: both move by the Gaussian push over
    their masses. The rails rest unless ``step_everything``."""
    scene = tiny(thrust_offset__misalignment__axial=0.0, output__interval="25 ms", **thrust)
    numerics = Numerics(COARSE.element_size, safety=safety, step_everything=step_everything)
    found = highfi.run(scene, numerics)
    push, pad = scene.thrust, scene.pads[0]
    together = 1.0 / scene.payload.mass + 1.0 / scene.platform.mass

    def shape(t):
        return np.exp(-0.5 * ((t - push.centre) / push.width) ** 2)

    def speed(t, factor):
        return (
            factor
            * push.peak
            * scipy.integrate.quad(shape, 0.0, t, epsabs=0.0, epsrel=1e-13, limit=200)[0]
        )

    def way(begin, end, factor):
        return scipy.integrate.quad(
            speed, begin, end, args=(factor,), epsabs=0.0, epsrel=1e-12, limit=200
        )[0]

    past = scene.rail.end + 0.5 * pad.length - min(pad.position[0] for pad in scene.pads)
    exact = scipy.optimize.brentq(
        lambda t: way(0.0, t, together) - past, 1e-3, scene.duration, xtol=1e-15, rtol=1e-14
    )
    # at exit: the mean speed over 0.2 ms, and the part of the push that comes after it
    mean = way(exact, exact + 2e-4, 1.0 / scene.payload.mass) / 2e-4
    assert found.outcome.exit_velocity[0] == pytest.approx(mean, rel=1e-8)
    share = 1.0 - speed(exact, 1.0) / speed(scene.duration, 1.0)
    assert found.outcome.impulse_after_exit == pytest.approx(share, abs=1e-9)
    start = found.outcome.window_start
    assert start == pytest.approx(exact + 1e-3, abs=1e-7)  # the push is over
    mean = way(start, start + 2e-3, 1.0 / scene.payload.mass) / 2e-3
    return (
        abs(found.outcome.exit_time - exact),
        abs(found.outcome.velocity[0] - mean),
        found.cost["dt_s"],
    )


@pytest.mark.parametrize("safety", [0.45, pytest.param(0.3, marks=pytest.mark.slow)])
def test_exit_and_means_of_a_straight_flight(safety):
    """Errors fall with the square of the step, at the least; the interval is the whole flight.
    Control: an exit at the nearest step would be off by a quarter of a step on the average, 1e-7
    s."""
    (exit_at, mean, dt), (finer_exit, finer_mean, finer_dt) = straight(0.9), straight(safety)
    assert exit_at < 1e-11 and mean < 1e-8
    allowed = 1.5 * (finer_dt / dt) ** 2
    assert finer_exit < allowed * exit_at and finer_mean < allowed * mean


def test_long_steps_of_a_straight_flight():
    """No pad comes near a rail, so all rails rest and nearly all steps are twice as long:
    errors are four times those of a step, as for any scheme of order two."""
    slow = {"duration": "58 ms", "thrust__peak": "6 kN"}
    slow |= {"thrust__width": "4 ms", "thrust__centre": "12 ms"}
    exit_at, mean, _ = straight(0.9, False, **slow)
    shorter_exit, shorter_mean, _ = straight(0.9, **slow)
    assert exit_at == pytest.approx(4.0 * shorter_exit, rel=0.1)
    assert mean == pytest.approx(4.0 * shorter_mean, rel=0.1)


@pytest.mark.parametrize("interval", ["0.1 ms", "25 ms"])
def test_a_jam_is_found_with_few_samples(interval):
    """5 ms after the thrust fell below 1 % of its peak the run ends, whatever is sampled."""
    found = highfi.run(tiny(thrust__peak="10 mN", output__interval=interval), COARSE)
    spent = 4.5e-3 + 1.5e-3 * np.sqrt(2.0 * np.log(100.0))
    assert found.status == "jammed" and found.outcome.exit_time is None
    # to the next check
    assert (
        0.0 <= found.cost["steps"] * found.cost["dt_s"] - (spent + 5e-3) < 250 * found.cost["dt_s"]
    )


@pytest.mark.parametrize("solve", [lambda scene: highfi.run(scene, COARSE), springs_of])
def test_a_payload_that_coasts_slowly_leaves(solve):
    """A push of 5 N gives it 2 mm/s, which no friction takes away. 0.1 mm before the exit it leaves after 50
    ms, in both models. Control: the same friction holds a payload that would be faster than 10 mm/s
    without (``scenes.test_ends``)."""
    asked = tiny(thrust__peak="5 N", thrust_offset="absent", duration="absent")
    asked = asked.replace({"initial.position.x": launch.of_scene(asked).way - 1e-4})
    push, masses = asked.thrust, (asked.payload.mass, asked.platform.mass)
    speed = push.peak * push.width * np.sqrt(2.0 * np.pi) * sum(1.0 / mass for mass in masses)
    found = solve(asked)
    # the cut of the pulse at three widths takes 0.3 % of the impulse
    assert found.outcome.exit_time == pytest.approx(push.centre + 1e-4 / speed, rel=4e-3)


class _StopAt:
    """In the place of a run's checkpoint: ends the run at the first check after a number of
    steps."""

    def __init__(self, steps: int):
        self.steps = steps

    def keep(self, loop) -> None:
        if loop.stepper.steps >= self.steps:
            raise Stopped


STOPS = [15_000, 33_250, 36_250]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """What is read from the checkpoints of one run that stops again and again, by steps."""
    loop, found = begun(tiny(output__interval="25 ms")), {}
    kept = Checkpoint(tmp_path_factory.mktemp("ending") / "run", 0.0, loop, COARSE)
    for steps in STOPS:
        with pytest.raises(Stopped):
            loop.integrate(None, _StopAt(steps))
        assert (
            len(loop.recorded.rows) == 1
            and loop.stepper.steps >= steps
            and loop.stepper.book[DONE] == np.inf
        )
        kept.write(loop)
        found[steps] = kept.read()
    return found


@pytest.mark.parametrize("steps", STOPS)
def test_a_resume_between_samples_goes_on_to_the_same_bits(written, steps):
    """Before the exit, and twice in the settled window, whose sums are in the file. Control:
    without them the means are others."""
    second, poor = (begun(tiny(output__interval="25 ms")) for _ in range(2))
    fresh = {"book": poor.stepper.book.copy()}
    restore(second, written[steps])
    restore(poor, written[steps] | fresh)
    results = []
    for loop in (second, poor) if steps >= 33_250 else (second,):
        loop.integrate(None)
        results.append(loop.trajectory(loop.setup.stepping.as_dict(), COARSE))
    assert_same(results[0], sampled_once())
    assert all(other.outcome != results[0].outcome for other in results[1:])
