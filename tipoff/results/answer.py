"""The answer of a run as text: velocity, rates and direction with one error, or the ranges of a sensitive run.
The terminal and the summaries of Python have the same words."""

import math
from collections.abc import Sequence

from tipoff.results.guides import Guide
from tipoff.results.model_error import ModelError, Range
from tipoff.uncertain import range_of, rounded, uncertain
from tipoff.units import duration


def words(
    velocity_m_s: Sequence[float], rate_deg_s: Sequence[float], error: ModelError | None
) -> dict[str, str]:
    """``velocity``, ``rate`` and ``direction``, rounded to the ``error`` of the rates."""
    if error is not None and error.range is not None:
        return _ranges(error.range)
    across = math.hypot(*velocity_m_s[1:])
    off = math.degrees(math.atan2(across, velocity_m_s[0]))
    return {
        "velocity": f"{', '.join(uncertain(value, least=1e-4) for value in velocity_m_s)} m/s (x, y, z)",
        "rate": _rates(rate_deg_s, error.rate_deg_s if error is not None else None),
        "direction": f"{off:.4g} deg off axis, {1e3 * across:.4g} mm/s across",
    }


def _rates(rate: Sequence[float], error: float | None) -> str:
    shown = ", ".join(rounded(value, error) for value in rate)
    known = "" if error is None else f" ± {rounded(error, error)}"
    return f"{shown}{known} deg/s (x, y, z), {rounded(math.hypot(*rate), error)} in total"


def _ranges(found: Range) -> dict[str, str]:
    speeds = (range_of(low, high, least=1e-4) for low, high in zip(found.low_m_s, found.high_m_s))
    across = range_of(*(1e3 * end for end in found.across_m_s))
    return {
        "velocity": f"{', '.join(speeds)} m/s (x, y, z)",
        "rate": f"{', '.join(map(range_of, found.low_deg_s, found.high_deg_s))} deg/s (x, y, z)",
        "direction": f"{range_of(*found.off_axis_deg, least=1e-4)} deg off axis, {across} mm/s across",
    }


def rates(rate_deg_s: Sequence[float]) -> str:
    """Rates without an error of their own."""
    return f"{', '.join(map(uncertain, rate_deg_s))} deg/s"


def of_guide(guide: Guide, with_rates: bool) -> str:
    """When a guide leaves the rail, ``with_rates`` or without those then, and its largest force."""
    told = [f"x = {round(1e3 * guide.place_m[0], 6):.4g} mm"]
    if guide.leaves_s is None or guide.speed_m_s is None or guide.rate_rad_s is None:
        told.append("does not leave the rail")
    else:
        then = f", {rates([math.degrees(rate) for rate in guide.rate_rad_s])}"
        told.append(
            f"leaves at {duration(guide.leaves_s, 4)}, {uncertain(guide.speed_m_s)} m/s"
            + (then if with_rates else "")
        )
    if guide.largest_force_n is None or guide.largest_force_time_s is None:
        return "; ".join([*told, "no force"])
    force = (
        f"largest force {guide.largest_force_n:.3g} N at {duration(guide.largest_force_time_s, 4)}"
    )
    if guide.moment_n_m is not None:
        force += f", {math.hypot(*guide.moment_n_m):.3g} N m at its foot"
    return "; ".join([*told, force])
