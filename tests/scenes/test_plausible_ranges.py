"""Single values at and beyond the bounds of what is plausible, and walls that let a payload turn."""

import math

import pytest

from tests.scenes.support import CONTACT, FRICTION, small
from tipoff.scenes import load, parse
from tipoff.scenes.plausible_ranges import CLEARANCE, RANGES, TURN, warnings

TABLES = {
    "friction": FRICTION,
    "contact": {
        "law": "hunt-crossley",
        "clearance": "0.1 mm",
        "stiffness": "70000 N/mm**1.5",
        "dissipation": "0.3 s/m",
        "pad_layer": {"thickness": "1 mm", "youngs_modulus": "2 GPa"},
    },
    "rail__damping": {"ratios": [0.01, 0.01], "frequencies": ["500 Hz", "5 kHz"]},
}


def said(key, value):
    """What is said about one key of a scene that has each of them, with this value."""
    value = [value, value] if key == "rail.damping.ratios" else value
    scene = parse(small(**TABLES)).replace({key: value})
    return [text for text in warnings(scene) if text.startswith(f"{key}: ")]


@pytest.mark.parametrize("key", RANGES)
def test_a_value_on_its_bound_is_plausible_and_one_beyond_is_not(key):
    for bound, beyond in ((RANGES[key].least, 0.99), (RANGES[key].most, 1.01)):
        assert said(key, bound) == []
        if bound > 0.0:  # below zero a value is refused
            texts = said(key, beyond * bound)
            assert texts and all("plausible" in text for text in texts)


@pytest.mark.parametrize(
    "key, slip, right",
    [
        ("friction.static", 9.0, 0.9),
        ("rail.material.youngs_modulus", "72 MPa", "72 GPa"),
        ("rail.material.density", "2.81 kg/m**3", "2.81 g/cm**3"),
        ("contact.dissipation", "0.3 s/mm", "0.3 s/m"),
    ],
)
def test_slips_are_named(key, slip, right):
    assert len(said(key, slip)) == 1 and said(key, right) == []


@pytest.mark.parametrize("axis", ["", "_y", "_z"])
@pytest.mark.parametrize("share, warned", [(1.0, False), (1.01, True)])
def test_a_clearance_is_judged_by_the_pads(axis, share, warned):
    scene = load("reference").replace({f"contact.clearance{axis}": share * CLEARANCE * 0.016})
    assert any("a tenth of a pad's shortest side" in text for text in warnings(scene)) == warned


@pytest.mark.parametrize("share, warned", [(0.99, False), (1.01, True)])
def test_pads_are_judged_by_how_far_they_let_the_payload_turn(share, warned):
    """At one place along X alone the length of a pad holds. Controls: a second station as far away
    holds the same pads, and a payload without pads on one side is not judged."""
    clearance = 0.05e-3
    length = 2.0 * clearance / (share * TURN)
    one = load("reference").replace(
        {"contact.clearance": clearance}
        | {f"pads.{pad}.length": length for pad in range(8)}
        | {f"pads.{pad}.position.0": 0.0 for pad in range(8)}
    )
    texts = [text for text in warnings(one) if "allow the payload to turn" in text]
    assert bool(texts) == warned
    assert all(f"{math.degrees(share * TURN):.3g} deg" in text for text in texts)
    apart = one.replace({f"pads.{pad}.position.0": 0.08 for pad in range(4)})
    assert not any("allow the payload to turn" in text for text in warnings(apart))
    bare = parse(small(contact=CONTACT | {"clearance": "1.6 mm"}))
    assert not any("allow the payload to turn" in text for text in warnings(bare))
