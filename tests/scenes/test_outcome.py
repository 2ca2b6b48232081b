"""Exit, settled means and jams of motions whose answer is known."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenes import load, model, outcome
from tests.scenes.support import marks, motion

TIME = np.arange(0.0, 0.0601, 5e-5)


def quaternions(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat(scalar_first=True)


def straight(speed, time=TIME, **parts):
    """Constant velocity along X from the origin."""
    zeros = np.zeros_like(time)
    return motion(np.column_stack([speed * time, zeros, zeros]), np.column_stack([np.full_like(time, speed), zeros, zeros]),
                  time=time, **parts)


@pytest.mark.parametrize("speed", [4.0, 5.000001, 7.3, 19.99])
def test_exit_of_constant_velocity(speed):
    """The trailing edge, 0.1 m behind the mass centre, passes the rail end at 0.1 m after 0.2 m of travel."""
    found = outcome.exit_time(straight(speed), marks())
    assert found == pytest.approx(0.2 / speed, abs=1e-9)


def test_the_nearest_sample_would_miss_by_more():
    """Control: the first sample beyond the rail end, the usual answer, is off by up to one interval."""
    past = outcome.clearance_to_exit(straight(7.3), marks())
    assert abs(TIME[np.argmax(past > 0.0)] - 0.2 / 7.3) > 1e-6


def test_exit_while_accelerating_converges_with_the_fourth_power():
    """The local cubic leaves an error of interval^4; the largest over many rail ends, so that no lucky place decides."""
    ends = np.linspace(0.05, 0.3, 60)
    errors = []
    for interval in (4e-3, 2e-3, 1e-3):
        time = np.arange(0.0, 0.0601, interval)
        moved = motion(np.column_stack([0.5 * np.sin(30.0 * time) ** 2, 0 * time, 0 * time]), time=time)
        exact = np.arcsin(np.sqrt((0.1 + ends) / 0.5)) / 30.0
        errors.append(max(abs(outcome.exit_time(moved, marks(rail_end=end)) - at) for end, at in zip(ends, exact)))
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (np.abs(rates - 4.0) < 0.5).all()
    assert errors[-1] < 1e-7


def test_exit_follows_a_turning_platform():
    """Platform and payload turn together as one: seen from the rail the payload goes straight."""
    spin = 3.0
    turn = Rotation.from_rotvec(np.column_stack([0 * TIME, 0 * TIME, spin * TIME]))
    along = np.column_stack([5.0 * TIME, 0 * TIME, 0 * TIME])
    moved = motion(turn.apply(along), quaternion=quaternions(turn), platform_quaternion=quaternions(turn), time=TIME)
    assert outcome.exit_time(moved, marks()) == pytest.approx(0.04, abs=1e-9)


def test_exit_waits_for_a_pitched_trailing_edge():
    """Nose down by a: the edge at (-0.1, ., 0.1) trails by 0.1 cos a + 0.1 sin |a|, so exit is later than when level."""
    angle = -0.05
    turn = np.tile(quaternions(Rotation.from_rotvec([0.0, angle, 0.0])), (TIME.size, 1))
    trailing = 0.1 * math.cos(angle) - 0.1 * math.sin(angle)
    assert outcome.exit_time(straight(5.0, quaternion=turn), marks()) == pytest.approx((0.1 + trailing) / 5.0, abs=1e-9)


def test_a_payload_that_stays_has_no_exit():
    assert outcome.exit_time(straight(1.0), marks()) is None
    status, found = outcome.judge(straight(1.0), marks())
    assert (status, found) == ("time_limit", outcome.Outcome())


def test_beyond_the_rail_from_the_start():
    zeros = np.zeros_like(TIME)
    assert outcome.exit_time(motion(np.column_stack([1.0 + TIME, zeros, zeros]), time=TIME), marks()) == 0.0


def settling(settled_thrust=0.0, time=TIME):
    """Exit at 0.04 s; rates and velocity linear in time, whose mean over a window is the value in its middle."""
    rate = np.column_stack([1.0 + 2.0 * time, -3.0 * time, 0.5 - time])
    velocity = np.column_stack([np.full_like(time, 5.0), 0.3 * time, -0.4 * time])
    position = np.column_stack([5.0 * time, 0 * time, 0 * time])
    return outcome.judge(motion(position, velocity, rate=rate, time=time), marks(settled=settled_thrust))


@pytest.mark.parametrize("settled_thrust, start", [(0.0, 0.041), (0.0405, 0.041), (0.0437, 0.0437), (0.05, 0.05)])
def test_settled_means_are_exact_for_linear_rates(settled_thrust, start):
    status, found = settling(settled_thrust)
    middle = start + 1e-3
    assert status == "exited"
    assert found.window_start == pytest.approx(start, abs=1e-9)
    assert found.rate == pytest.approx([1.0 + 2.0 * middle, -3.0 * middle, 0.5 - middle], abs=1e-9)
    assert found.velocity == pytest.approx([5.0, 0.3 * middle, -0.4 * middle], abs=1e-9)
    assert found.lateral_velocity == pytest.approx(0.5 * middle, abs=1e-9)
    assert found.direction_error == pytest.approx(math.atan2(0.5 * middle, 5.0), abs=1e-10)


def test_a_scene_that_ends_inside_the_window_has_no_settled_rate():
    assert settling(time=TIME[TIME <= 0.0431])[0] == "exited"
    status, found = settling(time=TIME[TIME <= 0.0429])
    assert status == "time_limit"
    assert found == outcome.Outcome(exit_time=found.exit_time) and found.exit_time == pytest.approx(0.04, abs=1e-9)


@pytest.mark.parametrize("vector", [[0.0, 0.0, 0.0], [1e-9, 0.0, 0.0], [0.02, -0.03, 0.01], [0.0, 3.0, 0.0], [2.0, -2.0, 1.0]])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_exit_attitude(vector, sign):
    """Both signs of a quaternion are the same attitude."""
    turn = sign * np.tile(quaternions(Rotation.from_rotvec(vector)), (TIME.size, 1))
    zeros = np.zeros_like(TIME)
    moved = motion(np.column_stack([20.0 * TIME, zeros, zeros]), quaternion=turn, time=TIME)
    assert outcome.judge(moved, marks())[1].exit_attitude == pytest.approx(vector, abs=1e-12)


def resting(speeds):
    zeros = np.zeros_like(TIME)
    return motion(np.zeros((TIME.size, 3)), np.column_stack([speeds, zeros, zeros]), time=TIME)


@pytest.mark.parametrize("speed, spent, constant, jammed", [
    (0.0099, 0.03, False, True), (-0.0099, 0.03, False, True), (0.0101, 0.03, False, False), (-0.0101, 0.03, False, False),
    (0.0, 0.0549, False, True), (0.0, 0.0551, False, False), (0.0, 0.0551, True, True),
])
def test_jam_on_both_sides_of_its_thresholds(speed, spent, constant, jammed):
    """Slow for the last 5 ms, which must lie after the thrust is spent unless the thrust is constant."""
    moved, limits = resting(np.full_like(TIME, speed)), marks(spent=spent, constant=constant)
    assert outcome.is_jammed(moved, limits) == jammed
    assert outcome.judge(moved, limits)[0] == ("jammed" if jammed else "time_limit")


@pytest.mark.parametrize("stopped_for, jammed", [(5.1e-3, True), (4.9e-3, False)])
def test_a_jam_lasts_five_milliseconds(stopped_for, jammed):
    assert outcome.is_jammed(resting(np.where(TIME > TIME[-1] - stopped_for, 0.0, 1.0)), marks(spent=0.01)) == jammed


def test_a_payload_that_rides_on_a_moving_platform_is_jammed():
    """The axial speed that counts is relative to the platform."""
    speeds = np.column_stack([np.full_like(TIME, 2.0), 0 * TIME, 0 * TIME])
    places = np.column_stack([2.0 * TIME, 0 * TIME, 0 * TIME])
    moved = motion(places, speeds, time=TIME, platform_position=places, platform_velocity=speeds)
    assert outcome.is_jammed(moved, marks(spent=0.01))


def test_relative_motion_with_a_turning_platform():
    """Built the other way round: choose the motion in the platform's axes, carry it into the inertial frame."""
    rng = np.random.default_rng(4)
    n = 200
    frame, body = Rotation.random(n, rng=rng), Rotation.random(n, rng=rng)
    origin, drift, place, speed, spin, turning = (rng.normal(size=(n, 3)) for _ in range(6))
    inertial_spin = frame.apply(spin)
    moved = motion(
        origin + frame.apply(place), drift + frame.apply(speed) + np.cross(inertial_spin, frame.apply(place)), quaternions(body),
        body.inv().apply(inertial_spin) + turning, time=np.arange(n) * 1e-3, platform_position=origin, platform_velocity=drift,
        platform_quaternion=quaternions(frame), platform_rate=spin)
    found = outcome.relative_motion(moved)
    assert np.allclose(found["relative_position"], place, atol=1e-13)
    assert np.allclose(found["relative_velocity"], speed, atol=1e-13)
    assert np.allclose(found["relative_rate"], turning, atol=1e-13)


def test_milestones_of_the_reference():
    scene = load("reference")
    found = outcome.milestones(scene, model.build(scene))
    assert found.settled_thrust == pytest.approx(0.012 + 0.004 * math.sqrt(2.0 * math.log(1e3)), abs=5e-6)
    assert found.spent_thrust == pytest.approx(0.012 + 0.004 * math.sqrt(2.0 * math.log(1e2)), abs=5e-6)
    assert found.jam_speed == 0.01
    assert found.edges[:, 0].min() == pytest.approx(-0.088)
    assert not found.constant_thrust
