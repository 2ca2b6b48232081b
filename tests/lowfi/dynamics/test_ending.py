"""Exit, settled means and jams of the surrogate: exact in free flight, and the same bits however a
run is sampled."""

import numpy as np
import pytest
import scipy.optimize
import scipy.special

from tests.exact import rigid
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import scene
from tipoff import lowfi
from tipoff.kernels import rotation
from tipoff.lowfi import Numerics
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.books import DONE
from tipoff.scenes import load

STEEL = {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33}
RAIL = {"start": -1.0, "end": 0.1, "material": STEEL}
# One pad, whose trailing edge is 0.1 m behind the mass centre and 0.1 m above it.
PAD = [{"position": (-0.092, 0.0, 0.1), "normals": ["+z"], "length": 0.016}]
FINE = Numerics(relative_tolerance=1e-11, speed_floor=1e-6)


def free(duration: float, interval: float, **tables):
    """A body on a fixed rail that nothing touches; all these scenes are of one kernel."""
    return scene(duration, interval, mass=10.0, pads=PAD, rail=RAIL, **tables)


def assert_same(found, expected) -> None:
    """Status, steps and every number of the outcome, bit for bit."""
    assert (found.status, found.cost["steps"]) == (expected.status, expected.cost["steps"])
    assert found.outcome == expected.outcome


@pytest.mark.case("X23")
@pytest.mark.parametrize(
    "condition, compliance", [("phi35", False), ("phi35", True)], ids=["springs", "compliant"]
)
def test_sampling_changes_no_bit(condition, compliance):
    """From six thousand samples to two, at an interval that divides nothing, and with no sample but
    the first in the flight."""
    asked, model, stand = (
        REFERENCE.condition(condition),
        *(("compliant", reference_compliance()) if compliance else ("springs", None)),
    )
    fine, *others = (
        lowfi.run(asked.replace({"output.interval": interval}), model, compliance=stand)
        for interval in ("0.01 ms", "5 ms", "29 ms", "0.73 ms", "58 ms")
    )
    assert fine.status == "exited"
    for other in others:
        assert other.time.size < 100
        assert_same(other, fine)


def test_an_ensemble_depends_on_no_interval_and_mixes_no_rows():
    """Rows that differ in the interval alone, or in other numbers too, have the results of single
    runs."""
    base = load("clamped")
    rows = [
        {"output.interval": 1e-4},
        {"output.interval": "29 ms"},
        {"output.interval": 5e-3},
        {"output.interval": 0.058},
        *(
            {"output.interval": interval, "thrust_offset.misalignment.radial": angle}
            for interval, angle in ((1e-3, 0.5), (0.02, 0.5), (0.03, 1.0))
        ),
    ]
    assert_rows_are_runs(base, rows)


@pytest.mark.parametrize(
    "key, values",
    [
        ("thrust.force", (300.0, 400.0, 500.0)),
        ("gravity.x", (-1.0, 2.0, 3.0)),
        ("thrust.duration", (0.02, 0.03, 0.04)),
    ],
)
def test_rows_with_records_of_their_own_are_not_mixed(key, values):
    """Numbers of a table of the scene are replaced in place from row to row."""
    base = free(0.6, 1e-3, thrust={"kind": "constant", "force": 200.0, "duration": 0.05})
    found = assert_rows_are_runs(base, [{key: value} for value in values])
    assert len(set(found.exit_time.values)) == len(values)


def assert_rows_are_runs(base, rows):
    found = lowfi.run_many(base, rows, "springs", workers=2)
    for index, row in enumerate(rows):
        alone, case = lowfi.run(base.replace(row), "springs"), found.isel(case=index)
        assert (str(case.status.values), int(case.steps)) == (
            alone.status,
            alone.cost["steps"],
        ) and alone.status == "exited"
        for name in columns.UNITS:
            assert np.array_equal(case[name].values, getattr(alone.outcome, name)), (row, name)
    return found


@pytest.mark.parametrize("force", [500.0, 4000.0])
def test_exit_under_a_constant_push(force):
    """x = F t^2 / 2 m, which the method integrates without error: 0.2 m to the last digits, at any
    tolerance."""
    exact = np.sqrt(2.0 * 0.2 * 10.0 / force)
    for interval in (1e-3, 0.0999, 0.1):
        run = lowfi.run(
            free(0.1, interval, thrust={"kind": "constant", "force": force, "duration": 0.2}),
            "springs",
        )
        assert run.outcome.exit_time == pytest.approx(exact, rel=1e-14)


