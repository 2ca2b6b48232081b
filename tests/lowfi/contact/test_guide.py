"""A slider between two walls without clearance, pushed beside its middle: the net push with
friction, and the offset at which it jams.

Two pads carry N = F r / s each, so friction takes 2 mu F r / s, and all of the push from r = s / (2
mu) on.
"""

import numpy as np
import pytest

from tests.exact import guided as exact
from tests.lowfi.support import scene, unwatched
from tipoff import lowfi
from tipoff.lowfi import Numerics

SPAN, PUSH, MASS = 0.2, 2000.0, 20.0
GUIDE = [
    {"position": (x, 0.0, z), "normals": [sign]}
    for x in (-0.1, 0.1)
    for z, sign in ((-0.02, "-z"), (0.02, "+z"))
]
# Damping ratio 0.7 of 10 kg on one pad: lighter damping leaves a ripple that hides the few per cent
# left close to the lock.
PADS = {"law": "linear", "clearance": 0.0, "stiffness": 7e7, "damping": 3.704e4}
TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-6, 1e-8])


def slider(
    mu: float,
    offset: float,
    duration: float,
    transition: float = 1e-3,
    pushed: float | None = None,
    **tables,
):
    """A scene of 20 kg, I 0.8 kg m2, pushed with 2 kN at ``offset`` (m) for ``pushed`` (s), or
    throughout."""
    return scene(
        duration,
        1e-4,
        mass=MASS,
        inertia=dict.fromkeys(("xx", "yy", "zz"), 0.8),
        pads=GUIDE,
        contact=PADS,
        friction={
            "static": mu,
            "dynamic": mu,
            "static_speed": transition,
            "dynamic_speed": 2.0 * transition,
        },
        # Gravity of nothing and offsets of nothing keep all scenes of this kind on one
        # compiled kernel.
        gravity={"z": 0.0},
        thrust_offset={"eccentricity": {"axial": offset}},
        thrust={"kind": "constant", "force": PUSH, "duration": pushed or 2.0 * duration},
        **tables,
    )


def mean_acceleration(run, start: float = 0.02, end: float = 0.04) -> float:
    """Mean acceleration along the guide (m/s2) between two times (s)."""
    first, last = np.searchsorted(run.time, [start - 1e-9, end - 1e-9])
    return float(
        (run.velocity[last, 0] - run.velocity[first, 0]) / (run.time[last] - run.time[first])
    )


@pytest.mark.case("O28")
@TWO_TOLERANCES
@pytest.mark.parametrize("offset, share", [(0.060, 0.820), (0.0006, 0.9982)])
def test_net_push_with_friction(tolerance, offset, share):
    """F (1 - 2 mu r / s) within 0.5 % of F."""
    assert exact.net_share(0.3, offset, SPAN) == pytest.approx(share, rel=1e-12)
    run = lowfi.run(
        slider(0.3, offset, 0.04), "springs", numerics=Numerics(relative_tolerance=tolerance)
    )
    assert run.status == "time_limit" and run.checks["friction_power_max"] <= 0.0
    assert mean_acceleration(run) * MASS / PUSH == pytest.approx(share, abs=5e-3)


@pytest.mark.case("O28")
@TWO_TOLERANCES
@pytest.mark.parametrize("mu, locks_at", [(0.3, 0.33333), (0.8, 0.125)])
def test_the_offset_at_which_it_locks(tolerance, mu, locks_at):
    """Two per cent inside the threshold s / (2 mu) two per cent of the push are left; two per cent
    outside it jams."""
    limit = exact.jam_offset(mu, SPAN)
    assert limit == pytest.approx(locks_at, rel=2e-5)
    numerics = Numerics(relative_tolerance=tolerance)
    inside, outside = (
        lowfi.run(slider(mu, factor * limit, 0.04), "springs", numerics=numerics)
        for factor in (0.98, 1.02)
    )
    assert inside.status == "time_limit" and outside.status == "jammed"
    assert mean_acceleration(inside) * MASS / PUSH == pytest.approx(0.02, abs=5e-3)
    assert outside.velocity[-1, 0] < 1e-3


@pytest.mark.case("O40")
@TWO_TOLERANCES
@pytest.mark.parametrize(
    "mu, offset, speed", [(0.3, 0.020, 4.700), (0.3, 0.002, 4.970), (0.0, 0.020, 5.000)]
)
def test_exit_speed_with_friction(tolerance, mu, offset, speed):
    """(J / m) (1 - 2 mu r / s) for 100 N s, at the end of a rail that the pads leave after the
    push."""
    assert exact.net_share(mu, offset, SPAN) * 5.0 == pytest.approx(speed, rel=1e-12)
    rail = {
        "start": -1.0,
        "end": 0.3,
        "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
    }
    run = lowfi.run(
        slider(mu, offset, 0.2, pushed=0.05, rail=rail),
        "springs",
        numerics=Numerics(relative_tolerance=tolerance),
    )
    assert run.status == "exited"
    assert run.outcome.velocity[0] == pytest.approx(speed, rel=5e-3)


@pytest.mark.case("X7")
@TWO_TOLERANCES
def test_wedged_slider_stays_where_it_is(tolerance):
    """mu 0.8 at 130 mm: it moves by less than 0.5 mm in 0.2 s, creeps below the smoothing speed,
    and the run has no exit."""
    transition = 5e-4
    asked = slider(0.8, 0.130, 0.2, transition)
    run = lowfi.run(asked, "springs", numerics=Numerics(relative_tolerance=tolerance))
    assert run.status == "jammed" and run.outcome.exit_time is None and run.outcome.velocity is None
    whole = unwatched(asked, Numerics(relative_tolerance=tolerance)).trajectory()
    assert whole.time[-1] == pytest.approx(0.2)
    assert whole.position[-1, 0] < 0.5e-3 and 0.0 < whole.velocity[-1, 0] < transition
    assert whole.checks["friction_power_max"] <= 0.0 and whole.checks["energy_error"] <= 1e-6
    # Control: a law smoothed over 50 mm/s lets the same slider creep out.
    smoother = unwatched(slider(0.8, 0.130, 0.2, 0.05), Numerics(relative_tolerance=tolerance))
    assert smoother.trajectory().position[-1, 0] > 2e-3


@pytest.mark.case("X7")
@TWO_TOLERANCES
def test_slider_just_inside_the_lock_moves(tolerance):
    """mu 0.8 at 120 mm: 4 % of the push is left, 4.00 m/s2 within 2 % from 20 to 40 ms."""
    run = lowfi.run(
        slider(0.8, 0.120, 0.04), "springs", numerics=Numerics(relative_tolerance=tolerance)
    )
    expected = exact.net_share(0.8, 0.120, SPAN) * PUSH / MASS
    assert expected == pytest.approx(4.00, rel=1e-12)
    assert run.status == "time_limit"
    assert mean_acceleration(run) == pytest.approx(expected, rel=0.02)
