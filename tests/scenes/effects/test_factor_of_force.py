"""The factor of a measured thrust and of a spring, in a scene and in a file of errors."""

import numpy as np
import pytest

import tipoff
from tipoff.faults import SceneError
from tipoff.scenes import uncertainty

POINTS = {
    "kind": "measured",
    "points": [[0.0, 0.0], [10.0, 1500.0], [20.0, 0.0]],
    "time_unit": "ms",
    "thrust_unit": "N",
}
FREE = tipoff.load("tiny").replace({"contact": None, "friction": None, "gravity": None})


def with_file(folder, **more):
    path = folder / "push.csv"
    path.write_text("travel [mm],force [N]\n0,200\n5,120\n20,40\n")
    return FREE.replace({"thrust": {"kind": "spring", "file": str(path), "arm": "0.1 m", **more}})


def test_a_measured_thrust_has_its_factor_of_the_impulse():
    thrusts = [FREE.replace({"thrust": POINTS | more}).thrust for more in ({}, {"factor": 1.2})]
    assert [each.requested() for each in thrusts] == pytest.approx([15.0, 18.0])
    assert "factor" not in thrusts[0].model_dump(mode="json")
    again = FREE.replace({"thrust": POINTS | {"factor": 1.2}}).resolved()
    assert again["thrust"]["factor"] == 1.2


def test_a_scaled_thrust_is_the_thrust_of_scaled_points():
    """Bit by bit in the law, so it has the same runs. The control: the factor changes them."""
    scaled = FREE.replace({"thrust": POINTS | {"factor": 2.0}}).thrust
    points = POINTS | {"points": [[0.0, 0.0], [10.0, 3000.0], [20.0, 0.0]]}
    stated = FREE.replace({"thrust": points}).thrust
    assert scaled.contents()[1] == stated.contents()[1]
    assert scaled.contents()[1] != FREE.replace({"thrust": POINTS}).thrust.contents()[1]


@pytest.mark.parametrize("kind", ["file", "numbers"])
def test_a_spring_has_its_factor_of_the_energy(tmp_path, kind):
    numbers = {"kind": "spring", "preload": "200 N", "rate": "4 N/mm", "stroke": "20 mm"}

    def energy(**more):
        if kind == "file":
            return with_file(tmp_path, **more).thrust.energy()
        return FREE.replace({"thrust": numbers | more}).thrust.energy()

    assert energy(factor=0.8) == pytest.approx(0.8 * energy())


def test_a_factor_lowers_the_friction_that_a_spring_overcomes(tmp_path):
    with_file(tmp_path, friction="30 N")
    with pytest.raises(SceneError, match="friction"):
        with_file(tmp_path, friction="30 N", factor=0.5)


@pytest.mark.parametrize("table", ["vary", "factor"])
def test_a_file_of_errors_varies_it(tmp_path, table):
    """Of a free payload on a fixed platform the impulse is in proportion to the factor."""
    errors = {
        "cases": 20,
        table: {"thrust.factor": {"distribution": "uniform", "low": "0.9", "high": "1.1"}},
    }
    for scene in (FREE.replace({"thrust": POINTS}), with_file(tmp_path)):
        found = uncertainty.parse(errors, scene)
        drawn = found.overrides({"thrust.factor": [0.9, 1.1]})
        assert drawn == {"thrust.factor": [0.9, 1.1]}


def test_the_speed_of_an_ensemble_follows_the_factor():
    strong = POINTS | {"points": [[0.0, 0.0], [10.0, 6000.0], [20.0, 0.0]]}
    scene = FREE.replace({"thrust": strong, "platform": None, "duration": None})
    cases = tipoff.ensemble(scene, {"thrust.factor": np.array([1.0, 1.1])})
    slow, fast = cases.velocity.values[:, 0]
    assert fast / slow == pytest.approx(1.1, rel=2e-3)
