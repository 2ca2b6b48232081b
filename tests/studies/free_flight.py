"""A launch on which no pad can touch, so that rates follow from the errors by one line::

    w_y = (J/I) (l sin t sin a + (r cos b - m cos c) cos t)
    w_z = -(J/I) (l sin t cos a + (r sin b - m sin c) cos t)

with impulse J, arm l, one moment of inertia I about every axis; misalignment t at a, thrust
eccentricity r at b, mass eccentricity m at c.
"""

import math

from tipoff import scenes

IMPULSE, ARM, INERTIA, WIDTH = 100.0, 0.15, 0.55, 1e-3  # N s, m, kg m2, s
# Of the whole Gaussian, after ignition three widths before its peak. Before that the payload would
# move so little that its first step ends without the energy that it should have.
SHARE = 0.5 * (1.0 + math.erf(3.0 / math.sqrt(2.0)))
# deg/s of the total rate per radian of misalignment
RATE_PER_RADIAN = math.degrees(IMPULSE * ARM / INERTIA)
RATE_PER_METRE = math.degrees(IMPULSE / INERTIA)  # and per metre of an eccentricity
# Rails of 100 mm that nothing touches, and few samples: the reference runs a third as long.
BRIEF = {
    "rail.end": "12 mm",
    "rail.mounts": [{"start": "8 mm", "end": "28 mm"}],
    "output.interval": "0.5 ms",
}


def scene() -> scenes.Scene:
    """The reference scene without contact, friction and platform; its own misalignment is zero."""
    return scenes.load("clamped").replace(
        {
            "contact": None,
            "friction": None,
            "platform": None,
            "payload.mass": 10.0,
            "payload.inertia.xx": INERTIA,
            "payload.inertia.yy": INERTIA,
            "payload.inertia.zz": INERTIA,
            "payload.inertia.xy": None,
            "payload.inertia.xz": None,
            "thrust.width": WIDTH,
            "thrust.centre": 3.0 * WIDTH,
            "thrust.peak": IMPULSE / (WIDTH * math.sqrt(2.0 * math.pi) * SHARE),
            "thrust.arm": ARM,
            "thrust_offset.misalignment.axial": 0.0,
        }
    )
