"""An absent effect is not in the compiled kernels."""

import os
import subprocess
import sys

import pytest

from tests.lowfi.compliance import reference_compliance
from tipoff import lowfi
from tipoff.kernels.jit import contains
from tipoff.lowfi.compiled import LAWS, compiled_code
from tipoff.lowfi.contact.compliant import thermal_offset
from tipoff.scenes import load

# How the effects that the reference scene lacks are added; a law that sticks stands in the place of
# the other.
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
FOUND = ("sticking",)  # its time loop is compiled by other tests too
PACKAGE = b"6tipoff5lowfi7contact9compliant"  # as machine code names it
COUNT = """
import numba
import numpy as np
from tipoff.lowfi import state, system
from tipoff.lowfi.contact import step_limit
from tipoff.lowfi.dynamics import equations
from tipoff.mechanics import scene_model
from tipoff.scenes import load
from tipoff.scenes.effects.friction import coefficient_over_speed
@numba.njit
def call(records, felt, begin, out):
    equations.derivative(records, felt, None, False, 0.0, begin, out)
    step_limit.fastest_rate(records.contact, records, felt, None, begin, 0.0)
def evaluate(scene):
    built = scene_model.build(scene)
    records, begin = system.build(built), state.initial(built)
    call(records, np.ones(16, dtype=np.bool_), begin, np.empty_like(begin))
    return len(coefficient_over_speed.signatures)
reference = load("clamped")
print(evaluate(reference.replace({"friction": None, "platform": None})),
      evaluate(reference.replace({"platform": None})))
"""


@pytest.mark.slow
def test_pruned_kernels_have_no_friction(tmp_path):
    """In a fresh interpreter and cache: without the table nothing compiles the friction law, with
    it something does."""
    ran = subprocess.run(
        [sys.executable, "-c", COUNT],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
    )
    assert ran.returncode == 0, ran.stderr
    without, with_friction = map(int, ran.stdout.split())
    assert without == 0 and with_friction > 0


@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(effect, marks=[] if effect in FOUND else pytest.mark.slow)
        for effect in LAWS
        if effect not in ON_RAILS
    ],
)
def test_one_absent_effect_is_not_compiled(effect):
    """Read from the machine code: what the scene has is there, what it has not is not, and one
    change changes nothing else. Without contact there is no friction either. Gravity acts on a fixed
    platform only: with a free one everything falls together."""
    fixed = {"platform": None} if effect == "gravity" else {}
    base = load("clamped").replace(fixed)
    present = lowfi.compiled_effects(base)
    assert present == {name: name not in (*ADDED, *ON_RAILS, *fixed) for name in LAWS}
    changed = lowfi.compiled_effects(base.replace(ADDED.get(effect, {effect: None})))
    also = {"friction"} if effect in ("contact", "sticking") else set()
    assert changed == {
        name: not value if name == effect or name in also else value
        for name, value in present.items()
    }


def test_gravity_that_all_bodies_share_is_not_compiled():
    """Everything falls with a free platform, so no rate depends on it."""
    base = load("clamped")
    assert lowfi.compiled_effects(base.replace(ADDED["gravity"])) == lowfi.compiled_effects(base)


@pytest.mark.slow
def test_without_any_effect_nothing_of_them_is_compiled():
    found = lowfi.compiled_effects(
        load("clamped").replace(dict.fromkeys(("friction", "platform", "contact", "thrust_offset")))
    )
    assert not any(found.values())


@pytest.mark.slow
def test_temperature_is_compiled_for_a_warm_scene_only():
    """Contact laws need the places of warm walls; compliant contact has code of its own."""
    cold, compliance = load("clamped"), reference_compliance()
    warm = cold.replace({"thermal.mean": 20.0})
    assert lowfi.compiled_effects(warm, compliance=compliance.rigid()) == lowfi.compiled_effects(
        cold
    ) | {"thermal": True}
    assert contains(compiled_code(warm, compliance=compliance), thermal_offset.fill)
    assert not contains(compiled_code(cold, compliance=compliance), thermal_offset.fill)


def test_compliant_contact_replaces_the_contact_law():
    """Nothing of its package is in a kernel without it."""
    scene = load("clamped")
    assert lowfi.compiled_effects(
        scene, compliance=reference_compliance()
    ) == lowfi.compiled_effects(scene) | {"contact": False, "compliance": True}
    assert PACKAGE in compiled_code(scene, compliance=reference_compliance())
    assert PACKAGE not in compiled_code(scene)


def test_modes_of_the_rails_are_compiled_where_there_are_any():
    scene, compliance = load("clamped"), reference_compliance()
    without, with_modes = (
        lowfi.compiled_effects(scene, lowfi.Numerics(modes=count), compliance) for count in (0, 4)
    )
    assert with_modes == without | {"modes": True}
