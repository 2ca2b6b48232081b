"""Contact time of a small steel ball on a thick steel plate, by the surrogate's contact law with
Hertz's stiffness."""

import math

from tests.exact import contact as exact
from tests.lowfi.support import drop

RADIUS = 0.79e-3  # m
STEEL = (210e9, 0.3)  # Pa, Poisson's ratio; assumed
MASS = 7850.0 * 4.0 / 3.0 * math.pi * RADIUS**3


def ours(at: list[float]) -> dict[str, list[float]]:
    """Contact time (us) at the approach speeds ``at`` (m/s)."""
    stiffness = exact.hertz_stiffness(RADIUS, STEEL, STEEL)
    law = {
        "law": "hunt-crossley",
        "clearance": 1e-8,
        "exponent": 1.5,
        "stiffness": stiffness,
        "dissipation": 0.0,
    }

    def duration(speed: float) -> float:
        expected = exact.power_law_collision(MASS, speed, stiffness, 1.5)["duration"]
        return drop(law, 1e-7, expected, v=speed, mass=MASS)[0]["duration"]

    return {"contact time": [1e6 * duration(speed) for speed in at]}
