"""Curves of one flight for its figures, short enough for a result file."""

import numpy as np

from tipoff.studies.flight import flown, orbit, rotation
from tipoff.studies.flight.results import Curves
from tipoff.studies.flight.summary import plain

SHOWN = 5  # conditions with curves
_POINTS = 201
# clearance (m), and multiple of the smallest one, up to which a curve is shown
_NEAR, _LEAST = 5e-4, 2.0


def of_condition(condition: str, both: flown.Pair, found: flown.Flown) -> Curves:
    """Curves of a condition, the one case of ``both``."""
    flight = both.flight
    ends = float(found.passes[0]) if np.isfinite(found.passes[0]) else flight.duration
    time, whole = (np.linspace(0.0, end, _POINTS)[None] for end in (ends, flight.duration))
    around = np.linspace(
        0.0, 2.0 * np.pi / max(abs(float(found.coning[0])), 2.0 * np.pi / flight.duration), _POINTS
    )[None]
    path = (
        orbit.places(flight.mean_motion, both.payload, time)[0] @ flight.axes + both.bodies.origin
    )
    apart = orbit.places(flight.mean_motion, both.payload - both.platform, whole)[0]
    error = np.degrees(flown.pointing_error(both, time)[0])
    time_s, clearance = _clearance(both)
    return Curves(
        condition=condition,
        axis_deg=plain(_axis(both, around)),
        axis_at_target_deg=plain(_axis(both, time[:, -1:])[0]),
        time_s=plain(time[0]),
        pointing_deg=plain(error),
        to_target_m=plain(path),
        orbit_m=plain(apart),
        clearance_s=plain(time_s),
        clearance_m=plain(clearance),
    )


def _axis(both: flown.Pair, time: np.ndarray) -> np.ndarray:
    """Direction of the x axis at ``time`` (1,k) s: its angle (deg) from the launch axis, as
    components (k,2) across this axis."""
    axis = rotation.at(both.payload_turn, time)[0][0, :, :, 0]
    across = np.hypot(axis[:, 1], axis[:, 2])
    return (
        np.degrees(flown.pointing_error(both, time)[0])[:, None]
        * axis[:, 1:]
        / np.where(across > 0.0, across, 1.0)[:, None]
    )


def _clearance(both: flown.Pair) -> tuple[np.ndarray, np.ndarray]:
    """Times (k,) s and clearance (k,) m until it is no longer small; empty without boxes."""
    if not both.bodies.boxes.shape[1]:
        return np.empty(0), np.empty(0)
    time = np.linspace(0.0, float(flown.clear_after(both)[0]), 4 * _POINTS)
    gap = flown.gap(both, time[None])[0]
    near = gap <= max(_NEAR, _LEAST * gap.min())
    return time[near], gap[near]
