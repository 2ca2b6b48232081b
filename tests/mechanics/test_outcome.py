"""Relative motion, milestones, and the book of exit, settled window and jam by itself; runs that
fill it are tested with the solvers."""

import itertools
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.scenes.support import motion
from tipoff.mechanics import books, outcome
from tipoff.scenes import launch, load, scene_model


def quaternions(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat(scalar_first=True)


def book() -> np.ndarray:
    found = np.zeros(books.BOOK_SIZE)
    books.reset(found)
    return found


def marks(settled=0.0, spent=0.0, constant=False) -> outcome.Milestones:
    return outcome.Milestones(settled, spent, 0.01, constant)


def test_an_empty_book_is_a_time_limit():
    assert books.found(book()) == ("time_limit", outcome.Outcome())


@pytest.mark.parametrize("settled, start", [(0.0, 0.041), (0.0409, 0.041), (0.0437, 0.0437)])
@pytest.mark.parametrize("rows", [1, 7])
def test_means_over_the_windows(settled, start, rows):
    """Steps that begin before a window and end after it count with the part inside. Each part's
    length is off by the rounding of the instants, 7e-18 s, of 2 ms."""
    made, time = book(), np.linspace(0.039, 0.047, 8 * rows + 1)
    books.leave(made, 0.04, marks(settled))
    for began, ended in itertools.pairwise(time):
        for window in (books.LEAVING, books.SETTLED):
            low, high = books.part_in(made, window, began, ended)
            if high > low:
                middle = 0.5 * (low + high)  # of linear motion the mean is the value there
                row = np.zeros(books.ROW_SIZE)
                row[books.SPEED : books.SPEED + 3] = [5.0, 0.3 * middle, -0.4 * middle]
                row[books.SPIN : books.SPIN + 3] = [1.0, 2.0, middle]
                books.count(made, window, row, high - low)
        assert books.found(made)[0] == "time_limit" and books.found(made)[1].exit_time == 0.04
        books.close(made, ended)
        if made[books.DONE] < np.inf:
            break
    made[[books.AT_EXIT + books.ATTITUDE, books.AT_EXIT + books.BODY + books.ATTITUDE]] = 1.0
    status, found = books.found(made)
    assert status == "exited" and found.window_start == start and made[books.DONE] == start + 2e-3
    assert found.velocity == pytest.approx(
        [5.0, 0.3 * (start + 1e-3), -0.4 * (start + 1e-3)], abs=3e-13
    )
    assert found.rate == pytest.approx([1.0, 2.0, start + 1e-3], abs=3e-13)
    assert found.exit_velocity == pytest.approx([5.0, 0.3 * 0.0401, -0.4 * 0.0401], abs=3e-13)
    assert found.exit_rate == pytest.approx([1.0, 2.0, 0.0401], abs=3e-12)
    assert found.lateral_velocity == pytest.approx(0.5 * (start + 1e-3), abs=3e-13)
    assert found.direction_error == pytest.approx(math.atan2(0.5 * (start + 1e-3), 5.0), abs=3e-13)


def test_a_window_that_ends_with_the_scene_is_whole():
    """The last step may end a little earlier, by rounding. Control: a nanosecond is more than
    rounding."""
    for short, status in ((1e-16, "exited"), (1e-9, "time_limit")):
        made = book()
        books.leave(made, 0.04, marks())
        books.close(made, 0.043 - short)
        made[[books.AT_EXIT + books.ATTITUDE, books.AT_EXIT + books.BODY + books.ATTITUDE]] = 1.0
        assert books.found(made)[0] == status


def test_the_values_at_exit_need_their_window_only():
    """A run that ends before it says so, and one that never leaves."""
    for until, known in ((0.0401, False), (0.0402, True)):
        made = book()
        books.leave(made, 0.04, marks())
        books.close(made, until)
        status, found = books.found(made)
        assert status == "time_limit" and (found.exit_rate is not None) == known
        words = outcome.no_exit_values(status, found)
        assert words == ("" if known else "the run ended less than 0.2 ms after the exit")
    words = outcome.no_exit_values("jammed", outcome.Outcome())
    assert words == "the payload did not leave the rail: jammed"


def test_the_share_of_the_impulse_after_the_exit():
    """Half of a push whose middle is the exit; none of springs; none stated without a thrust."""
    left = outcome.Outcome(exit_time=0.01)

    def share(**thrust) -> float | None:
        scene = load("tiny").replace({"thrust": thrust})
        return outcome.with_impulse(left, scene_model.build(scene)).impulse_after_exit

    assert share(kind="constant", force=10.0, duration=0.04) == pytest.approx(0.75, rel=1e-14)
    assert share(kind="gaussian", peak=10.0, width=1e-3, centre=0.01) == pytest.approx(
        0.5, rel=1e-12
    )
    assert share(kind="constant", force=10.0, duration=0.01) == 0.0
    assert share(kind="spring", preload=1e3, rate=1e3, stroke=0.1) == 0.0
    assert share(kind="constant", force=0.0, duration=0.04) is None


@pytest.mark.parametrize(
    "vector",
    [[0.0, 0.0, 0.0], [1e-9, 0.0, 0.0], [0.02, -0.03, 0.01], [0.0, 3.0, 0.0], [2.0, -2.0, 1.0]],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_exit_attitude(vector, sign):
    """Both signs of a quaternion are the same attitude."""
    made = book()
    books.leave(made, 0.04, marks())
    books.close(made, 1.0)
    for body in (0, books.BODY):
        first = books.AT_EXIT + body + books.ATTITUDE
        made[first : first + 4] = sign * quaternions(Rotation.from_rotvec(vector))
    found = books.found(made)[1]
    assert found.exit_attitude == found.exit_platform_attitude == pytest.approx(vector, abs=1e-12)


def looked_at(*looks) -> np.ndarray:
    """The book after looks, each an excess of the speed (m/s), its time (s) and when it was zero
    since the look before (s)."""
    made = book()
    for look in looks:
        if made[books.DONE] == np.inf:
            books.look_at_speed(made, *look)
    return made


@pytest.mark.parametrize(
    "looks, jammed_at",
    [
        ([(-1e-9, 0.01, 0.01), (-1e-9, 0.01501, 0.01501)], 0.015),
        ([(-1e-9, 0.01, 0.01), (-1e-9, 0.01499, 0.01499)], None),
        ([(1e-9, 0.01, 0.01), (1e-9, 0.02, 0.02)], None),
        ([(1.0, 0.01, 0.01), (-1.0, 0.02, 0.0151)], None),
        ([(1.0, 0.01, 0.01), (-1.0, 0.02, 0.0149)], 0.0199),
        ([(-1.0, 0.01, 0.01), (1.0, 0.02, 0.0151)], 0.015),
        ([(-1.0, 0.01, 0.01), (1.0, 0.02, 0.0149)], None),
        (
            [(-1.0, 0.01, 0.01), (1.0, 0.014, 0.013), (-1.0, 0.016, 0.015), (-1.0, 0.0199, 0.0199)],
            None,
        ),
    ],
)
def test_a_jam_lasts_five_milliseconds(looks, jammed_at):
    """On both sides of the duration, from its first moment or from a crossing, to the next crossing
    or without one; a faster moment in between begins it anew."""
    made = looked_at(*looks)
    assert books.found(made)[0] == ("time_limit" if jammed_at is None else "jammed")
    assert jammed_at is None or made[books.DONE] == pytest.approx(jammed_at, abs=1e-15)


def test_a_jam_counts_from_the_end_of_the_thrust_or_under_a_constant_one():
    assert books.watched_from(marks(spent=0.03)) == 0.03
    assert books.watched_from(marks(spent=0.03, constant=True)) == 0.0


def test_relative_motion_with_a_turning_platform():
    """Built the other way round: choose the motion in the platform's axes, carry it into the
    inertial frame."""
    rng = np.random.default_rng(4)
    n = 200
    frame, body = Rotation.random(n, rng=rng), Rotation.random(n, rng=rng)
    origin, drift, place, speed, spin, turning = (rng.normal(size=(n, 3)) for _ in range(6))
    inertial_spin = frame.apply(spin)
    moved = motion(
        origin + frame.apply(place),
        drift + frame.apply(speed) + np.cross(inertial_spin, frame.apply(place)),
        quaternions(body),
        body.inv().apply(inertial_spin) + turning,
        time=np.arange(n) * 1e-3,
        platform_position=origin,
        platform_velocity=drift,
        platform_quaternion=quaternions(frame),
        platform_rate=spin,
    )
    found = outcome.relative_motion(moved)
    assert np.allclose(found["relative_position"], place, atol=1e-13)
    assert np.allclose(found["relative_velocity"], speed, atol=1e-13)
    assert np.allclose(found["relative_rate"], turning, atol=1e-13)


def test_milestones_of_the_reference():
    scene = load("reference")
    found = outcome.milestones(launch.of_scene(scene), scene.time_limit)
    assert found.settled_thrust == pytest.approx(
        0.012 + 0.004 * math.sqrt(2.0 * math.log(1e3)), abs=5e-6
    )
    assert found.spent_thrust == pytest.approx(
        0.012 + 0.004 * math.sqrt(2.0 * math.log(1e2)), abs=5e-6
    )
    assert found.jam_speed == 0.01
    assert not found.constant_thrust


def test_a_body_force_has_time_to_set_a_payload_in_motion_before_it_counts_as_jammed():
    """From rest on fixed rails, g along them reaches twice the jam speed after 2 v / g. Control: under a
    pull across or backwards, on a free platform that falls too, or once in motion, it is the thrust
    alone that counts."""
    pull = 0.05  # m/s2: slower than the duration of a jam
    resting = load("reference").replace(
        {
            "platform": None,
            "friction": None,
            "thrust": {"kind": "constant", "force": 0.0, "duration": 1e-3},
            "thrust_offset": None,
            "duration": None,
        }
    )

    def spent(**changes) -> float:
        scene = resting.replace(changes)
        return outcome.milestones(launch.of_scene(scene), scene.time_limit).spent_thrust

    assert spent(gravity={"x": pull}) == pytest.approx(2.0 * 0.01 / pull, rel=1e-9)
    # Control:
    moving = {"velocity": {"x": 0.5}}
    for others in (
        {"gravity": {"y": pull}},
        {"gravity": {"x": -pull}},
        {"gravity": {"x": pull}, "initial": moving},
        {"gravity": {"x": pull}, "platform": load("reference").resolved()["platform"]},
    ):
        assert spent(**others) <= 1e-3
