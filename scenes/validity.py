"""What constants were found for: size of the thrust, its moment, speed, clearance, rail and pads; and how far a scene is from that.

A contact law fitted at one load and speed is extrapolated at another. One run passes through every load below its peak, so a range
may consist of one value; a scene is called outside where it leaves the range by more than ``MARGIN`` of its end. The transverse
moment impulse is what the errors of assembly change: constants fitted where an error of 0.1 deg presses pads on rails are
extrapolated at 1 deg. Less of it than in the conditions of the fit is no extrapolation.
"""

import numpy as np

from scenes import moments
from scenes.effects import thrust
from scenes.files import content_hash

MARGIN = 0.1  # of the end of a range: scatter of production and 1 um of clearance are no other regime
_WORDS = {"thrust_peak_n": ("thrust peak", "N"), "thrust_impulse_ns": ("thrust impulse", "N s"),
          "thrust_speed_m_s": ("speed that the thrust gives", "m/s"), "clearance_m": ("clearance", "m"),
          "moment_impulse_nms": ("transverse moment impulse", "N m s")}
_FROM_ZERO = ("moment_impulse_nms",)


def loads(scene) -> dict[str, float]:
    """Peak (N) and impulse (N s) of the thrust, impulse over mass (m/s), transverse moment impulse (N m s), and clearance (m) where
    the scene has any."""
    record, duration = scene.thrust.record(), scene.duration
    impulse = float(thrust.impulse(record, duration))
    found = {"thrust_peak_n": float(thrust.peak(record, duration)), "thrust_impulse_ns": impulse,
             "thrust_speed_m_s": impulse / scene.payload.mass,
             "moment_impulse_nms": float(moments.transverse(scene, {}, impulse))}
    return found | ({"clearance_m": scene.contact.clearance} if scene.contact is not None else {})


def ranges(found: list[dict[str, float | None]]) -> dict[str, list[float]]:
    """Smallest and largest of every load of the conditions of a fit, zero where less is no extrapolation; without those that no
    condition has."""
    known = {key: [loads[key] for loads in found if loads[key] is not None] for key in found[0]}
    return {key: [0.0 if key in _FROM_ZERO else min(values), max(values)] for key, values in known.items() if values}


def geometry(scene) -> str:
    """Digest of rail and pads; a rail from a file counts by what the file holds."""
    parts = scene.model_dump(mode="json", exclude_none=True, include={"pads", "rail"})
    parts["rail"]["material"].pop("expansion", None)
    return content_hash(parts["pads"], parts["rail"] | scene.rail.contents())


def beyond(values: np.ndarray | float, span: list[float]) -> np.ndarray | bool:
    """Whether each of ``values`` leaves the range ``span`` by more than the margin."""
    low, high = span
    return (values < low - MARGIN * abs(low)) | (values > high + MARGIN * abs(high))


def outside(scene, valid: dict[str, list[float]], known_geometry: str | None) -> list[str]:
    """Sentences on everything in which ``scene`` lies outside ranges ``valid``; what these do not speak of is not judged."""
    found = []
    for key, value in scene.loads.items():
        if key in valid and beyond(value, valid[key]):
            (low, high), (words, unit) = valid[key], _WORDS[key]
            span = f"{low:.4g} {unit}" if low == high else f"{low:.4g} to {high:.4g} {unit}"
            found.append(f"{words} {value:.4g} {unit}, constants found at {span}")
    if known_geometry not in (None, scene.geometry_hash):
        found.append("rail or pads are not those the constants were found for")
    return found
