"""Free rotation in closed form: published cases, an integrator as oracle, hours of tumbling, and
where its formulas are 0 / 0."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from tests.exact import rigid as exact
from tipoff.studies.flight import rotation

# of the reference scene
INERTIA = np.array([[0.066, 0.004, -0.002], [0.004, 0.134, 0.0], [-0.002, 0.0, 0.128]])


def body(inertia, rate, turn=np.eye(3)):
    inertia = np.diag(inertia) if np.ndim(inertia) == 1 else np.asarray(inertia)
    return rotation.free(inertia[None], turn[None], np.array(rate, dtype=float)[None])


def at(found, time):
    turn, rate = rotation.at(found, np.atleast_1d(np.asarray(time, dtype=float))[None])
    return turn[0], rate[0]


def integrated(inertia, turn, rate, time):
    """Attitude and rate by Dormand-Prince of order 8 on q' = q w / 2, I w' = I w x w."""
    inverse = np.linalg.inv(inertia)

    def slope(_, y):
        q, w = y[:4], y[4:]
        return np.r_[
            0.5 * np.r_[-q[1:] @ w, q[0] * w + np.cross(q[1:], w)],
            inverse @ np.cross(inertia @ w, w),
        ]

    begin = np.r_[Rotation.from_matrix(turn).as_quat(scalar_first=True), rate]
    end = solve_ivp(slope, (0.0, time), begin, method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    return Rotation.from_quat(
        end[:4] / np.linalg.norm(end[:4]), scalar_first=True
    ).as_matrix(), end[4:]


@pytest.mark.case("O34")
def test_jacobi():
    """In principal axes, and the same body in axes that are none."""
    inertia, start, time = (0.30, 0.55, 0.80), (0.5, 0.0, 2.0), np.linspace(0.0, 10.0, 101)
    turn, rate = at(body(inertia, start), time)
    assert rate == pytest.approx(exact.free_rates(inertia, start, time), abs=1e-12)
    assert rate[-1] == pytest.approx([0.0130461144, -0.5220551683, 1.9764396842], abs=1e-9)
    q = Rotation.from_matrix(turn[-1]).as_quat(scalar_first=True)
    assert q * -np.sign(q[0]) == pytest.approx(
        [-0.7685141217, 0.0384838400, 0.0223194370, -0.6382843266], abs=1e-9
    )
    assert rotation.nutation_period(body(inertia, start))[0] == pytest.approx(
        exact.free_period(inertia, start), rel=1e-13
    )
    axes = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix()
    turned, others = at(body(axes @ np.diag(inertia) @ axes.T, axes @ start, axes.T), time)
    assert others == pytest.approx(rate @ axes.T, abs=1e-12) and turned == pytest.approx(
        turn @ axes.T, abs=1e-12
    )
    # Control: the diagonal of that tensor alone is another body.
    wrong = at(body(np.diag(axes @ np.diag(inertia) @ axes.T), axes @ start), time)[1]
    assert abs(wrong - others).max() > 0.1


@pytest.mark.case("O35")
def test_flip_about_the_middle_axis():
    inertia, start = (0.30, 0.55, 0.80), (0.0, 5.0, 0.005)
    quarter, half = exact.flip_times(inertia, start)
    assert (quarter, half) == pytest.approx((3.041335, 6.082670), abs=1e-6)
    zeros = quarter + half * np.arange(3)
    _, rate = at(body(inertia, start), [0.0, *zeros, *(zeros + 1e-6)])
    assert abs(rate[1:4, 1]).max() < 1e-8
    assert (np.sign(rate[4:, 1]) == [-1.0, 1.0, -1.0]).all() and rate[0] == pytest.approx(
        start, abs=1e-12
    )


@pytest.mark.case("O36")
def test_axisymmetric_precession():
    """A body of revolution, whose two equal moments make the formulas 0 / 0, long and flat."""
    spin, space, tilt = exact.axisymmetric(0.3, 0.6, 4.0, 0.2)
    time = np.linspace(0.0, 3.0, 61)
    found = body((0.3, 0.6, 0.6), (4.0, 0.2, 0.0))
    turn, rate = at(found, time)
    assert rate[:, 1] + 1j * rate[:, 2] == pytest.approx(0.2 * np.exp(1j * spin * time), abs=1e-10)
    assert rotation.precession_rate(found)[0] == pytest.approx(space, rel=1e-12)
    along = np.array([1.2, 0.12, 0.0]) / math.hypot(1.2, 0.12)
    assert turn[:, :, 0] @ along == pytest.approx(math.cos(tilt), abs=1e-10)
    flat = body((0.3, 0.3, 0.5), (0.2, 0.0, 4.0))
    assert rotation.precession_rate(flat)[0] == pytest.approx(
        exact.axisymmetric(0.5, 0.3, 4.0, 0.2)[1], rel=1e-12
    )


def _cases():
    rng = np.random.default_rng(1)
    axes = Rotation.from_rotvec([0.4, -1.0, 0.3]).as_matrix()
    yield "reference", INERTIA, [-0.07, -0.02, 0.06]
    shapes = {
        "long": (0.4, 0.9, 0.9),
        "flat": (0.5, 0.5, 0.9),
        "sphere": (0.7, 0.7, 0.7),
        "any": (0.5, 0.7, 1.1),
    }
    for name, moments in shapes.items():
        yield name, axes @ np.diag(moments) @ axes.T, rng.normal(size=3)
    for number, name in enumerate(("smallest", "middle", "largest")):
        yield (
            f"about the {name}",
            axes @ np.diag((0.5, 0.7, 1.1)) @ axes.T,
            axes[:, number] * -1.3 + (0.001 if name == "middle" else 0.0),
        )
    yield "flat, turning over", axes @ np.diag((0.5, 0.5, 0.9)) @ axes.T, axes[:, 0]


@pytest.mark.parametrize(
    "name, inertia, rate", [pytest.param(*case, id=case[0]) for case in _cases()]
)
def test_any_body_moves_as_integrated(name, inertia, rate):
    """Dormand-Prince at 1e-13 a step. Near the middle axis the motion itself multiplies rounding by
    exp(lambda t), a thousandfold here; turning over, a body of revolution keeps half the digits of
    moments that are equal."""
    turn, rate = Rotation.from_rotvec([0.2, 0.5, -1.0]).as_matrix(), np.asarray(rate)
    inertia = 0.5 * (inertia + inertia.T)
    found = body(inertia, rate, turn)
    assert at(found, 0.0)[0][0] == pytest.approx(turn, abs=1e-13) and at(found, 0.0)[1][
        0
    ] == pytest.approx(rate, abs=1e-12)
    expected, spin = integrated(inertia, turn, rate, 20.0)
    allowed = 1e-8 if "middle" in name or "over" in name else 2e-11
    turned, w = at(found, 20.0)
    assert turned[0] == pytest.approx(expected, abs=allowed) and w[0] == pytest.approx(
        spin, abs=allowed
    )


def test_hours():
    """Two hours at once are an hour and an hour, and momentum and energy are what they were.
    Control: steps of a second are lost."""
    rate = np.array([-0.07, -0.02, 0.06])
    found = body(INERTIA, rate)
    time = np.linspace(0.0, 7200.0, 721)
    turn, w = at(found, time)
    momentum = np.einsum("kij,kj->ki", turn, w @ INERTIA)
    energy = np.einsum("ki,ij,kj->k", w, INERTIA, w)
    assert (
        abs(momentum - momentum[0]).max() <= 1e-12 * np.linalg.norm(momentum[0])
        and abs(energy / energy[0] - 1.0).max() <= 1e-11
    )
    assert turn @ turn.transpose(0, 2, 1) == pytest.approx(
        np.tile(np.eye(3), (len(time), 1, 1)), abs=1e-14
    )
    half = body(INERTIA, w[360], turn[360])
    again, later = at(half, 3600.0)
    assert again[0] == pytest.approx(turn[-1], abs=1e-10) and later[0] == pytest.approx(
        w[-1], abs=1e-11
    )
    stepped = rate
    for _ in range(3600):
        stepped = stepped + np.linalg.solve(INERTIA, np.cross(INERTIA @ stepped, stepped))
    assert abs(stepped - w[360]).max() > 1e-3


def test_rest_and_the_very_middle_axis():
    still = body((0.30, 0.55, 0.80), (0.0, 0.0, 0.0))
    turn, rate = at(still, [0.0, 1e4])
    assert turn == pytest.approx(np.tile(np.eye(3), (2, 1, 1)), abs=1e-15) and not rate.any()
    assert (
        rotation.nutation_period(still)[0] == math.inf and rotation.precession_rate(still)[0] == 0.0
    )
    turn, rate = at(body((0.30, 0.55, 0.80), (0.0, 1.0, 0.0)), 5.0)
    assert rate[0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert turn[0] == pytest.approx(Rotation.from_rotvec([0.0, 5.0, 0.0]).as_matrix(), abs=1e-9)
