"""The two-step law of friction: its values, its continuity on both sides of each transition, its
sign."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tipoff.mechanics.laws.friction import Friction, coefficient_over_speed

LAW = Friction(0.3, 0.1, 0.01, 0.02)
# Zero or a coefficient some surface may have: below 1e-300 a relative tolerance means nothing.
COEFFICIENT = st.just(0.0) | st.floats(1e-6, 2.0)
SPEED = st.floats(1e-4, 1.0)


def steepest_slope(friction):
    """Largest d(mu)/ds (s/m)."""
    rise = friction.static / friction.static_speed
    fall = abs(friction.dynamic - friction.static) / (
        friction.dynamic_speed - friction.static_speed
    )
    return 1.5 * max(rise, fall)


def coefficient(law, speed):
    return coefficient_over_speed(law, speed) * speed


@st.composite
def laws(draw):
    static_speed = draw(SPEED)
    return Friction(
        draw(COEFFICIENT),
        draw(COEFFICIENT),
        static_speed,
        static_speed * draw(st.floats(1.01, 10.0)),
    )


def test_values():
    """At half the static speed the cubic (3 r - r^3) / 2 is 11/16; half-way between the speeds the
    step is half done."""
    assert coefficient(LAW, 0.005) == pytest.approx(0.3 * 11 / 16, rel=1e-14)
    assert coefficient(LAW, 0.01) == pytest.approx(0.3, rel=1e-14)
    assert coefficient(LAW, 0.015) == pytest.approx(0.2, rel=1e-14)
    assert coefficient(LAW, 0.02) == pytest.approx(0.1, rel=1e-14)
    assert coefficient(LAW, 7.0) == pytest.approx(0.1, rel=1e-14)


def test_the_first_branch_is_the_odd_cubic_step():
    """The step of ADAMS from -mu at -v to mu at v, written independently: -mu + 2 mu x^2 (3 - 2 x),
    x = (s + v)/(2 v)."""
    speed = np.linspace(1e-9, LAW.static_speed, 101)
    x = (speed + LAW.static_speed) / (2.0 * LAW.static_speed)
    step = -LAW.static + 2.0 * LAW.static * x * x * (3.0 - 2.0 * x)
    assert np.allclose([coefficient(LAW, s) for s in speed], step, rtol=0.0, atol=1e-15)


def test_at_rest_it_is_finite_and_needs_no_direction():
    assert coefficient_over_speed(LAW, 0.0) == pytest.approx(1.5 * 0.3 / 0.01, rel=1e-15)


@settings(deadline=None)
@given(laws())
def test_continuous_at_both_transitions(law):
    """Over a gap of 1e-9 of the speed the value moves by no more than the steepest slope allows."""
    for speed in (law.static_speed, law.dynamic_speed):
        below, above = (coefficient(law, speed * (1.0 + side * 1e-9)) for side in (-1.0, 1.0))
        assert abs(above - below) <= 2e-9 * speed * steepest_slope(law) + 1e-14


@settings(deadline=None)
@given(laws(), st.floats(0.0, 10.0))
def test_never_negative_never_above_the_larger_coefficient(law, speed):
    value = coefficient(law, speed)
    assert 0.0 <= value <= max(law.static, law.dynamic) * (1.0 + 1e-14)


@settings(deadline=None)
@given(laws())
def test_steepest_slope_bounds_the_law(law):
    speed = np.linspace(0.0, 1.2 * law.dynamic_speed, 400)
    values = np.array([coefficient(law, s) for s in speed])
    assert (
        np.abs(np.diff(values)).max() / np.diff(speed)[0]
        <= steepest_slope(law) * (1.0 + 1e-9) + 1e-12
    )


def test_a_plain_sign_law_jumps():
    """Control: mu sign(v) jumps by 2 mu across rest, where the law above moves by 3 mu v / v_s."""
    step = 1e-9
    assert 2.0 * coefficient(LAW, step) < 1e-6 < LAW.static * (np.sign(step) - np.sign(-step))
