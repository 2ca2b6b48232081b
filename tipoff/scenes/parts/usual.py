"""What a scene of a rocket assumes of a rail of which only the length is known."""

import math

from tipoff.scenes import studies

STRETCH = 3  # of the elements along a rail with buttons or lugs
# m, fractions of an inch in which rods are sold, and the part of a lug that a rod fills in any other case
RODS, FILLED = tuple(0.0254 * share for share in (1 / 8, 3 / 16, 1 / 4, 3 / 8, 1 / 2)), 0.92
MOUNT, SPAN = 0.06, 1.5  # m: length of a clamp, and at most between two of them
BEYOND = 0.45  # m, of rail that is not held at its open end


def mounts(rail: float) -> list[tuple[float, float]]:
    """Start and end (m) of the clamps along a ``rail`` (m), on multiples of their length."""
    count = max(3, math.ceil(rail / SPAN) + 1)
    last = rail - min(0.1 * rail, BEYOND) - MOUNT
    places = {
        max(MOUNT * round(last * number / (count - 1) / MOUNT), 0.0) for number in range(count)
    }
    return [(place, place + MOUNT) for place in sorted(places)]


def element_size(rail: float) -> str:
    """Elements along a ``rail`` (m), which has a profile: coarser ones do not change its section."""
    return f"{1e3 * max(studies.usual_size(rail), 5e-3):g} mm"


def rod_in(inner: float) -> float:
    """Diameter (m) of the rod for a lug of this ``inner`` diameter (m)."""
    return max((rod for rod in RODS if FILLED * inner < rod < inner), default=FILLED * inner)


def foot() -> list[tuple[float, float]]:
    """Start and end (m) of the clamp of a rod: lugs pass no other one."""
    return [(0.0, MOUNT)]


def rod_element_size(rod: float) -> str:
    """Elements along a ``rod`` of this diameter (m): as long as it is thick, 1.5 % too stiff."""
    return f"{1e3 * rod / STRETCH:.3g} mm"
