"""The deployers of CubeSats from 1U to 16U: the scene ``cubesat_3u`` with the size of another CubeSat.

Four rails of the deployer guide the four rails of the CubeSat at its corners. A spring of the same speed
at exit pushes it: with the mass m and the stroke s, its force is in proportion to m / s and its rate to m / s^2.
"""

import math
from typing import Any, Literal, NamedTuple

Size = Literal["1u", "1.5u", "2u", "3u", "6u", "12u", "16u"]
_STANDARD = "CubeSat Design Specification, Rev. 14.1"
_PAD, _STEP, _GRID, _MOUNT = 16.0, 54.0, 8.0, 16.0  # mm: pad, stations, grid and length of mounts
_MASS, _STROKE = 4.0, 330.0  # kg, mm: of the scene cubesat_3u


class CubeSat(NamedTuple):
    """Sizes (mm) along the rails and across, and mass (kg)."""

    long: float
    across: tuple[float, float]  # along Y and Z
    most: float  # mass that the standard allows
    source: str

    @property
    def mass(self) -> float:
        """Two thirds of the largest mass, as on the scene cubesat_3u."""
        return 2.0 / 3.0 * self.most


SIZES = {
    "1u": CubeSat(113.5, (100.0, 100.0), 2.0, _STANDARD),
    "1.5u": CubeSat(170.2, (100.0, 100.0), 3.0, _STANDARD),
    "2u": CubeSat(227.0, (100.0, 100.0), 4.0, _STANDARD),
    "3u": CubeSat(340.5, (100.0, 100.0), 6.0, _STANDARD),
    "6u": CubeSat(366.0, (226.3, 100.0), 12.0, _STANDARD),
    "12u": CubeSat(366.0, (226.3, 226.3), 24.0, _STANDARD),
    "16u": CubeSat(454.0, (226.3, 226.3), 32.0, "assumed, since the standard ends at 12U"),
}


def resize(document: Any, size: str, mass: float | None) -> None:
    """Give the ``document`` of the scene cubesat_3u the ``size`` of another CubeSat, with its usual mass
    or that (kg) of the user."""
    own = SIZES[size]
    mass = own.mass if mass is None else mass
    half, stroke = 0.5 * own.long, own.long - 10.5
    document["payload"]["mass"] = f"{mass:.6g} kg"
    document["payload"]["size"] = [_mm(own.long), *map(_mm, own.across)]
    edge = half - 0.5 * _PAD - 0.25
    count = max(2, round(2.0 * edge / _STEP) + 1)
    places = [edge * (2.0 * place / (count - 1) - 1.0) for place in range(count)]
    document["pads"]["stations"] = [_mm(place) for place in places]
    document["pads"]["corner"] = [_mm(0.5 * side) for side in own.across]
    rail, start = _GRID * math.ceil((own.long + 3.0) / _GRID), -math.ceil(half)
    document["rail"]["start"], document["rail"]["end"] = _mm(start), _mm(start + rail)
    held = max(2, round(rail / 110.0) + 1)
    begins = [_GRID * round((rail - _MOUNT) * n / (held - 1) / _GRID) for n in range(held)]
    document["rail"]["mounts"] = [{"start": _mm(x), "end": _mm(x + _MOUNT)} for x in begins]
    share = mass / _MASS
    document["thrust"]["arm"] = _mm(half)
    spring = document["thrust"]["springs"][0]
    spring["preload"] = f"{20.0 * share * _STROKE / stroke:.6g} N"
    spring["rate"] = f"{0.04 * share * (_STROKE / stroke) ** 2:.6g} N/mm"
    spring["stroke"] = _mm(stroke)
    stated = f"{own.across[0]:g} x {own.across[1]:g} x {own.long:g} mm"
    document["provenance"] |= {
        "payload.mass": f"assumed: two thirds of {own.most:g} kg; {own.source}: up to {own.most:g} kg",
        "payload.size": f"{own.source}: {stated}, +- 0.1 mm across",
        "pads": f"{own.source}: {stated}; rails 8.5 mm wide; assumed: short pads in place of each rail",
        "thrust.arm": "half of the length",
    }


def _mm(length: float) -> str:
    return f"{round(length, 6):g} mm"
