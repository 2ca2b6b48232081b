"""The drawing from the open end has the errors across the axis at their clock angles."""

import math
import re

import pytest

from tipoff.scenes import drawing, load
from tipoff.sketch import HEIGHT, WIDTH

_DOT = re.compile(r'class="dot" cx="([\d.]+)" cy="([\d.]+)"')


def dots(scene):
    """(size in px, clock angle from +Z towards +Y in deg) of each point in the view from the open end."""
    end = str(drawing.launcher(scene)).split("<svg")[2]
    places = [(float(x) - 0.32 * WIDTH, 0.5 * HEIGHT - float(y)) for x, y in _DOT.findall(end)]
    return [(math.hypot(*each), math.degrees(math.atan2(*each)) % 360.0) for each in places]


def test_errors_are_at_their_clock_angles_and_in_proportion():
    """Mass centre and line of the thrust of h9, 0.2667 mm at 310 deg and 0.4 mm at 160 deg. Control: a scene
    without errors has no such point, and the tilt of the thrust alone none either."""
    scene = load("reference").condition("h9")
    (mass, mass_at), (thrust, thrust_at) = dots(scene)
    assert (mass_at, thrust_at) == pytest.approx((310.0, 160.0), abs=0.2)
    assert mass / thrust == pytest.approx(0.2667 / 0.4, rel=5e-3)
    assert "errors enlarged: 0.4 mm off the axis" in str(drawing.launcher(scene))
    tilted = load("reference").condition("phi35")
    plain = load("reference").replace({"thrust_offset": None})
    assert dots(tilted) == dots(plain) == []
    arrows = [str(drawing.launcher(each)).count('class="thrust"') for each in (tilted, plain)]
    assert arrows[0] == arrows[1] + 1
