"""Where payloads go: against full runs, against straight lines and textbook orbits, and a tail that
hits its rail."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tipoff import lowfi
from tipoff.kernels import rotation
from tipoff.scenes import load
from tipoff.studies.flight import bodies, flown, orbit, summary
from tipoff.studies.flight import rotation as free

SCENE = load("reference").replace({"flight.body": ["0.35 m", "0.19 m", "0.19 m"]})
# no orbit to speak of
SLOW = {"flight.altitude": None, "flight.mean_motion": 1e-9, "flight.duration": 100.0}


def start(
    velocity=(6.0, 0.0, 0.0),
    rate=(0.0, 0.0, 0.0),
    place=(0.2, 0.0, 0.0),
    turn=(0.0, 0.0, 0.0),
    platform_velocity=None,
):
    """One payload that leaves a platform at rest in attitude, pushed back by the momentum of the
    payload unless told otherwise."""
    base = (
        -np.array(velocity) * SCENE.payload.mass / SCENE.platform.mass
        if platform_velocity is None
        else np.array(platform_velocity)
    )
    row = (
        place,
        velocity,
        Rotation.from_rotvec(turn).as_matrix(),
        rate,
        (-0.1, 0.0, 0.0),
        base,
        np.eye(3),
        (0.0, 0.0, 0.0),
    )
    return bodies.Start(*(np.array(part, dtype=float)[None] for part in row))


def fly(begin, overrides=None):
    scene = SCENE.replace(overrides or {})
    return flown.fly(scene.flight.record(), bodies.bodies([scene] * len(begin.place)), begin)


@pytest.mark.parametrize("condition", ["phi35", "h9"])
def test_a_flight_goes_on_where_a_run_ends(condition):
    """Both bodies 3 ms after the exit as a full run has them; the settled rate is that of the
    window's middle, off by w^2 times 2 ms from the one at exit. Control: neither stays where it
    was."""
    scene = SCENE.condition(condition)
    run = lowfi.run(scene, "springs", numerics=lowfi.Numerics(relative_tolerance=1e-8))
    both = flown.pair(
        scene.flight.record(),
        bodies.bodies([scene]),
        bodies.start(bodies.of_outcomes([run.outcome])),
    )
    first = int(np.searchsorted(run.time, run.outcome.exit_time))
    time, n, axes = (
        np.array([[run.time[-1] - run.outcome.exit_time]]),
        both.flight.mean_motion,
        both.flight.axes,
    )
    rate = np.linalg.norm(run.outcome.rate)
    assert time[0, 0] > 2.9e-3 and rate > 0.08
    for states, turning, place, attitude, speed in (
        (both.payload, both.payload_turn, run.position, run.quaternion, 6.0),
        (both.platform, both.platform_turn, run.platform_position, run.platform_quaternion, 0.7),
    ):
        found = (orbit.back(n, axes, orbit.places(n, states, time), time) + both.bodies.origin)[
            0, 0
        ]
        assert found == pytest.approx(place[-1], abs=2e-9)
        assert free.at(turning, time)[0][0, 0] == pytest.approx(
            rotation.matrices(attitude[-1:])[0], abs=3e-3 * 2e-3 * rate**2
        )
        assert abs(found - place[first]).max() > 2.5e-3 * speed
    speed, back = np.array(run.outcome.velocity), np.array(run.outcome.exit_platform_velocity)
    left = scene.payload.mass * speed + scene.platform.mass * back
    # the thrust reacts on the platform, which is free
    assert abs(left).max() <= 1e-9 * scene.payload.mass * 6.0


def test_without_an_orbit_a_shot_is_straight():
    """range * lateral / axial velocity from where it left; what a perfect shot has is nothing."""
    found = fly(start((6.0, 0.012, -0.03), place=(0.2, 1e-4, 2e-4)), SLOW)
    time = 99.8 / 6.0
    assert found.passes[0] == pytest.approx(time, rel=1e-6)
    assert found.miss[0] == pytest.approx([1e-4 + 0.012 * time, 2e-4 - 0.03 * time], abs=1e-5)
    assert found.orbital[0] == pytest.approx([0.0, 0.0], abs=1e-5)
    assert math.isinf(found.returns[0])


def test_what_the_orbit_bends():
    """A shot along the orbit rises by 2 (1 - cos nt) v / n against a target that stays. Control:
    one across it does not rise."""
    begin = start(place=bodies.bodies([SCENE]).origin[0])  # where the orbit is counted from
    found, n = fly(begin), SCENE.flight.record().mean_motion
    rise = 2.0 * (1.0 - math.cos(n * found.passes[0])) * 6.0 / n
    assert rise > 1.5 and found.miss[0] == pytest.approx([0.0, rise], abs=1e-8)
    assert found.orbital[0] == pytest.approx(found.miss[0], abs=1e-12)
    assert found.miss[0] - fly(begin, SLOW).miss[0] == pytest.approx([0.0, rise], abs=1e-4)
    assert abs(fly(begin, {"flight.azimuth": "90 deg"}).miss[0]).max() < 0.02


def test_radial_launches_come_back():
    """After one orbit, to within metres of the platform. Control: along the orbit the payload is a
    hundred kilometres away by then."""
    assert fly(start(), {"flight.elevation": "90 deg"}).returns[0] < 20.0
    assert (
        math.isinf(fly(start()).returns[0])
        and 1e5 < fly(start(), {"flight.range": "200 km"}).returns[0] < 1.3e5
    )


def test_a_target_that_is_not_reached_has_no_miss():
    found = fly(start(), {"flight.range": "1000 km"})
    assert np.isnan([found.passes[0], *found.miss[0], found.pointing[0]]).all()
    left = SimpleNamespace(
        rate=np.zeros((1, 3)),
        lateral_velocity=np.zeros(1),
        direction_error=np.zeros(1),
        exit_attitude=np.zeros((1, 3)),
    )
    row = summary.row(found, left, 0)
    assert row["miss_m"] is None and row["clearance_mm"] > 0.0


def test_pointing():
    """Spin about y tilts the axis by rate times time; spin about x does not, and then the limit is
    never reached."""
    plain = {"payload.inertia.xy": 0.0, "payload.inertia.xz": 0.0}
    tilting, rolling = (
        fly(start(rate=(0.0, 0.01, 0.0)), plain),
        fly(start(rate=(0.05, 0.0, 0.0)), plain),
    )
    assert tilting.limit[0] == pytest.approx(math.radians(1.0) / 0.01, abs=1e-6)
    assert tilting.pointing[0] == pytest.approx(0.01 * tilting.passes[0], rel=1e-9)
    assert tilting.cone[0] == pytest.approx([math.pi / 2.0] * 2) and tilting.coning[
        0
    ] == pytest.approx(0.01)
    assert math.isinf(rolling.limit[0]) and rolling.pointing[0] == pytest.approx(0.0, abs=1e-12)
    assert rolling.cone[0] == pytest.approx([0.0, 0.0], abs=1e-7)
    assert fly(start(turn=(0.0, 0.02, 0.0))).limit[0] == 0.0  # beyond it from the beginning
    assert np.isnan(fly(start(), {"flight.pointing_limit": None}).limit[0])


@pytest.mark.parametrize(
    "rate",
    [
        (0.05, 0.02, -0.03),
        (-0.05, 0.001, 0.002),
        (0.001, 0.05, 0.002),
        (0.003, -0.002, 0.05),
        (0.01, -0.04, 0.03),
    ],
)
def test_cone_of_an_asymmetric_body(rate):
    """Least and largest angle, and the rate round the angular momentum, from the axis itself over
    many nutations."""
    found, body = fly(start(rate=rate)), bodies.bodies([SCENE])
    time = np.linspace(0.0, 30.0 * found.nutation[0], 200_001)[None]
    turn, _w = free.at(free.free(body.inertia, np.eye(3)[None], np.array([rate])), time)
    momentum = body.inertia[0] @ rate
    to = Rotation.align_vectors([[0.0, 0.0, 1.0]], [momentum])[0].apply(turn[0, :, :, 0])
    angle, way = (
        np.arctan2(np.hypot(to[:, 0], to[:, 1]), to[:, 2]),
        np.unwrap(np.arctan2(to[:, 1], to[:, 0])),
    )
    assert found.cone[0] == pytest.approx([angle.min(), angle.max()], abs=1e-4)
    assert found.coning[0] == pytest.approx((way[-1] - way[0]) / time[0, -1], rel=1e-6)


@pytest.mark.parametrize("many", [16, pytest.param(40, marks=pytest.mark.slow)])
def test_no_instant_is_closer_than_the_least(many):
    """Of random exits from a body flush with its pads, 4,000 instants each; later there is none
    either."""
    rng = np.random.default_rng(7)
    scene = SCENE.replace({"flight.body": None})
    exits = start()._replace(
        velocity=np.array([6.0, 0.0, 0.0]) + 0.02 * rng.normal(size=(many, 3)),
        rate=0.1 * rng.normal(size=(many, 3)),
        place=np.array([0.196, 0.0, 0.0]) + 1e-4 * rng.normal(size=(many, 3)),
    )
    begin = bodies.Start(
        *(np.repeat(part, many, axis=0) if len(part) == 1 else part for part in exits)
    )
    both = flown.pair(scene.flight.record(), bodies.bodies([scene] * many), begin)
    found, clear = flown.found(both), flown.clear_after(both)
    dense = flown.gap(both, clear[:, None] * np.linspace(0.0, 1.0, 4001))
    assert (
        (found.clearance <= dense.min(axis=1) + 2e-7).all()
        and (found.clearance < 0.0).any()
        and (found.clearance > 0.0).any()
    )
    assert (flown.gap(both, clear[:, None] * np.array([1.0, 2.0, 10.0])) > 0.04).all()


@pytest.mark.parametrize(
    "rate, sideways", [(0.0, 0.0), (0.0, 0.1), (0.05, 0.0), (-0.1, 0.05), (2.0, 0.0), (0.0, 1.0)]
)
def test_clearance_of_the_tail(rate, sideways):
    """The tail's corner passes the rail's end after t: gap - |v_y t - w t (half length)| there,
    with a gap of 5.25 mm. Controls: the last two hit; there the shortest way out is at most that
    deep."""
    found = fly(start((6.0, sideways, 0.0), (0.0, 0.0, rate), platform_velocity=(0.0, 0.0, 0.0)))
    passing = (0.132 - (0.2 - 0.175)) / 6.0
    expected = 0.00525 - abs(sideways * passing - rate * passing * 0.175)
    if expected > 0.0:
        assert found.clearance[0] == pytest.approx(expected, abs=5e-6)
    else:
        assert expected - 1e-5 < found.clearance[0] < 0.5 * expected
    if rate or sideways:
        assert found.closest[0] == pytest.approx(passing, abs=3e-3)


def test_a_body_flush_with_its_pads_touches_sooner():
    """``payload.size`` is the body where no other is given; with neither, or without boxes, no
    clearance is told and it is said why."""
    narrow, flush = (
        fly(start((6.0, 0.02, 0.0))),
        fly(start((6.0, 0.02, 0.0)), {"flight.body": None}),
    )
    assert (
        narrow.clearance[0] - flush.clearance[0] == pytest.approx(5e-3, abs=1e-6)
        and flush.clearance[0] < 0.0
    )
    unknown = SCENE.replace({"flight.body": None, "payload.size": None})
    assert "payload.size" in bodies.unknown_size(unknown) and not bodies.unknown_size(SCENE)
    assert np.isnan(fly(start(), {"flight.body": None, "payload.size": None}).clearance[0])


def test_boxes_of_the_rails():
    """Four L sections of two legs, on the far side of their walls, and the platform's body."""
    found = bodies.bodies([SCENE])
    low, high = found.boxes[0] - found.box_halves[0], found.boxes[0] + found.box_halves[0]
    assert low.shape == (9, 3)
    # outer corners
    assert np.maximum(abs(low), abs(high))[1:, 1:] == pytest.approx(np.full((8, 2), 0.10425))
    # walls
    assert np.minimum(abs(low), abs(high))[1:, 1:].max(axis=1) == pytest.approx([0.10025] * 8)
    # the platform's mass centre lies 0.1 m behind the scene's origin
    assert low[1:, 0] - 0.1 == pytest.approx([-0.088] * 8)
    assert np.prod(2.0 * found.box_halves[0, 1:, 1:], axis=1) == pytest.approx([24e-3 * 4e-3] * 8)


def test_a_fixed_platform_stays_where_it_is():
    scene = SCENE.replace({"platform": None})
    found = bodies.bodies([scene])
    assert not found.origin.any()
    begin = start(platform_velocity=(0.0, 0.0, 0.0))._replace(platform_place=np.zeros((1, 3)))
    both = flown.pair(scene.flight.record(), found, begin)
    assert not both.platform.any() and flown.found(both).clearance[0] == pytest.approx(
        0.00525, abs=1e-9
    )
