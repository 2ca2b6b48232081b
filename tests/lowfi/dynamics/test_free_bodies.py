"""A body without contact: free rotation, body-fixed thrust, impulses, recoil. All against closed
forms, at two tolerances."""

import math

import numpy as np
import pytest

from tests.exact import rigid as exact
from tests.exact.thrust import kept_by_cut
from tests.lowfi.support import numerics, scene
from tipoff import lowfi, scenes
from tipoff.kernels import rotation


def spin(inertia: tuple, rate: tuple, duration: float, tolerance: float, interval: float = 0.01):
    """A free body with principal ``inertia`` (kg m2) started at ``rate`` (rad/s, body axes)."""
    return lowfi.run(
        scene(
            duration,
            interval,
            inertia=dict(zip(("xx", "yy", "zz"), inertia)),
            initial={"velocity": {"x": 1.0}, "rate": dict(zip("xyz", rate))},
        ),
        "springs",
        numerics=numerics(tolerance),
    )


def euler_rates(inertia: tuple, start: tuple, step: float, count: int) -> np.ndarray:
    """Control: rates (count + 1, 3) of the free body by explicit Euler on I w' = -w x I w."""
    rates = [np.array(start)]
    for _ in range(count):
        w = rates[-1]
        rates.append(w + step * np.cross(inertia * w, w) / inertia)
    return np.array(rates)


@pytest.mark.case("O34")
@pytest.mark.parametrize("tolerance, error", [(1e-9, 1e-6), (1e-12, 1e-8)])
def test_free_rotation(tolerance, error):
    """Jacobi's elliptic functions: (w1 cn, w2 sn, w3 dn)."""
    inertia, start = (0.30, 0.55, 0.80), (0.5, 0.0, 2.0)
    run = spin(inertia, start, 10.0, tolerance)
    assert exact.free_period(inertia, start) == pytest.approx(3.630847518, abs=1e-9)
    assert run.rate == pytest.approx(exact.free_rates(inertia, start, run.time), abs=error)
    assert run.rate[-1] == pytest.approx([0.0130461144, -0.5220551683, 1.9764396842], abs=error)
    q = run.quaternion[-1] * -np.sign(run.quaternion[-1, 0])
    assert q == pytest.approx([-0.7685141217, 0.0384838400, 0.0223194370, -0.6382843266], abs=error)
    assert abs(np.linalg.norm(run.quaternion, axis=1) - 1.0).max() <= 1e-12
    # Control: explicit Euler at a millisecond a step is off by a thousand times the looser
    # tolerance.
    assert abs(euler_rates(inertia, start, 1e-3, 10000)[-1] - run.rate[-1]).max() > 1e-3
    if tolerance == 1e-12:
        momentum = np.linalg.norm(run.rate * inertia, axis=1)
        energy = 0.5 * (run.rate**2 * inertia).sum(axis=1)
        assert abs(momentum / momentum[0] - 1.0).max() <= 1e-10
        assert abs(energy / energy[0] - 1.0).max() <= 1e-10


@pytest.mark.case("O35")
@pytest.mark.parametrize("tolerance", [1e-9, 1e-11])
def test_flip_about_the_middle_axis(tolerance):
    """First zero of w2 at K(m) / lambda, then every 2 K(m) / lambda."""
    inertia, start = (0.30, 0.55, 0.80), (0.0, 5.0, 0.005)
    run = spin(inertia, start, 16.0, tolerance, 0.002)
    middle = run.rate[:, 1]
    first = np.flatnonzero(np.signbit(middle[:-1]) != np.signbit(middle[1:]))
    zeros = run.time[first] - middle[first] * (run.time[1] - run.time[0]) / (
        middle[first + 1] - middle[first]
    )
    quarter, half = exact.flip_times(inertia, start)
    assert (quarter, half) == pytest.approx((3.041335, 6.082670), abs=1e-6)
    assert zeros == pytest.approx(quarter + half * np.arange(3), abs=1e-5)
    # Control: explicit Euler at the sampling step is late by a hundred times the tolerance.
    late = euler_rates(inertia, start, 0.002, 8000)[:, 1]
    passed = 0.002 * np.flatnonzero(late[:-1] * late[1:] < 0.0)
    assert abs(passed[1] - quarter - half) > 1e-3


