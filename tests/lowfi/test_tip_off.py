"""A body that turns about an edge or a pad: rocking, crossing the clearance, tipping off the rail's
end."""

import math

import numpy as np
import pytest

from tests.exact import guided as exact
from tests.lowfi.support import RAIL, G, numerics, scene
from tipoff import lowfi

TWO_TOLERANCES = pytest.mark.parametrize("tolerance", [1e-6, 1e-8])


def rocking_block(mu: float, tolerance: float, drift: float = 0.0):
    """Half-width 50, half-height 150 mm, released at 0.3 of the tipping angle about its edge at +x;
    feet on a stiff floor.

    Without friction it needs to ``drift`` along (m/s), or it counts as jammed."""
    b, h, mass = 0.05, 0.15, 20.0
    start = 0.3 * math.atan2(b, h)
    sine, cosine = math.sin(start), math.cos(start)
    inertia = mass * (b * b + h * h) / 3.0
    return start, lowfi.run(
        scene(
            0.2,
            1e-4,
            mass=mass,
            inertia={"xx": inertia, "yy": inertia, "zz": inertia},
            pads=[{"position": (x, 0.0, -h), "normals": ["-z"]} for x in (b, -b)],
            contact={"law": "linear", "clearance": 0.0, "stiffness": 1e9, "damping": 1e5},
            friction={"static": mu, "dynamic": mu, "static_speed": 2e-4, "dynamic_speed": 4e-4},
            gravity={"z": -G},
            initial={
                "velocity": {"x": drift},
                "attitude": {"y": start},
                "position": {"x": b - b * cosine + h * sine, "z": b * sine + h * cosine - h},
            },
        ),
        "springs",
        numerics=numerics(tolerance),
    )


def first_touch(run, face: int) -> int:
    """Number of the first sample at which ``face`` carries load."""
    return int(np.flatnonzero(run.pad_force[:, face, 2] > 0.0)[0])


@pytest.mark.case("O27")
@TWO_TOLERANCES
def test_rocking_block(tolerance):
    """Housner's quadrature: the other edge strikes after 0.131956 s, and the rate follows until
    then."""
    assert math.atan2(0.05, 0.15) == pytest.approx(0.321751, abs=1e-6)
    start, run = rocking_block(1.0, tolerance)
    expected = exact.rocking_time(0.05, 0.15, start, G)
    assert expected == pytest.approx(0.131956, abs=1e-6)
    strike = first_touch(run, 1)
    assert run.time[strike] == pytest.approx(expected, rel=5e-3)
    assert -run.rate[strike - 1, 1] == pytest.approx(
        exact.rocking_rate(0.05, 0.15, start, 0.0, G), rel=5e-3
    )
    # Control: on a floor without friction the foot slides away below it, and the block strikes at
    # another time.
    _, slid = rocking_block(0.0, tolerance, drift=1.0)
    assert abs(slid.time[first_touch(slid, 1)] / expected - 1.0) > 0.05


@pytest.mark.case("O29")
@TWO_TOLERANCES
def test_couple_across_the_clearance(tolerance):
    """0.500 mrad in 14.1421 ms, then 70.711 mrad/s and 7.0711 mm/s at the pads."""
    clearance, span, couple, inertia = 5e-5, 0.2, 4.0, 0.8
    expected = exact.crossing_the_clearance(clearance, span, couple, inertia)
    assert tuple(expected.values()) == pytest.approx(
        (0.5e-3, 14.1421e-3, 70.711e-3, 7.0711e-3), rel=1e-5
    )
    guide = [
        {"position": (x, 0.0, z), "normals": [sign]}
        for x in (-0.1, 0.1)
        for z, sign in ((-0.02, "-z"), (0.02, "+z"))
    ]
    # 4 N at 1 m instead of a true couple: what the push itself moves meanwhile is a ten-thousandth
    # of the clearance.
    run = lowfi.run(
        scene(
            0.016,
            2e-6,
            inertia=dict.fromkeys(("xx", "yy", "zz"), inertia),
            pads=guide,
            contact={"law": "linear", "clearance": clearance, "stiffness": 7e7, "damping": 3.704e4},
            friction={"static": 0.0, "dynamic": 0.0, "static_speed": 1e-3, "dynamic_speed": 2e-3},
            gravity={"z": 0.0},
            thrust={"kind": "constant", "force": 4.0, "duration": 1.0},
            thrust_offset={"eccentricity": {"axial": couple / 4.0}},
            initial={"velocity": {"x": 1.0}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    touching = np.flatnonzero((run.pad_force[:, :, 2] != 0.0).any(axis=1))[0]
    rate = abs(run.rate[touching - 1, 1])
    found = {
        "angle": 2.0 * abs(run.quaternion[touching, 2]),
        "time": run.time[touching],
        "rate": rate,
        "pad_speed": 0.5 * span * rate,
    }
    assert found == pytest.approx(expected, rel=1e-3)
    # Control: that the walls are as far apart as one clearance is the usual slip.
    assert (
        abs(
            exact.crossing_the_clearance(0.5 * clearance, span, couple, inertia)["time"]
            / found["time"]
            - 1.0
        )
        > 0.2
    )


def tipped_off(stiffness: float, tolerance: float):
    """20 kg with its mass centre midway between pads 0.2 m apart leaves at 5 m/s under 1 g; pads at
    static equilibrium, damped to half of critical, so that what is left of their ringing is gone
    when the rear pad leaves."""
    damping = math.sqrt(stiffness * 10.0)
    pads = [{"position": (x, 0.0, 0.0), "normals": ["-z"]} for x in (-0.1, 0.1)]
    return lowfi.run(
        scene(
            0.1,
            1e-4,
            inertia=dict.fromkeys(("xx", "yy", "zz"), 0.8),
            pads=pads,
            rail=RAIL | {"end": 0.2},
            gravity={"z": -G},
            contact={"law": "linear", "clearance": 0.0, "stiffness": stiffness, "damping": damping},
            initial={"velocity": {"x": 5.0}, "position": {"z": -10.0 * G / stiffness}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )


@pytest.mark.case("O30")
@TWO_TOLERANCES
def test_tip_off_under_gravity(tolerance):
    """q = m g a s / (v (I + m a^2)) as the pads stiffen: 0.784532 rad/s; the rear pad carries
    156.906 N meanwhile."""
    expected = exact.tip_off(20.0, 0.8, 0.1, 0.2, 5.0, G)
    assert tuple(expected.values()) == pytest.approx(
        (19.6133, 0.784532, 15.691e-3, 156.906), rel=5e-5
    )
    errors = []
    for stiffness in (1e5, 1e7, 1e9):
        run = tipped_off(stiffness, tolerance)
        assert run.status == "exited"
        errors.append(abs(run.outcome.rate[1] / expected["rate"] - 1.0))
    assert errors[2] <= 5e-3 and errors[2] < errors[0]
    # the front pad leaves at 20 ms, the rear one at 60 ms
    while_tipping = (run.time > 0.035) & (run.time < 0.055)
    assert run.pad_force[while_tipping, 0, 2] == pytest.approx(expected["load"], rel=5e-3)
    turned = 2.0 * run.quaternion[np.searchsorted(run.time, 0.06 - 1e-9), 2]
    assert turned == pytest.approx(expected["angle"], rel=5e-3)
    # Controls: pads as soft as a rubber foot, and a body that turns about its mass centre instead
    # of the pad, are off by more.
    assert errors[0] > 5e-3 and abs(20.0 * G * 0.1 * 0.04 / 0.8 / expected["rate"] - 1.0) > 0.2
