"""An absent effect is not in the compiled time loop."""

import subprocess
import sys

import pytest

import highfi
from tests.highfi.support import COARSE, tiny


@pytest.mark.parametrize("absent", ["friction", "platform"])
def test_absent_effect_is_not_compiled(absent):
    present = highfi.compiled_effects(tiny(), COARSE)
    without = highfi.compiled_effects(tiny(**{absent: None}), COARSE)
    assert present[absent] and not without[absent]
    assert not present["gravity"]
    assert {name: value for name, value in present.items() if name != absent} == {
        name: value for name, value in without.items() if name != absent}


def test_code_read_from_the_disk_cache_is_the_code_that_runs():
    """A second process finds the kernel compiled; what it reads must not depend on who compiled it."""
    ask = "import highfi; from tests.highfi.support import COARSE, tiny; print(highfi.compiled_effects(tiny(friction=None), COARSE))"
    said = [subprocess.run([sys.executable, "-c", ask], check=True, capture_output=True, text=True).stdout for _ in range(2)]
    assert said[0] == said[1] == f"{highfi.compiled_effects(tiny(friction=None), COARSE)}\n"
