"""Curves of one flight for its pictures, short enough for a result file: axis, pointing error,
paths and clearance."""

import numpy as np

from tipoff.studies.flight import flown, orbit, rotation

SHOWN = 5  # conditions with curves
_POINTS = 201
_NEAR, _LEAST = 5e-4, 2.0  # clearance (m), and times the least one, up to which it is shown


def of(both: flown.Pair, found: flown.Flown) -> dict:
    """Curves of the one case of ``both``: axis_deg, where the payload's x axis points in one round
    about its angular momentum, as its angle from the launch axis along scene y and z, and where it
    does at the target; pointing_deg and to_target_m, places in scene axes that turn with the orbit,
    at time_s; orbit_m, places in orbit axes relative to the platform; clearance_m at
    clearance_s."""
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
    return {
        "axis_deg": _plain(_axis(both, around)),
        "axis_at_target_deg": _plain(_axis(both, time[:, -1:])[0]),
        "time_s": _plain(time[0]),
        "pointing_deg": _plain(error),
        "to_target_m": _plain(path),
        "orbit_m": _plain(apart),
        **_clearance(both),
    }


def _axis(both: flown.Pair, time: np.ndarray) -> np.ndarray:
    """Where the x axis points at ``time`` (1,k) s: its angle (deg) from the launch axis, in the
    direction (k,2) it leans to."""
    axis = rotation.at(both.payload_turn, time)[0][0, :, :, 0]
    across = np.hypot(axis[:, 1], axis[:, 2])
    return (
        np.degrees(flown.pointing_error(both, time)[0])[:, None]
        * axis[:, 1:]
        / np.where(across > 0.0, across, 1.0)[:, None]
    )


def _clearance(both: flown.Pair) -> dict:
    """The clearance until it is no longer small; nothing without boxes."""
    if not both.bodies.boxes.shape[1]:
        return {}
    time = np.linspace(0.0, float(flown.clear_after(both)[0]), 4 * _POINTS)
    gap = flown.gap(both, time[None])[0]
    near = gap <= max(_NEAR, _LEAST * gap.min())
    return {"clearance_s": _plain(time[near]), "clearance_m": _plain(gap[near])}


def _plain(values: np.ndarray) -> list:
    """Six digits, enough for every picture."""
    return (
        [_plain(row) for row in values]
        if values.ndim > 1
        else [float(f"{value:.6g}") for value in values]
    )
