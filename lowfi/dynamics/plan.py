"""Times at which steps must end, and their largest length, so that no step skips a corner or a
short pulse of the thrust."""

import numpy as np

from tipoff.lowfi.dynamics.loop import Plan
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.mechanics.model import Model

# A Gaussian is below 2e-14 of its peak beyond this many widths. Stages of a step inside are at most
# half of it apart, so any three widths contain four of them.
_REACH, _SHARE = 8.0, 1.5
_FIRST_SHARE = 1e-3  # of the time to the first stop


def make(model: Model, end: float, numerics: Numerics) -> Plan:
    """Plan of a run up to ``end`` (s)."""
    # The force of a stop ends with zero, and at a time of each case.
    latch = model.hold_down
    released = latch.release if latch is not None and not latch.is_stop else 0.0
    corners = thrust_law.corners(model.thrust, end)
    if 0.0 < released < end:
        corners = np.unique(np.append(corners, released))
    stops = np.append(corners, end)
    if model.thrust.pulses is None:
        return _plan(stops, np.full(stops.size, np.inf), numerics)
    _, centres, widths, first, last = model.thrust.pulses
    begins, ends = (
        np.maximum(centres - _REACH * widths, first),
        np.minimum(centres + _REACH * widths, last),
    )
    edges = np.concatenate([begins, ends])
    stops = np.unique(np.append(stops, edges[(edges > 0.0) & (edges < end)]))
    middles = 0.5 * (stops + np.append(0.0, stops[:-1]))
    acting = (begins < middles[:, None]) & (middles[:, None] < ends)
    caps = np.where(acting, _SHARE * widths, np.inf).min(axis=1)
    return _plan(stops, caps, numerics)


def _plan(stops: np.ndarray, caps: np.ndarray, numerics: Numerics) -> Plan:
    return Plan(
        stops=stops,
        caps=caps,
        maximum_steps=numerics.maximum_steps,
        first=0.25 * float(caps[0]) if np.isfinite(caps[0]) else _FIRST_SHARE * float(stops[0]),
    )