@pytest.mark.case("O36")
@pytest.mark.parametrize("tolerance", [1e-10, 1e-12])
def test_axisymmetric_precession(tolerance):
    """Body rate (Ia - It) w / It, space rate H / It, cone atan(It w_t / (Ia w))."""
    body, space, cone = exact.axisymmetric(0.3, 0.6, 4.0, 0.2)
    run = spin((0.3, 0.6, 0.6), (4.0, 0.2, 0.0), 3.0, tolerance)
    assert run.rate[:, 1] + 1j * run.rate[:, 2] == pytest.approx(
        0.2 * np.exp(1j * body * run.time), abs=1e-8
    )
    momentum = np.array([1.2, 0.12, 0.0])
    along = momentum / np.linalg.norm(momentum)
    w, x, y, z = run.quaternion.T
    axis = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
    assert axis @ along == pytest.approx(math.cos(cone), abs=1e-8)
    start = axis[0] - (axis[0] @ along) * along
    across = axis - np.outer(axis @ along, along)
    turned = np.unwrap(np.arctan2(across @ np.cross(along, start), across @ start))
    assert turned == pytest.approx(space * run.time, abs=1e-7)
    assert (body, space, math.degrees(cone)) == pytest.approx((-2.0, 2.009975, 5.710593), abs=1e-6)
    # Control: explicit Euler at a millisecond a step lets the wobble grow.
    wobble = euler_rates((0.3, 0.6, 0.6), (4.0, 0.2, 0.0), 1e-3, 3000)[-1, 1:]
    assert np.hypot(*wobble) / 0.2 > 1.0 + 1e-3


@pytest.mark.case("X26")
@pytest.mark.parametrize("tolerance", [1e-7, 1e-9])
@pytest.mark.parametrize("duration", [0.06, 10.0])
def test_inertia_of_a_needle(duration, tolerance):
    """1e-9, 1 and 1 kg m2 at 3 rad/s about the first axis: the rate stays constant, and the norm of
    the quaternion and the energy hold."""
    inertia = (1e-9, 1.0, 1.0)
    run = spin(inertia, (3.0, 0.0, 0.0), duration, tolerance, 0.01 * duration)
    assert run.status == "time_limit" and run.message == ""
    assert run.rate == pytest.approx(np.tile([3.0, 0.0, 0.0], (run.time.size, 1)), abs=1e-9)
    assert abs(np.linalg.norm(run.quaternion, axis=1) - 1.0).max() <= 1e-12
    assert run.quaternion[-1, 0] == pytest.approx(math.cos(1.5 * duration), abs=1e-8)
    assert run.checks["energy_error"] <= 1e-6


