"""What a scene of a rocket assumes of a rail of which only the length is known."""

import math

from tipoff.scenes import studies

MOUNT, SPAN = 0.06, 1.5  # m: length of a clamp, and at most between two of them


def mounts(rail: float) -> list[tuple[float, float]]:
    """Start and end (m) of the clamps along a ``rail`` (m), on multiples of their length."""
    count = max(3, math.ceil(rail / SPAN) + 1)
    last = 0.9 * rail - MOUNT
    places = {
        max(MOUNT * round(last * number / (count - 1) / MOUNT), 0.0) for number in range(count)
    }
    return [(place, place + MOUNT) for place in sorted(places)]


def element_size(rail: float) -> str:
    """Elements along a ``rail`` (m), which has a profile: coarser ones do not change its section."""
    return f"{1e3 * max(studies.usual_size(rail), 5e-3):g} mm"
