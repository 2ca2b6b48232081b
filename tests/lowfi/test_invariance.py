"""Steps are those of the motion: not of the order of the pads, nor of a force that all bodies share.

The first difference is one of rounding. Steps that follow an error estimate continuously make it
grow up to the tolerance within a few milliseconds of contact.
"""

import numpy as np
import pytest

from tests.loops import COARSE
from tipoff import highfi, lowfi, scenes
from tipoff.calibration import rail_compliance
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.scene import Scene

ROUNDING = 1e-12  # relative
ORDERS = {
    "reversed": [7, 6, 5, 4, 3, 2, 1, 0],
    "mixed": [6, 0, 3, 5, 1, 7, 2, 4],
}
SHARED = {
    "down": {"gravity.z": -9.81},
    "oblique": {"gravity.x": 3.0, "gravity.y": -9.81, "gravity.z": 1.0},
    "launch": {"gravity.x": 9810.0},
}


def reordered(scene: Scene, order: list[int]) -> Scene:
    """``scene`` with its pads listed in another order."""
    raw = scene.resolved()
    raw["pads"] = [raw["pads"][number] for number in order]
    return scenes.parse(raw, bare_numbers_are_si=True)


def settled(scene: Scene, model: str, compliance: RailCompliance | None = None) -> np.ndarray:
    """Settled rate (rad/s) on rails without modes."""
    found = lowfi.run(scene, model, compliance=compliance, numerics=lowfi.Numerics(modes=0))
    assert found.status == "exited", found.message
    return np.array(found.outcome.rate)


@pytest.mark.parametrize("order", ORDERS.values(), ids=ORDERS)
@pytest.mark.parametrize("condition", ["phi35", "phi60"])
@pytest.mark.parametrize("model", [COMPLIANT, SPRINGS])
def test_the_order_of_the_pads_does_not_matter(model, condition, order):
    """Rates agree to rounding. Control: a payload heavier by one part in 1e9 is seen."""
    nominal = scenes.load("tiny").condition(condition)
    rates = []
    for scene in (nominal, reordered(nominal, order)):
        found = (
            rail_compliance.compliance(scene, COARSE.element_size) if model == COMPLIANT else None
        )
        rates.append(settled(scene, model, found))
    assert abs(rates[1] - rates[0]).max() <= ROUNDING * abs(rates[0]).max()
    heavier = nominal.replace({"payload.mass": nominal.payload.mass * (1.0 + 1e-9)})
    found = rail_compliance.compliance(heavier, COARSE.element_size) if model == COMPLIANT else None
    assert abs(settled(heavier, model, found) - rates[0]).max() > ROUNDING * abs(rates[0]).max()


@pytest.mark.parametrize("shared", SHARED.values(), ids=SHARED)
def test_a_force_that_all_bodies_share_changes_no_relative_motion(shared):
    """Payload and free platform fall together: rates are the same bits, and positions and velocities
    differ by the free fall."""
    scene = scenes.load("tiny").condition("phi35")
    fall = np.array([shared.get(f"gravity.{axis}", 0.0) for axis in "xyz"])
    found = rail_compliance.compliance(scene, COARSE.element_size)
    numerics = lowfi.Numerics(modes=0)
    still, falling = (
        lowfi.run(one, COMPLIANT, compliance=found, numerics=numerics)
        for one in (scene, scene.replace(shared))
    )
    require_fall(still, falling, fall)


@pytest.mark.parametrize("shared", [SHARED["oblique"]], ids=["oblique"])
def test_the_same_in_the_reference(shared):
    scene = scenes.load("tiny").condition("phi35")
    fall = np.array([shared.get(f"gravity.{axis}", 0.0) for axis in "xyz"])

    still, falling = (highfi.run(one, COARSE) for one in (scene, scene.replace(shared)))
    require_fall(still, falling, fall)


def test_a_body_on_fixed_rails_does_fall():
    """Control: without a free platform the same force acts on the payload alone."""
    scene = scenes.load("tiny").condition("phi35").replace({"platform": None})
    still, falling = (settled(one, SPRINGS) for one in (scene, scene.replace({"gravity.z": -9.81})))
    assert abs(falling - still).max() > 1e-3


def require_fall(still, falling, fall: np.ndarray) -> None:
    """``falling`` (a run) is ``still`` with the free ``fall`` (3,) m/s2 added, mean velocities over
    the settled window included."""
    assert falling.status == still.status == "exited"
    assert np.array_equal(falling.rate, still.rate)
    assert np.array_equal(falling.pad_force, still.pad_force)
    assert falling.outcome.rate == still.outcome.rate
    assert falling.outcome.exit_time == still.outcome.exit_time
    time = still.time[:, None]
    for way, of in (("position", 0.5 * time**2), ("velocity", time)):
        for body in (way, f"platform_{way}"):
            added = getattr(falling, body) - getattr(still, body)
            assert added == pytest.approx(of * fall, abs=1e-13 * (1.0 + abs(fall).max()))
    gained = np.subtract(falling.outcome.velocity, still.outcome.velocity)
    middle = still.outcome.window_start + 1e-3  # of a window of 2 ms
    assert gained == pytest.approx(middle * fall, rel=1e-12, abs=1e-13 * (1.0 + abs(fall).max()))
    gained = np.subtract(falling.outcome.exit_velocity, still.outcome.exit_velocity)
    middle = still.outcome.exit_time + 1e-4  # of a window of 0.2 ms
    assert gained == pytest.approx(middle * fall, rel=1e-12, abs=1e-13 * (1.0 + abs(fall).max()))
    moved = np.subtract(falling.outcome.exit_position, still.outcome.exit_position)
    at_exit = 0.5 * still.outcome.exit_time**2 * fall
    assert moved == pytest.approx(at_exit, abs=1e-13 * (1.0 + abs(fall).max()))
