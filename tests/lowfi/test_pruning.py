"""An absent effect is not in the compiled kernels."""

import os
import subprocess
import sys

import pytest

import lowfi
from scenes import load

COUNT = """
import numpy as np
from lowfi import equations, limits, state, system
from scenes import load, model
from scenes.effects.friction import coefficient_over_speed
def evaluate(scene):
    built = model.build(scene)
    records, begin = system.build(built), state.initial(built)
    felt = np.ones(16, dtype=np.bool_)
    equations.derivative(records, felt, None, 0.0, begin, np.empty_like(begin))
    limits.fastest_rate(records.contact, records.friction, None, records.faces, records.platform, records.payload, felt, None,
                        begin, 0.0)
    return len(coefficient_over_speed.signatures)
reference = load("reference")
print(evaluate(reference.replace({"friction": None, "platform": None})), evaluate(reference.replace({"platform": None})))
"""


def test_pruned_kernels_know_no_friction(tmp_path):
    """In a fresh interpreter and cache: without the table nothing compiles the friction law, with it something does."""
    ran = subprocess.run([sys.executable, "-c", COUNT], capture_output=True, text=True, timeout=300,
                         env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)})
    assert ran.returncode == 0, ran.stderr
    without, with_friction = map(int, ran.stdout.split())
    assert without == 0 and with_friction > 0


@pytest.mark.parametrize("absent", [(), ("friction", "platform", "contact", "thrust_offset")])
def test_compiled_effects_are_those_of_the_scene(absent):
    """Read from the machine code: contact, with it friction, platform and offset are there or not; gravity and sticking never."""
    found = lowfi.compiled_effects(load("reference").replace({name: None for name in absent}))
    assert found == {name: name not in (*absent, "gravity", "sticking") for name in found}
