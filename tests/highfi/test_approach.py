"""The speed at which payload and rails approach: a run stops above the speed of the contact search."""

import pytest

from tests.highfi.support import begun, tiny
from tipoff.highfi.contact.pads import FASTEST_APPROACH

SLENDER = {"payload__inertia": {"xx": 1e-4, "yy": 1.0, "zz": 1.0}}  # kg m2


def message(**changes) -> str:
    """The fault of a run at ignition; empty for none."""
    return begun(tiny(**changes)).recorded.message


@pytest.mark.parametrize("axis", ["y", "z"])
def test_a_slender_payload_may_turn_about_its_long_axes(axis):
    """Its pads move at 0.1 rad/s times 0.3 m. Control: its angular momentum over the least moment of
    inertia is a rate of 1000 rad/s, which would stop the run."""
    rate = 0.1  # rad/s
    assert message(**SLENDER, initial={"rate": {axis: rate}}) == ""
    # Control:
    reach = max(abs(pad.position[0]) for pad in tiny().pads)
    assert rate * SLENDER["payload__inertia"]["yy"] / SLENDER["payload__inertia"]["xx"] * reach > (
        FASTEST_APPROACH
    )


@pytest.mark.parametrize(
    "fast", [{"velocity": {"z": 10.5}}, {"rate": {"x": 200.0}}, {"rate": {"z": 200.0}}]
)
def test_a_fast_payload_stops_the_run(fast):
    assert "approach at up to" in message(**SLENDER, initial=fast)