@pytest.mark.case("X26")
@pytest.mark.parametrize("tolerance, error", [(2e-7, 1e-6), (1e-9, 1e-8)])
@pytest.mark.parametrize("thin", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("start", [(3.0, 0.1, -0.2), (0.3, 1.1, -0.7), (0.0, 1.0, 0.0)])
def test_thin_rod(start, thin, tolerance, error):
    """The rate along a thin rod is constant; that across it turns at (Ia - It) w / It."""
    run = spin((thin, 1.0, 1.0), start, 5.0, tolerance, 0.05)
    turning = (thin - 1.0) * start[0]
    across = (start[1] + 1j * start[2]) * np.exp(1j * turning * run.time)
    expected = np.stack([np.full(run.time.size, start[0]), across.real, across.imag], axis=1)
    assert run.status == "time_limit" and run.message == ""
    assert np.abs(run.rate - expected).max() <= error
    assert run.cost["steps"] <= 600  # a thick body like it takes 100 to 400
    # Control: rates from the total momentum and the attitude of the run, which agree to rounding,
    # lose more digits the thinner the rod is.
    if thin == 1e-9 and start[0] and start[1]:
        momentum = rotation.matrices(run.quaternion[:1])[0] @ (np.array([thin, 1.0, 1.0]) * start)
        turned = np.einsum("nji,j->ni", rotation.matrices(run.quaternion), momentum)
        assert np.abs(turned[:, 0] / thin - start[0]).max() > 1e-8


@pytest.mark.case("X26")
@pytest.mark.parametrize("thin, error", [(1e-6, 1e-8), (1e-9, 2e-6)])
def test_thin_rod_in_other_axes(thin, error):
    """The same motion, where the rod lies across the body axes. The rounding of its inverse inertia,
    1e-16 / ``thin``, must not accelerate it."""
    start = np.array([3.0, 0.1, -0.2])
    axes = rotation.matrices(np.array([rotation.exponential((0.4, -0.7, 1.1))]))[0]
    tensor = axes @ np.diag([thin, 1.0, 1.0]) @ axes.T
    names = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    run = lowfi.run(
        scene(
            5.0,
            0.05,
            inertia={name: float(tensor[at]) for name, at in names.items()},
            initial={"velocity": {"x": 1.0}, "rate": dict(zip("xyz", (axes @ start).tolist()))},
        ),
        "springs",
        numerics=numerics(1e-9),
    )
    across = (start[1] + 1j * start[2]) * np.exp(1j * (thin - 1.0) * start[0] * run.time)
    expected = np.stack([np.full(run.time.size, start[0]), across.real, across.imag], axis=1)
    assert run.status == "time_limit" and run.cost["steps"] <= 600
    assert np.abs(run.rate @ axes - expected).max() <= error


@pytest.mark.case("O37")
@pytest.mark.parametrize("tolerance, error", [(1e-8, 1e-5), (1e-11, 1e-7)])
def test_body_fixed_thrust(tolerance, error):
    """Fresnel integrals: the thrust turns with the body."""
    offset = {"eccentricity": {"axial": 0.004, "radial": -math.pi / 2}}
    run = lowfi.run(
        scene(
            1.0,
            0.01,
            thrust_offset=offset,
            thrust={"kind": "constant", "force": 2000.0, "duration": 2.0},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    rate, along, across = exact.planar_thrust(2000.0, 0.004, 20.0, 0.6, 1.0)
    assert run.rate[-1] == pytest.approx([0.0, 0.0, rate], abs=error)
    assert run.velocity[-1] == pytest.approx([along, across, 0.0], abs=error)
    # Control: a thrust left in inertial axes would give F t / m = 100 m/s along X.
    assert abs(2000.0 / 20.0 - along) > 70.0


@pytest.mark.case("O38")
@pytest.mark.parametrize("tolerance", [2e-7, 1e-9])
@pytest.mark.parametrize("pulse, error", [(1e-6, 1e-5), (1e-10, 1e-9)])
@pytest.mark.parametrize(
    "clock, expected",
    [(0.0, (-0.067341, 0.019414, -2.501026)), (35.0, (-0.107637, 1.581236, -2.059856))],
)
def test_short_impulse(tolerance, pulse, error, clock, expected):
    """I^-1 (r x J) for an impulse that is short, and in the limit."""
    inertia = {"xx": 0.30, "yy": 0.55, "zz": 0.60, "xy": 0.010, "xz": -0.008, "yz": 0.004}
    tilt, phi = math.radians(0.1), math.radians(clock)
    run = lowfi.run(
        scene(
            4.0 * pulse,
            pulse,
            inertia=inertia,
            thrust_offset={"misalignment": {"axial": tilt, "radial": phi}},
            thrust={"kind": "constant", "force": 100.0 / pulse, "duration": pulse, "arm": 0.15},
        ),
        "springs",
        numerics=lowfi.Numerics(relative_tolerance=tolerance),
    )
    tensor = np.array([[0.30, 0.010, -0.008], [0.010, 0.55, 0.004], [-0.008, 0.004, 0.60]])
    push = 100.0 * np.array(
        [math.cos(tilt), math.sin(tilt) * math.cos(phi), math.sin(tilt) * math.sin(phi)]
    )
    limit = exact.impulsive_rate(tensor, np.array([-0.15, 0.0, 0.0]), push)
    assert np.degrees(limit) == pytest.approx(expected, abs=1e-6)
    assert abs(run.rate[-1] - limit).max() <= error * abs(limit).max()
    # Control: without the products of inertia the payload would not roll at all, which is off by
    # more than a thousand tolerances.
    plain = exact.impulsive_rate(np.diag(np.diag(tensor)), np.array([-0.15, 0.0, 0.0]), push)
    assert plain[0] == 0.0 and abs(plain - limit).max() > 0.01 * abs(limit).max()


@pytest.mark.case("O39")
@pytest.mark.parametrize("tolerance", [1e-7, 1e-10])
def test_recoil_of_a_free_platform(tolerance):
    """J/m, -J/M, -J b/I; closing speed on the line; momentum and energy close."""
    platform = {
        "mass": 150.0,
        "inertia": {"xx": 10.0, "yy": 10.0, "zz": 10.0},
        "mass_centre": {"y": 0.3},
    }
    run = lowfi.run(
        scene(
            4e-6,
            1e-6,
            platform=platform,
            thrust={"kind": "gaussian", "impulse": 100.0, "width": 1e-7, "centre": 1e-6},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    expected = exact.recoil(100.0, 20.0, 150.0, 10.0, 0.3)
    assert (expected["closing"], expected["energy"]) == pytest.approx(
        (6.566667, 328.3333), abs=1e-4
    )
    assert run.velocity[-1] == pytest.approx([expected["payload"], 0.0, 0.0], abs=1e-4)
    assert run.velocity[-1, 0] == pytest.approx(expected["payload"], rel=1e-6)
    assert run.platform_velocity[-1, 0] == pytest.approx(expected["platform"], rel=1e-6)
    assert run.platform_rate[-1] == pytest.approx([0.0, 0.0, expected["rate"]], rel=1e-6, abs=1e-12)
    closing = run.velocity[-1, 0] - run.platform_velocity[-1, 0] + run.platform_rate[-1, 2] * -0.3
    assert closing == pytest.approx(expected["closing"], rel=1e-6)
    # Control: without the turning of the platform the two would part more slowly, by a seventh.
    assert abs((run.velocity[-1, 0] - run.platform_velocity[-1, 0]) / closing - 1.0) > 0.1
    kinetic = run.energy[-1, 2]
    assert kinetic == pytest.approx(expected["energy"], rel=1e-6)
    assert (
        run.checks["linear_momentum_error"] <= 1e-12
        and run.checks["angular_momentum_error"] <= 1e-12
    )
    assert run.checks["energy_error"] <= 1e-6


@pytest.mark.case("X11")
@pytest.mark.parametrize("tolerance", [2e-7, 1e-9])
@pytest.mark.parametrize("width", [1e-5, 0.1])
def test_no_pulse_is_jumped_over(width, tolerance):
    """J/m = 5 m/s, whether the Gaussian lasts 20 us or half a second."""
    thrust = {"kind": "gaussian", "impulse": 100.0, "width": width, "centre": 0.8}
    run = lowfi.run(
        scene(1.6, 0.01, thrust=thrust),
        "springs",
        numerics=lowfi.Numerics(relative_tolerance=tolerance),
    )
    assert run.velocity[-1, 0] == pytest.approx(5.0, rel=1e-5)
    assert run.cost["steps"] < 400
    # control: steps of one sample that do not know the pulse find no impulse like it
    if width < 0.01:
        peak = 100.0 / (width * math.sqrt(2.0 * math.pi))
        force = peak * np.exp(-0.5 * ((run.time - 0.8) / width) ** 2)
        assert abs(np.trapezoid(force, run.time) / 100.0 - 1.0) > 1.0


@pytest.mark.case("X12")
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_steps_stop_at_the_corners_of_the_thrust(tolerance):
    """12.5 kN for 8.3 ms, seen every 1 ms: 103.75 N s, 5.1875 m/s."""
    push = {"kind": "constant", "force": 12500.0, "start": 0.00123, "duration": 0.0083}
    run = lowfi.run(
        scene(0.02, 0.001, thrust=push),
        "springs",
        numerics=numerics(tolerance),
    )
    assert run.velocity[-1, 0] == pytest.approx(5.1875, rel=1e-6)
    # Control: the midpoint rule on steps of 1 ms misses the corners.
    assert (
        abs(
            sum(12500.0 * 1e-3 for i in range(20) if 0.00123 <= (i + 0.5) * 1e-3 < 0.00953) / 20.0
            - 5.1875
        )
        > 0.1
    )


@pytest.mark.case("O41")
@pytest.mark.parametrize("tolerance", [2e-7, 1e-9])
@pytest.mark.parametrize("rescale, speed", [(False, 4.986501), (True, 5.0)])
def test_cut_gaussian(rescale, speed, tolerance):
    """100 N s with sigma 4 ms cut at 3 sigma: 4.986501 m/s, or 5 when rescaled; the result states
    which."""
    thrust = {
        "kind": "gaussian",
        "impulse": 100.0,
        "width": 4e-3,
        "centre": 0.02,
        "cutoff": 3.0,
        "rescale": rescale,
    }
    run = lowfi.run(
        scene(0.05, 1e-3, thrust=thrust),
        "springs",
        numerics=lowfi.Numerics(relative_tolerance=tolerance),
    )
    assert 5.0 * (1.0 if rescale else kept_by_cut(3.0)) == pytest.approx(speed, rel=1e-7)
    assert run.velocity[-1, 0] == pytest.approx(speed, rel=1e-6)
    assert (run.scene["thrust"]["cutoff"], run.scene["thrust"]["rescale"]) == (3.0, rescale)


def test_a_rocket_far_from_its_rail_keeps_its_rate():
    """The thrust passes through the mass centre, so the rate is constant in every sample. With its angular
    momentum about the origin it had waves of 3e-5 rad/s between the steps."""
    free = {"contact": None, "friction": None, "initial.settled": None, "thrust_offset": None}
    free |= {"hold_down": {"release": 0.0}}  # a stop would press on it beside its mass centre
    run = lowfi.run(scenes.load("rocket_rail").replace(free | {"initial.rate.y": 0.05}), "springs")
    assert run.position[-1, 0] > 2.0
    assert np.ptp(run.rate[:, 1]) < 1e-14


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_burn_after_the_exit_closes_its_balance_at_loose_tolerances(tolerance):
    """A light rocket under a thrust off its axis. Its moments about the origin were 1e4 times its spin, and
    their error at these tolerances failed the run."""
    light = {"payload.mass": 2.0, "thrust_offset.misalignment": {"axial": 3e-3, "radial": 0.7}}
    asked = scenes.load("rocket_rail").replace(light)
    found, finest = (
        lowfi.run(asked, "springs", numerics=lowfi.Numerics(relative_tolerance=each))
        for each in (tolerance, 1e-9)
    )
    assert found.status == "exited" and found.checks["angular_momentum_error"] < 1e-13
    assert found.outcome.rate == pytest.approx(finest.outcome.rate, rel=5e-3)


@pytest.mark.parametrize("tolerance, error", [(1e-2, 1e-2), (1e-4, 5e-4), (2e-7, 2e-6)])
def test_a_motor_that_burns_on_beyond_a_free_platform_keeps_the_rates(tolerance, error):
    """A thrust of seconds whose exhaust misses the platform: the payload flies 70 m. With angular momenta
    about the origin up to the end, rates were off by 4e-4 at 2e-7, and the looser runs failed."""
    long = {"peak": 300.0, "width": 0.5, "centre": 1.6, "reaction": "exhaust"}
    burning = {f"thrust.{name}": value for name, value in long.items()}
    asked = scenes.load("reference").replace(burning | {"duration": None, "output": None})
    found, finest = (
        lowfi.run(asked, "springs", numerics=lowfi.Numerics(relative_tolerance=each))
        for each in (tolerance, 1e-9)
    )
    assert found.status == "exited" and found.position[-1, 0] > 50.0
    assert found.checks["angular_momentum_error"] < 1e-11
    assert found.outcome.rate == pytest.approx(finest.outcome.rate, rel=error)
