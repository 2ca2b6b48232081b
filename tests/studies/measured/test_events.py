"""Release and ignition in closed-form drops across levels of noise, with knocks that a plain
threshold falls for."""

import numpy as np
import pytest

from tests.studies.measured.synthetic import (
    BURN,
    END,
    IGNITION,
    INTERVAL,
    RELEASE,
    caught,
    motion,
    sheet,
)
from tipoff.studies.measured import analysis, events
from tipoff.studies.measured.events import GRAVITY
from tipoff.studies.measured.log import Calibrated, Log, runs


def knocked(noise, seed):
    """A hoist that jerks (10 ms of almost no load), a latch that knocks along X harder than thrust
    begins, and noise (m/s2)."""
    time, rate, force = motion([0.0] * 3, [0.1, 0.0, 0.0])
    jerk = (time > 0.4) & (time < 0.41)
    force[jerk, 2] = 1.0
    latch = (time >= RELEASE + 0.1) & (time < RELEASE + 0.103)
    force[latch, 0] += 40.0
    return Calibrated(
        time, rate, force + noise * np.random.default_rng(seed).standard_normal(force.shape), None
    )


def naive(found):
    """The first sample below g/2, and the first after it that is pushed by 3 m/s2."""
    release = int(np.argmax(np.linalg.norm(found.force, axis=1) < 0.5 * GRAVITY))
    return found.time[release], found.time[release + int(np.argmax(found.force[release:, 0] > 3.0))]


@pytest.mark.parametrize("noise, close", [(0.0, 1), (0.05, 1), (0.5, 1), (2.0, 2)])
def test_release_and_ignition_are_found_to_the_sample(noise, close):
    """The thrust rises as a half sine, so that six standard deviations are felt asin(6 noise / 300)
    / pi of it late."""
    late = BURN / np.pi * np.arcsin(max(6.0 * noise, 1.0) / 300.0)
    for seed in range(10):
        found = knocked(noise, seed)
        seen = events.find(sheet(), found, "test")
        assert abs(seen.release - RELEASE) <= (close + 0.5) * INTERVAL
        assert -1.5 * INTERVAL <= seen.ignition - IGNITION <= late + 2.5 * INTERVAL
        release, ignition = naive(found)
        # the control falls for the jerk and the latch, or for noise
        assert release < RELEASE - 0.1 and ignition < IGNITION - 0.1


def with_catch(noise, seed):
    """A drop that ends in a net, with noise (m/s2)."""
    time, rate, force = caught(*motion([0.0] * 3, [0.1, 0.0, 0.0]))
    return Calibrated(
        time, rate, force + noise * np.random.default_rng(seed).standard_normal(force.shape), None
    )


def largest_push(found):
    """Where the push along +X of the largest impulse after release begins."""
    stretches = [run for run in runs(found.force[:, 0] > 3.0) if found.time[run[0]] > RELEASE]
    return found.time[max(stretches, key=lambda run: found.force[run[0] : run[1], 0].sum())[0]]


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.4])
def test_a_catch_is_not_taken_for_ignition(noise):
    """Its impulse along +X is twice that of the burn. Control: by the largest impulse it would be
    ignition, and the window of free fall would hold the burn."""
    found = with_catch(noise, 1)
    seen = events.find(sheet(), found, "test")
    assert seen.release == pytest.approx(RELEASE, abs=1.5 * INTERVAL)
    assert seen.ignition == pytest.approx(IGNITION, abs=3.5 * INTERVAL)
    assert len(seen.later) == 1 and seen.later[0] == pytest.approx(END, abs=0.03)
    wrong = largest_push(found)
    assert wrong > END - INTERVAL
    spanned = events.spans(sheet(), found, seen._replace(ignition=wrong), "test").reference
    assert spanned[0] < IGNITION and spanned[1] > IGNITION + BURN
    assert events.find(sheet(), knocked(noise, 1), "test").later == ()  # a latch is no catch


def test_the_change_of_rate_does_not_know_of_the_catch():
    """To the last digit that of the log without it; that something else pushed is said."""
    after = [0.1, -0.05, 0.02]
    plain, longer = motion([0.0] * 3, after), caught(*motion([0.0] * 3, after))
    first, second = (analysis.drop_of(sheet(), _log(*drop), "test") for drop in (plain, longer))
    np.testing.assert_allclose(second.reduced.change, first.reduced.change, atol=1e-12)
    assert any("taken for the catch" in note for note in second.notes)
    assert not any("catch" in note for note in first.notes)


def _log(time, rate, force):
    nothing = np.zeros(time.size, dtype=bool)
    return Log(time, rate, force, None, nothing, nothing, [])


def test_windows_keep_clear_of_what_stirs():
    ask = sheet()
    spans = events.spans(ask, knocked(0.0, 0), events.Events(RELEASE, IGNITION, True), "test")
    assert (
        spans.rest[1]
        < RELEASE
        < spans.reference[0]
        < spans.reference[1]
        < IGNITION
        < spans.settled[0]
        < spans.settled[1]
    )
    assert spans.instant == pytest.approx(IGNITION + ask.windows.exit + 2e-3)