def test_rates_at_exit_under_thrust():
    """A push off the centre turns a body at M t / I about z. So the mean over 0.2 ms is the rate 0.1
    ms after the exit. Control: the settled rate, after the push, is three times as large."""
    force, off, lasts = 4000.0, 1e-4, 0.1
    run = lowfi.run(
        free(
            0.2,
            0.05,
            thrust={"kind": "constant", "force": force, "duration": lasts},
            thrust_offset={"eccentricity": {"axial": off, "radial": np.pi / 2.0}},
        ),
        "springs",
        numerics=FINE,
    )
    turning = -force * off / run.scene["payload"]["inertia"]["zz"]
    at_exit = turning * (run.outcome.exit_time + 1e-4)
    assert run.outcome.exit_rate == pytest.approx([0.0, 0.0, at_exit], rel=1e-5, abs=1e-12)
    share = 1.0 - run.outcome.exit_time / lasts
    assert run.outcome.impulse_after_exit == pytest.approx(share, rel=1e-12)
    # Control:
    assert run.outcome.rate[2] == pytest.approx(turning * lasts, rel=1e-9)
    assert abs(run.outcome.rate[2] / at_exit) > 3.0


def pushed(tolerance: float, interval: float):
    """A Gaussian push that is near its peak at the exit and has fallen to 0.1 % when the window
    begins: relative errors of exit time and mean velocity."""
    width, centre, duration = 5e-3, 0.03, 0.06
    thrust = {"kind": "gaussian", "peak": 30e3, "width": width, "centre": centre}
    run = lowfi.run(
        free(duration, interval, thrust=thrust),
        "springs",
        numerics=Numerics(relative_tolerance=tolerance, speed_floor=1e-6),
    )
    assert run.status == "exited"
    root, rise = np.sqrt(2.0) * width, 3000.0 * width * np.sqrt(np.pi / 2.0)
    begin = scipy.special.erf(-centre / root)

    def speed(t):
        return rise * (scipy.special.erf((t - centre) / root) - begin)

    def place(t):
        def antiderivative(s):
            return s * scipy.special.erf(s / root) + root / np.sqrt(np.pi) * np.exp(
                -((s / root) ** 2)
            )

        return rise * (antiderivative(t - centre) - antiderivative(-centre) - begin * t)

    exit_at = scipy.optimize.brentq(lambda t: place(t) - 0.2, 0.0, duration, xtol=1e-16, rtol=1e-15)
    start = centre + width * np.sqrt(2.0 * np.log(1e3))
    # the push goes on in the window
    assert start > exit_at + 1e-3 and speed(start + 2e-3) - speed(start) > 1e-4
    found = run.outcome
    assert found.window_start == pytest.approx(start, rel=1e-12)
    assert found.exit_position[0] == pytest.approx(0.2, abs=1e-14)
    return abs(found.exit_time - exit_at) / exit_at, abs(
        found.velocity[0] / ((place(start + 2e-3) - place(start)) / 2e-3) - 1.0
    )


def test_errors_of_exit_and_means_are_below_the_tolerance():
    """Both errors are below the tolerance, and the same for any sampling. Samples 5 ms apart alone
    would give larger ones."""
    for tolerance in (1e-6, 1e-8, 1e-10):
        errors = pushed(tolerance, 5e-5)
        assert max(errors) < tolerance
        for interval in (7e-3, 0.05):
            assert pushed(tolerance, interval) == errors


def test_means_of_a_tumbling_body():
    """Rates of a free body are Jacobi's elliptic functions: here one that turns by 15 deg in the
    window, wobbling."""
    inertia, start = (0.3, 0.55, 0.6), (60.0, 0.0, 120.0)
    for tolerance in (1e-7, 1e-9, 1e-11):
        for interval in (1e-4, 0.06):
            tumbling = free(
                0.06, interval, initial={"velocity": {"x": 6.0}, "rate": dict(zip("xyz", start))}
            )
            run = lowfi.run(
                tumbling,
                "springs",
                numerics=Numerics(relative_tolerance=tolerance, speed_floor=1e-6),
            )
            begin = run.outcome.window_start
            time = begin + 1e-3 * (1.0 + np.polynomial.legendre.leggauss(20)[0])
            mean = (
                0.5
                * np.polynomial.legendre.leggauss(20)[1]
                @ rigid.free_rates(inertia, start, time)
            )
            error = np.abs(run.outcome.rate - mean).max() / np.linalg.norm(start)
            assert error < tolerance
    # Control: the rate at either end of the window is another by far.
    assert np.abs(rigid.free_rates(inertia, start, time[[0, -1]]) - mean).max() > 1.0


def test_exit_waits_for_a_pitched_trailing_edge():
    """Nose down by a: the edge at (-0.1, 0, 0.1) trails by 0.1 cos a + 0.1 sin |a|, so exit is
    later than when level."""
    for angle in (-0.05, 0.05):
        run = lowfi.run(
            free(0.1, 0.05, initial={"velocity": {"x": 5.0}, "attitude": {"y": angle}}), "springs"
        )
        trailing = 0.1 * np.cos(angle) - 0.1 * np.sin(angle)
        assert run.outcome.exit_time == pytest.approx((0.1 + trailing) / 5.0, rel=1e-14)
        assert run.outcome.exit_attitude == pytest.approx([0.0, angle, 0.0], abs=1e-14)


