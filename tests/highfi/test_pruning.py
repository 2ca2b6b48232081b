"""An absent effect is not in the compiled time loop."""

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
