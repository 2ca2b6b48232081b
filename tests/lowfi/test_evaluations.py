"""An absent effect is not evaluated."""

import numba
import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import lowfi
from tipoff.lowfi.single_run import SingleRun
from tipoff.lowfi.system import COUNTED
from tipoff.scenes import load

# How the effects that the scene lacks are added; a law that sticks stands in the place of the other.
ADDED = {
    "gravity": {"gravity.z": -9.80665},
    "hold_down": {"hold_down.release": 500.0},
    "pushers": {"thrust": {"kind": "spring", "preload": 5e3, "rate": 1e4, "stroke": 0.1}},
    "sticking": {
        "friction": {
            "law": "sticking",
            "static": 0.2,
            "dynamic": 0.2,
            "stiffness": 1e7,
            "damping": 1e4,
        }
    },
}
ON_RAILS = ("compliance", "modes", "thermal")  # effects that need the compliance of the rails
# Changes of the scene; each of these effects is in the same kernel as all others.
EVERY = ({}, {"friction": None}, {"contact": None, "friction": None}, {"thrust_offset": None})
EVERY += tuple(ADDED.values())


def evaluated(scene, *rest) -> dict[str, bool]:
    return {effect: count > 0 for effect, count in lowfi.evaluations(scene, *rest).items()}


@pytest.mark.parametrize("effect", [effect for effect in COUNTED if effect not in ON_RAILS])
def test_one_absent_effect_is_not_evaluated(effect):
    """What the scene has is evaluated, what it has not is not, and one change changes nothing else.
    Without contact there is no friction either. Gravity acts on a fixed platform only: with a free
    one everything falls together. Pushers have a line of action of their own. Under a thrust without
    offset no pad touches."""
    fixed = {"platform": None} if effect == "gravity" else {}
    base = load("clamped").condition("phi35").replace(fixed)
    present = evaluated(base)
    assert present == {name: name not in (*ADDED, *ON_RAILS, *fixed) for name in COUNTED}
    changed = evaluated(base.replace(ADDED.get(effect, {effect: None})))
    also = {
        "contact": {"friction"},
        "sticking": {"friction"},
        "pushers": {"thrust_offset"},
        "thrust_offset": {"contact", "friction"},
    }.get(effect, set())
    assert changed == {
        name: not value if name == effect or name in also else value
        for name, value in present.items()
    }


def test_gravity_that_all_bodies_share_is_not_evaluated():
    """Everything falls with a free platform, so no rate depends on it."""
    base = load("clamped").condition("phi35")
    assert evaluated(base.replace(ADDED["gravity"])) == evaluated(base)


def test_without_any_effect_nothing_is_evaluated():
    absent = dict.fromkeys(("friction", "platform", "contact", "thrust_offset"))
    assert not any(lowfi.evaluations(load("clamped").replace(absent)).values())


def test_temperature_is_evaluated_on_warm_rails_only():
    """Under springs, which need the places of warm walls, and under compliant contact."""
    cold, compliance = REFERENCE.condition("phi35"), reference_compliance()
    warm = cold.replace({"thermal.mean": 20.0})
    for walls in (compliance.rigid(), compliance):
        assert not evaluated(cold, None, walls)["thermal"]
        assert evaluated(warm, None, walls)["thermal"]


def test_modes_are_evaluated_where_there_are_any():
    scene, compliance = REFERENCE.condition("phi35"), reference_compliance()
    without, with_modes = (
        evaluated(scene, lowfi.Numerics(modes=count), compliance) for count in (0, 4)
    )
    assert with_modes == without | {"modes": True}
    assert without["compliance"] and not without["contact"]


def kernel_of(scene, compliance=None, modes: int = 0) -> tuple:
    """Types of the arguments of the time loop: each combination is a kernel of its own."""
    run = SingleRun(scene, lowfi.Numerics(modes=modes), compliance)
    return tuple(numba.typeof(argument) for argument in run.arguments(0))


def test_scenes_of_one_kind_of_contact_have_one_kernel():
    """With any effects, a fixed platform among them, any number of modes, and any law of contact.
    Control: another kind of contact, or degree of the patterns, has another one."""
    scene, compliance = REFERENCE, reference_compliance()
    springs = {kernel_of(scene.replace(change)) for change in EVERY}
    rubbing = [change for change in EVERY if "law" not in (change.get("friction") or {})]
    pressed = {
        kernel_of(scene.replace(change), compliance, modes)
        for change in rubbing
        for modes in (0, 4, 20)
        if "contact" not in change
    }
    assert len(springs) == len(pressed) == 1
    assert len(springs | pressed | {kernel_of(scene, compliance.of_degree(2))}) == 3
