"""An absent effect is not in the compiled time loop."""

import subprocess
import sys

import pytest

from tests.highfi.support import COARSE, tiny
from tipoff import highfi
from tipoff.highfi.compiled import LAWS

DAMPED = {"rail__damping__ratios": [0.01, 0.01], "rail__damping__frequencies": ["500 Hz", "5 kHz"]}
SOFT = {"rail__mount_stiffness__normal": 1e13, "rail__mount_stiffness__shear": 5e12}
SPRING = {"kind": "spring", "preload": 5e3, "rate": 1e4, "stroke": 0.1}
FOUND = ("rail.damping",)  # the kernel with it is compiled by other tests too


def check(effect: str) -> None:
    """Read from the machine code: what the scene has is there, what it has not is not, and one
    change changes nothing else. Without contact there is no friction either. Gravity acts on a fixed
    platform only: with a free one everything falls together."""
    added = {
        "gravity": {"gravity__z": -9.80665},
        "hold_down": {"hold_down__release": 500.0},
        "pushers": {"thrust": SPRING},
        "rail.damping": DAMPED,
        "rail.mount_stiffness": SOFT,
    }
    fixed = {"platform": None} if effect == "gravity" else {}
    present = highfi.compiled_effects(tiny(**fixed), COARSE)
    assert present == {name: name not in (*added, *fixed) for name in LAWS}
    changed = highfi.compiled_effects(tiny(**fixed, **added.get(effect, {effect: None})), COARSE)
    also = {"friction"} if effect == "contact" else set()
    assert changed == {
        name: not value if name == effect or name in also else value
        for name, value in present.items()
    }


@pytest.mark.parametrize("effect", FOUND)
def test_absent_effect_is_not_compiled(effect):
    check(effect)


@pytest.mark.slow
@pytest.mark.parametrize("effect", sorted(set(LAWS) - set(FOUND)))
def test_each_other_effect_is_compiled_where_it_is_present_only(effect):
    check(effect)


def test_code_read_from_the_disk_cache_is_the_code_that_runs():
    """A second process finds the kernel compiled; the code it reads must not depend on the process
    that compiled it."""
    ask = (
        "from tipoff import highfi; from tests.highfi.support import COARSE, tiny; "
        "from tests.highfi.test_compiled import DAMPED; "
        "print(highfi.compiled_effects(tiny(**DAMPED), COARSE))"
    )
    here = f"{highfi.compiled_effects(tiny(**DAMPED), COARSE)}\n"
    there = subprocess.run([sys.executable, "-c", ask], check=True, capture_output=True, text=True)
    assert there.stdout == here
