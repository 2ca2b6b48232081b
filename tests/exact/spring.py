"""Closed forms of a payload that springs push along x: force P - k s over the travel s, against the
constant friction f of the pusher.

A pusher of mass n goes with the payload: m + n then replaces m below. With the reduced mass m = m_1
m_2 / (m_1 + m_2) of payload and platform, w = sqrt(k / m) and the amplitude a = (P - f) / k, the
travel is s = a (1 - cos w t) from rest. Source: any text on the linear oscillator.
"""

import math
from typing import NamedTuple


class Pushed(NamedTuple):
    """End of a stroke."""

    time: float  # s
    payload: float  # m/s
    platform: float  # m/s
    kept: float  # J, kinetic energy of the pusher


def end_of_stroke(
    preload: float,
    rate: float,
    stroke: float,
    masses: tuple[float, float],
    friction: float = 0.0,
    pusher: float = 0.0,
) -> Pushed:
    """Time and speeds at the end of a ``stroke`` (m) from rest, of a payload and a platform with
    these ``masses`` (kg); the second one may be infinite. A ``pusher`` (kg) adds to the reduced mass."""
    payload, platform = masses
    reduced = payload if math.isinf(platform) else payload * platform / (payload + platform)
    energy = (preload - friction) * stroke - 0.5 * rate * stroke**2
    moving = reduced + pusher
    relative = math.sqrt(2.0 * energy / moving)
    w = math.sqrt(rate / moving)
    time = math.acos(1.0 - stroke * rate / (preload - friction)) / w
    return Pushed(
        time,
        relative * reduced / payload,
        -relative * (1.0 - reduced / payload),
        0.5 * pusher * relative**2,
    )
