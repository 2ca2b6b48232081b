"""The state at exit in the axes of RocketPy: against rotations of scipy, and against RocketPy
itself where it is installed."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tipoff.mechanics.outcome import Outcome
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.results import hand_over
from tipoff.scenes import SceneError, load
from tipoff.scenes.effects.hand_over import standing

TINY = load("tiny")
ATTITUDE, RATE = [0.02, -0.01, 0.03], [0.4, -0.2, 0.7]
POSITION, VELOCITY = [0.2, 1e-3, -2e-3], [24.0, 0.3, -0.1]
LEFT = Outcome(
    exit_time=0.02,
    exit_position=POSITION,
    exit_velocity=VELOCITY,
    exit_attitude=ATTITUDE,
    exit_rate=RATE,
)


def on_the_ground(inclination: float, heading: float, roll: float = 0.0, **table) -> dict:
    """A resolved scene on a rail whose +Z is turned by ``roll`` from its upper side (degrees)."""
    up = np.radians([inclination, roll])
    gravity = -9.8 * np.array(
        [
            np.sin(up[0]),
            np.cos(up[0]) * np.sin(up[1]),
            np.cos(up[0]) * np.cos(up[1]),
        ]
    )
    keys = {f"gravity.{axis}": float(value) for axis, value in zip("xyz", gravity)}
    keys |= {"hand_over.heading": float(np.radians(heading))}
    keys |= {f"hand_over.{key}": value for key, value in table.items()}
    return TINY.replace(keys).resolved()


def of_rocketpy(scene: dict, found=LEFT) -> np.ndarray:
    return hand_over.initial_solution(hand_over.at_exit(found), standing(scene))


def of_the_rail(inclination: float, heading: float, roll: float = 0.0) -> Rotation:
    """From the axes of RocketPy's body on the rail to inertial ones: its Euler angles 3-1-3, with
    the upper side of the rail along body y, as our Z is."""
    tilted = Rotation.from_euler("ZXZ", [-heading, inclination - 90.0, 180.0], degrees=True)
    return tilted * Rotation.from_euler("z", roll, degrees=True)


@pytest.mark.parametrize(
    "inclination, heading, roll", [(85, 133, 0), (84, -20, 30), (20, 250, -75), (-5, 0, 180)]
)
def test_the_state_is_that_of_euler_angles(inclination, heading, roll):
    """Control: the same with the heading from East, as mathematicians count it."""
    scene = on_the_ground(inclination, heading, roll, elevation=1400.0)
    found = of_rocketpy(scene)
    rail = of_the_rail(inclination, heading, roll)
    ahead = 0.5 * EXIT_WINDOW
    # our axes y, z, x are those of RocketPy on the rail
    cyclic = [1, 2, 0]
    own = Rotation.from_rotvec(np.array(ATTITUDE)[cyclic])
    own *= Rotation.from_rotvec(ahead * np.array(RATE)[cyclic])
    place = rail.apply((np.array(POSITION) + ahead * np.array(VELOCITY))[cyclic])
    np.testing.assert_allclose(found[1:4] - place, [0.0, 0.0, 1400.0], atol=1e-12)
    np.testing.assert_allclose(found[4:7], rail.apply(np.array(VELOCITY)[cyclic]), atol=1e-12)
    e = found[7:11]
    turned = Rotation.from_quat([e[1], e[2], e[3], e[0]])
    assert ((rail * own).inv() * turned).magnitude() < 1e-12
    np.testing.assert_allclose(found[11:], [-0.2, 0.7, 0.4], atol=1e-15)
    assert found[0] == pytest.approx(0.0201) and e[0] >= 0.0
    other = of_the_rail(inclination, 90.0 - heading, roll)
    assert np.abs(other.apply(np.array(VELOCITY)[cyclic]) - found[4:7]).max() > 0.1


def test_a_payload_along_an_upright_rail_flies_up_and_turns_about_its_nose():
    found = of_rocketpy(TINY.resolved(), LEFT._replace(exit_attitude=[0.0] * 3))
    np.testing.assert_allclose(found[4:7], [-0.3, 0.1, 24.0], atol=1e-12)  # +Z faces South
    assert found[13] == RATE[0]


def test_the_dry_mass_centre_moves_with_the_body():
    scene, ahead = on_the_ground(70.0, 45.0), 0.8
    found = of_rocketpy(scene)
    moved = of_rocketpy(on_the_ground(70.0, 45.0, dry_mass_centre=ahead))
    e = found[7:11]
    turned = Rotation.from_quat([e[1], e[2], e[3], e[0]])
    arm, rate = turned.apply([0.0, 0.0, ahead]), turned.apply(found[11:])
    np.testing.assert_allclose(moved[1:4] - found[1:4], arm, atol=1e-12)
    np.testing.assert_allclose(moved[4:7] - found[4:7], np.cross(rate, arm), atol=1e-12)
    np.testing.assert_array_equal(moved[7:], found[7:])


def test_what_is_assumed_is_said():
    assert len(standing(TINY.resolved()).assumed) == 5
    stated = on_the_ground(80.0, 10.0, elevation=0.0, dry_mass_centre=0.0)
    assert standing(stated).assumed == ()
    upright = TINY.replace({"gravity.x": "-9.81 m/s**2"}).resolved()
    assert any("upper side" in words for words in standing(upright).assumed)
    given = TINY.replace({"hand_over.inclination": "30 deg"}).resolved()
    assert np.degrees(standing(given).inclination) == pytest.approx(30.0)


@pytest.mark.parametrize("inclination, fits", [("80.05 deg", True), ("80.2 deg", False)])
def test_an_inclination_that_is_not_that_of_gravity_is_refused(inclination, fits):
    scene = on_the_ground(80.0, 0.0)
    scene["hand_over"]["inclination"] = np.radians(float(inclination.split()[0]))
    if fits:
        standing(scene)
    else:
        with pytest.raises(
            SceneError, match="hand_over.inclination: given 80.2 deg, expected 80 d"
        ):
            standing(scene)


def test_no_ejection_depends_on_the_table():
    other = TINY.replace({"hand_over.heading": "10 deg"})
    assert other.hash == TINY.hash and "hand_over" not in TINY.resolved()


def test_mean_and_covariance_are_those_of_drawn_states():
    """Control: the mean of quaternions is no unit quaternion, and their covariance has no inverse."""
    rng, count = np.random.default_rng(5), 40_000
    spread = np.array([0.1, 0.2, 0.3])
    own = rng.normal(size=(count, 3)) * spread
    middle = Rotation.from_rotvec([0.5, -0.2, 1.0])
    turned = middle * Rotation.from_rotvec(own)
    rates = rng.normal(size=(count, 3)) + own  # they go with the attitude
    rest = rng.normal(size=(count, 7))
    e = turned.as_quat(scalar_first=True, canonical=True)
    mean, covariance = hand_over.mean_and_covariance(np.hstack([rest, e, rates]))
    assert (middle.inv() * Rotation.from_quat(mean[7:11], scalar_first=True)).magnitude() < 0.01
    assert np.linalg.norm(mean[7:11]) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(np.diag(covariance)[7:10], spread**2, rtol=0.05)
    np.testing.assert_allclose(np.diag(covariance[7:10, 10:]), spread**2, rtol=0.15)
    np.testing.assert_allclose(covariance[:7, :7], np.cov(rest, rowvar=False), atol=1e-12)
    assert np.linalg.cond(covariance) < 1e4
    assert np.linalg.norm(e.mean(axis=0)) < 0.99


@pytest.mark.parametrize("kind", hand_over.FORMATS)
def test_files_have_the_same_numbers(kind, tmp_path):
    scene, file = on_the_ground(85.0, 133.0), tmp_path / "exit"
    hand_over.write(kind, file, scene, LEFT)
    if kind == "csv":
        titles, numbers = file.read_text().splitlines()
        assert titles.startswith("t [s],x [m],") and titles.endswith("w3 [rad/s]")
        found = [float(text) for text in numbers.split(",")]
    else:
        found = json.loads(file.read_text())["initial_solution"]
    assert found == of_rocketpy(scene).tolist()


@pytest.mark.parametrize("kind", hand_over.FORMATS)
def test_files_of_many_cases(kind, tmp_path):
    scene, file = on_the_ground(85.0, 133.0), tmp_path / "exits"
    rng = np.random.default_rng(2)
    many = SimpleNamespace(
        exit_time=0.02 + 1e-4 * rng.normal(size=9),
        **{
            name: np.array(getattr(LEFT, name)) + 1e-3 * rng.normal(size=(9, 3))
            for name in ("exit_position", "exit_velocity", "exit_attitude", "exit_rate")
        },
    )
    hand_over.write(kind, file, scene, many)
    each = [
        of_rocketpy(
            scene, SimpleNamespace(**{key: value[case] for key, value in vars(many).items()})
        )
        for case in range(9)
    ]
    mean, covariance = hand_over.mean_and_covariance(np.array(each))
    if kind == "csv":
        rows = [line.split(",") for line in file.read_text().splitlines()]
        assert [row[0] for row in rows[3:]] == rows[2][1:] == list(hand_over.MINIMAL)
        found = [float(text) for text in rows[1][1:]], [[float(x) for x in r[1:]] for r in rows[3:]]
    else:
        content = json.loads(file.read_text())
        assert content["cases"] == 9
        found = content["mean"], content["covariance"]
    np.testing.assert_allclose(found[0], mean, rtol=1e-12)
    np.testing.assert_allclose(found[1], covariance, rtol=1e-9, atol=1e-20)


def test_what_is_refused(tmp_path):
    with pytest.raises(SceneError, match="given 'xml', expected rocketpy or csv"):
        hand_over.write("xml", tmp_path / "exit", TINY.resolved(), LEFT)
    with pytest.raises(SceneError, match="expected a run that left the rail"):
        hand_over.at_exit(Outcome())
    with pytest.raises(SceneError, match="gravity.x: given a distribution"):
        hand_over.require_fixed(["payload.mass", "gravity.x"])
    assert not list(tmp_path.iterdir())


def test_rocketpy_starts_from_the_state():
    """Its rail has the axis of ours, and a flight begins with our velocity and rates."""
    rocketpy = pytest.importorskip("rocketpy", reason="rocketpy is not installed")
    environment = rocketpy.Environment(elevation=1400.0)
    motor = rocketpy.EmptyMotor()
    rocket = rocketpy.Rocket(
        radius=0.1,
        mass=10.0,
        inertia=(1.0, 1.0, 0.1),
        power_off_drag=0.4,
        power_on_drag=0.4,
        center_of_mass_without_motor=0.0,
        coordinate_system_orientation="tail_to_nose",
    )
    rocket.add_motor(motor, position=0.0)
    keys = {"rocket": rocket, "environment": environment, "rail_length": 1.0, "max_time": 0.1}
    state = of_rocketpy(on_the_ground(85.0, 133.0, elevation=1400.0)).tolist()
    flight = rocketpy.Flight(**keys, initial_solution=state)
    np.testing.assert_allclose(flight.solution[0], state, rtol=1e-15)
    assert flight.x(state[0]) == pytest.approx(state[1])
    np.testing.assert_allclose(
        [flight.w1(state[0]), flight.w2(state[0]), flight.w3(state[0])], state[11:], rtol=1e-9
    )
    on_rail = rocketpy.Flight(**keys, inclination=85.0, heading=133.0).solution[0]
    axis = Rotation.from_quat(on_rail[7:11], scalar_first=True).apply([0.0, 0.0, 1.0])
    aligned = of_rocketpy(
        on_the_ground(85.0, 133.0), LEFT._replace(exit_attitude=[0.0] * 3, exit_rate=[0.0] * 3)
    )
    ours = Rotation.from_quat(aligned[7:11], scalar_first=True).apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(ours, axis, atol=1e-12)