def test_exit_from_a_turning_platform():
    """The rail turns away under a payload that flies straight; exit is seen in the platform's
    axes."""
    rate, away = 3.0, {"x": -0.1, "y": 0.05, "z": 0.0}
    platform = {
        "mass": 50.0,
        "inertia": dict.fromkeys(("xx", "yy", "zz"), 4.0),
        "mass_centre": away,
    }
    asked = free(
        0.1,
        0.05,
        platform=platform,
        thrust={"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 1e-3},
        initial={"velocity": {"x": 5.0}, "platform_rate": {"z": rate}},
    )

    def past(t):
        turn = rotation.matrix(rotation.exponential((0.0, 0.0, rate * t)))
        edge = rotation.unrotate(turn, (5.0 * t - 0.1 + 0.1, -0.05, 0.1))
        return edge[0] - 0.2

    exact = scipy.optimize.brentq(past, 0.0, 0.1, xtol=1e-16, rtol=1e-15)
    assert abs(exact - 0.04) > 1e-4  # a rail that stays is left at another time
    run = lowfi.run(asked, "springs", numerics=FINE)
    assert run.outcome.exit_time == pytest.approx(exact, rel=1e-10)
    assert run.outcome.exit_platform_attitude == pytest.approx(
        [0.0, 0.0, rate * exact], rel=1e-9, abs=1e-12
    )
    assert run.outcome.exit_platform_rate == pytest.approx([0.0, 0.0, rate], abs=1e-12)
    assert run.outcome.exit_platform_position == pytest.approx(list(away.values()), abs=1e-12)


def test_beyond_the_rail_from_the_start():
    run = lowfi.run(
        free(0.01, 0.01, initial={"position": {"x": 0.3}, "velocity": {"x": 1.0, "y": 0.1}}),
        "springs",
    )
    assert (run.status, run.outcome.exit_time, run.outcome.window_start) == ("exited", 0.0, 1e-3)
    assert run.outcome.exit_position == [0.3, 0.0, 0.0]


@pytest.mark.parametrize("height, leaves", [(1e-6, True), (-1e-6, False)])
def test_a_payload_that_comes_back_has_left(height, leaves):
    """Thrown up along the rail it turns just beyond its end, or just before. The flight is one
    parabola and takes few long steps; above 1 um it is beyond for 1.8 ms, longer than a piece of a
    step."""
    speed = 2.0
    fall = {"x": -(speed**2) / (2.0 * (0.2 + height)), "y": 0.0, "z": 0.0}
    run = lowfi.run(free(0.3, 0.3, initial={"velocity": {"x": speed}}, gravity=fall), "springs")
    assert (run.outcome.exit_time is not None) == leaves and run.cost["steps"] < 30
    if leaves:
        exact = (speed - np.sqrt(speed**2 + 2.0 * fall["x"] * 0.2)) / -fall["x"]
        assert run.outcome.exit_time == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("fall, jams", [(3.9, True), (4.1, False)])
@pytest.mark.parametrize("interval", [1e-4, 0.05, 0.25])
def test_jam_on_both_sides_of_its_duration(fall, jams, interval):
    """A payload that turns back is slower than 10 mm/s for 20 mm/s over g: 5.13 ms or 4.88 ms; it
    is jammed at 5 ms, if 10 mm/s is its jam speed. Control: nothing but its weight holds it, and then it is
    never jammed."""
    speed, slow = 0.5, 0.01
    asked = free(
        0.25, interval, initial={"velocity": {"x": speed}}, gravity={"x": -fall, "y": 0.0, "z": 0.0}
    )
    assert lowfi.run(asked, "springs").status == "time_limit"
    run = SingleRun(asked, Numerics())
    run.marks = run.marks._replace(jam_speed=slow)
    run.begin()
    run.integrate(None)
    assert run.judged()[0] == ("jammed" if jams else "time_limit")
    assert not jams or run.loop.book[DONE] == pytest.approx((speed - slow) / fall + 5e-3, rel=1e-12)


@pytest.mark.parametrize("interval", ["0.05 ms", "29 ms"])
def test_a_jam_is_found_with_few_samples(interval):
    """A push of 50 mN hardly moves the reference's payload; in an ensemble too."""
    asked = REFERENCE.condition("phi15").replace({"thrust.peak": 0.05})
    seen, case = [], lowfi.run_many(asked, [{"output.interval": interval}], "springs")
    run = lowfi.run(asked.replace({"output.interval": interval}), "springs", progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0
    assert (
        run.status == "jammed" == str(case.status.values[0])
        and int(case.steps.values[0]) == run.cost["steps"]
    )
    # 5 ms after the thrust fell below 1 % of its peak, at 24 ms, and not at the scene's end
    assert run.time[-1] < 0.045
