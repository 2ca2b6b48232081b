"""A ball that strikes a plane obliquely, by the contact and friction laws of the surrogate.

Hunt and Crossley's law has Hertz's stiffness of the two materials. Its dissipation is that of the
measured normal restitution. The friction is the two-step law, which both models have.
"""

import math
from functools import cache

from scipy.optimize import brentq

from tests.exact import contact as exact
from tests.lowfi import ball

RADIUS, DENSITY = 2.5e-3, 4000.0
ALUMINA, GLASS = (380e9, 0.23), (70e9, 0.25)  # Pa, Poisson's ratio
SPEED, RESTITUTION, FRICTION = 3.9, 0.98, 0.092
MASS = ball.mass(RADIUS, DENSITY)
GAP = 1e-7  # m


@cache
def rebound(degrees: float, friction: float = FRICTION) -> dict[str, float]:
    """What a ball without spin does after it struck at ``degrees`` from the normal: share of its
    tangential speed, spin (rad/s) and angle (deg) from the normal."""
    closing = SPEED * math.cos(math.radians(degrees))
    along = SPEED * math.sin(math.radians(degrees))
    stiffness = exact.hertz_stiffness(RADIUS, ALUMINA, GLASS)
    scaled = brentq(lambda a: exact.hunt_crossley_restitution(a) - RESTITUTION, 1e-6, 0.5)
    contact = exact.power_law_collision(MASS, closing, stiffness, 1.5)["duration"]
    run = ball.strike(
        RADIUS,
        MASS,
        (along, closing),
        contact={
            "law": "hunt-crossley",
            "clearance": GAP,
            "exponent": 1.5,
            "stiffness": stiffness,
            "dissipation": scaled / closing,
        },
        friction={
            "static": friction,
            "dynamic": friction,
            "static_speed": 2e-3 * SPEED,
            "dynamic_speed": 4e-3 * SPEED,
        },
        duration=GAP / closing + 1.5 * contact,
        tolerance=1e-7,
    )
    after = run.velocity[-1]
    return {
        "tangential restitution": float(after[0] / along),
        "spin": float(run.rate[-1, 1]),
        "rebound angle": math.degrees(math.atan2(after[0], after[2])),
    }


def ours(at: list[float]) -> dict[str, list[float]]:
    """The three quantities at the angles ``at`` (deg from the normal)."""
    found = [rebound(degrees) for degrees in at]
    return {name: [row[name] for row in found] for name in found[0]}
