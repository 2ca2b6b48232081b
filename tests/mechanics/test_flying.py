"""A velocity that payload, rails and platform share changes nothing in any model, nor does the place of the
scene."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, tiny, whole
from tests.lowfi.compliance import reference_compliance
from tipoff import highfi, lowfi
from tipoff.scenes import load
from tipoff.scenes.scene import Scene

REFERENCE, TINY = load("clamped").condition("phi35"), tiny()
# m/s, the last one 7.5 km/s across the axes
FLIGHTS = [(1000.0, 0.0, 0.0), (0.0, -5000.0, 0.0), (4330.1, 3061.9, -5303.3)]
AXES = "xyz"


def flying(scene: Scene, velocity: tuple) -> Scene:
    return scene.replace(
        {
            f"initial.{body}velocity.{axis}": value
            for body in ("", "platform_")
            for axis, value in zip(AXES, velocity)
        }
    )


def assert_same(flown, rest, velocity: tuple) -> None:
    """Rates, times and what remains of velocities and places, to 1e-9 of the payload's own."""
    assert flown.status == rest.status == "exited" and flown.cost["steps"] == rest.cost["steps"]
    assert flown.outcome.rate == pytest.approx(rest.outcome.rate, rel=1e-9)
    assert flown.outcome.exit_time == pytest.approx(rest.outcome.exit_time, rel=1e-9)
    speed = np.linalg.norm(rest.outcome.velocity)
    assert (
        np.abs(np.subtract(flown.outcome.velocity, velocity) - rest.outcome.velocity).max()
        <= 1e-9 * speed
    )
    at_exit = np.subtract(flown.outcome.exit_velocity, velocity)
    assert np.abs(at_exit - rest.outcome.exit_velocity).max() <= 1e-9 * speed
    assert flown.outcome.exit_rate == pytest.approx(rest.outcome.exit_rate, rel=1e-9)
    way = np.multiply.outer(rest.time, velocity)
    for name, moved in (
        ("position", way),
        ("platform_position", way),
        ("velocity", velocity),
        ("platform_velocity", velocity),
    ):
        assert np.abs(getattr(flown, name) - moved - getattr(rest, name)).max() <= 1e-9, name
    assert np.abs(flown.rate - rest.rate).max() <= 1e-9 * np.abs(rest.rate).max()
    for name in ("energy_error", "transverse_energy_error"):
        assert flown.checks[name] == pytest.approx(rest.checks[name], rel=1e-3), name
    here = np.add(rest.outcome.exit_position, np.multiply(velocity, rest.outcome.exit_time))
    assert np.abs(np.subtract(flown.outcome.exit_position, here)).max() <= 1e-9
    moving = np.add(rest.outcome.exit_platform_velocity, velocity)
    assert np.abs(np.subtract(flown.outcome.exit_platform_velocity, moving)).max() <= 1e-9


def on_springs(scene: Scene):
    return lowfi.run(scene, "springs")


def on_compliance(scene: Scene):
    return lowfi.run(scene, compliance=reference_compliance())


def in_finite_elements(scene: Scene):
    return whole() if scene is TINY else highfi.run(scene, COARSE)


@pytest.mark.case("O50")
@pytest.mark.parametrize(
    ("solve", "scene", "velocity"),
    [
        *((on_springs, REFERENCE, velocity) for velocity in FLIGHTS),
        *((on_compliance, REFERENCE, velocity) for velocity in FLIGHTS),
        pytest.param(in_finite_elements, TINY, FLIGHTS[0], marks=pytest.mark.slow),
        (in_finite_elements, TINY, FLIGHTS[-1]),
    ],
)
def test_a_uniform_velocity_changes_nothing(solve, scene, velocity):
    """The ledgers close as at rest."""
    assert_same(solve(flying(scene, velocity)), solve(scene), velocity)


def test_rows_of_an_ensemble_are_single_runs():
    velocity = FLIGHTS[-1]
    rows = [{"thrust_offset.misalignment.radial": value} for value in (0.2, 1.1)]
    flown, rest = (
        lowfi.run_many(scene, rows, "springs") for scene in (flying(REFERENCE, velocity), REFERENCE)
    )
    assert flown.rate.values == pytest.approx(rest.rate.values, rel=1e-9)
    assert np.abs(flown.velocity.values - velocity - rest.velocity.values).max() <= 1e-9
    for number, row in enumerate(rows):
        alone = lowfi.run(flying(REFERENCE, velocity).replace(row), "springs")
        for name in (
            "velocity",
            "rate",
            "exit_position",
            "exit_platform_position",
            "exit_platform_velocity",
        ):
            assert flown[name].values[number].tolist() == getattr(alone.outcome, name), name
        assert flown.direction_error.values[number] == alone.outcome.direction_error


def test_origin():
    """Payload, rails and platform 100 km along the axis: the change is no larger than that of a
    shift by the rounding of places, 1 nm."""

    def moved(way: float):
        rail = REFERENCE.rail
        return lowfi.run(
            REFERENCE.replace(
                {
                    "initial.position.x": way,
                    "rail.start": rail.start + way,
                    "rail.end": rail.end + way,
                    "platform.mass_centre.x": REFERENCE.platform.mass_centre.x + way,
                }
            ),
            "springs",
        )

    def shift(way: float) -> float:
        found = lowfi.run(REFERENCE.replace({"initial.position.x": way}), "springs")
        return float(np.abs(np.subtract(found.outcome.rate, rest.outcome.rate)).max())

    rest, far = lowfi.run(REFERENCE, "springs"), moved(1e5)
    assert 0.0 < np.abs(np.subtract(far.outcome.rate, rest.outcome.rate)).max() <= shift(1e-9)


@pytest.mark.case("O50")
def test_a_platform_that_recoils_is_not_the_frame():
    """Control: a velocity of the payload alone, as large as a thousandth of a flight, is no shared
    one."""
    found = lowfi.run(REFERENCE.replace({"initial.velocity.x": 1.0}), "springs")
    assert found.outcome.rate != pytest.approx(
        lowfi.run(REFERENCE, "springs").outcome.rate, rel=1e-3
    )
