"""An absent effect is not evaluated, and needs no kernel of its own."""

import functools

import numba
import pytest

from tests.highfi.contact.test_deformed_wall import scene as pad_on_a_wall
from tests.highfi.contact.test_deformed_wall import wall
from tests.highfi.support import COARSE, SOON, loop_on, parts, tiny
from tests.pushed import SPRING
from tipoff import highfi
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.state.records import COUNTED

# How the effects that the scene lacks are added.
ADDED = {
    "gravity": {"gravity__z": -9.80665},
    "hold_down": {"hold_down__release": 500.0},
    "pushers": {"thrust": SPRING},
    "rail.damping": {
        "rail__damping__ratios": [0.01, 0.01],
        "rail__damping__frequencies": ["500 Hz", "5 kHz"],
    },
    "rail.mount_stiffness": {
        "rail__mount_stiffness__normal": 1e13,
        "rail__mount_stiffness__shear": 5e12,
    },
}
STILL = set(ADDED) - {"pushers"}  # springs take no hold-down
# Pads touch soon, and the payload does not move along the rail.
TOUCH = SOON | {"initial": {"velocity": {"y": 0.1, "z": 0.02}}}
EVERY = (
    {},
    *ADDED.values(),
    *({name: None} for name in ("contact", "friction", "thrust_offset")),
    {"thermal__mean": 20.0},
    {"mass_offset__eccentricity__axial": 1e-3},
    {"thrust": {"kind": "constant", "force": 10.0, "duration": 1e-3}},
    {name: value for effect in STILL for name, value in ADDED[effect].items()},
    {"contact": None, "friction": None, "thrust_offset": None},
)


@functools.cache
def evaluated(*changes: str) -> dict[str, bool]:
    """Which effects are evaluated with one of ``ADDED``, without a table of this name, or neither."""
    given = {key: value for name in changes for key, value in ADDED.get(name, {name: None}).items()}
    found = highfi.run(tiny(**TOUCH | given), COARSE).cost["evaluations"]
    assert list(found) == list(COUNTED)
    return {effect: count > 0 for effect, count in found.items()}


@pytest.mark.parametrize("effect", COUNTED)
def test_one_absent_effect_is_not_evaluated(effect):
    """What the scene has is evaluated, what it has not is not, and one change changes nothing else.
    Without contact there is no friction either. Gravity acts on a fixed platform only: with a free
    one everything falls together."""
    fixed = ("platform",) if effect == "gravity" else ()
    present = evaluated(*fixed)
    assert present == {name: name not in (*ADDED, *fixed) for name in COUNTED}
    also = {"friction"} if effect == "contact" else set()
    assert evaluated(*fixed, effect) == {
        name: not value if name == effect or name in also else value
        for name, value in present.items()
    }


def test_gravity_that_all_bodies_share_is_not_evaluated():
    """Everything falls with a free platform, so no rate depends on it."""
    assert evaluated("gravity") == evaluated()


def test_any_number_of_threads_counts_alike():
    """Effects of blocks and of groups, which threads share: each block has damping once a step."""
    scene = tiny(**TOUCH, **ADDED["rail.damping"], **ADDED["rail.mount_stiffness"])
    one, two = (highfi.run(scene, COARSE, threads=count).cost for count in (1, 2))
    assert one["evaluations"] == two["evaluations"]
    for effect in ("rail.damping", "rail.mount_stiffness"):
        assert 0 < one["evaluations"][effect] <= one["steps_taken"]


def kernel_of(stepper: Stepper) -> tuple:
    """Types of the arguments of the time loop: each combination is a kernel of its own."""
    return tuple(numba.typeof(argument) for argument in stepper.arguments())


def kernel_for(changes: dict) -> tuple:
    scene = tiny(**changes)
    system, stepping, rails = parts(scene, COARSE)
    return kernel_of(Stepper(set_up(scene, system, stepping, 1, rails)))


def test_three_kernels_serve_all_scenes():
    """One for each kind of elements, on a free and on a fixed platform, with any effects."""
    found = {
        kernel_for({**change, **platform})
        for change in EVERY
        for platform in ({}, {"platform": None})
    }
    assert len(found) == 1
    for kind in ("twisted", "tetrahedra"):
        for platform in ({}, {"platform": None}):
            given = pad_on_a_wall(1e-6).replace(platform)
            found.add(kernel_of(loop_on(given, wall(kind)).stepper))
    assert len(found) == 3
