"""Choice of a model from the measured points of the cost study: the fastest one for an accuracy, or
the most accurate one for a time.

The error bound of a point is the larger of its error against the finest mesh and the uncertainty of
that mesh, measured on one condition. On another condition the bound is at least the error and the
uncertainty of the reference that the agreement study measured there. A model that the agreement
study lacks (other modes of the rails, a coarser mesh than its coarse one) has no bound there and is
not chosen.
"""

import math

from tipoff.workspace.settings import COARSER
from tipoff.workspace.study import StudyError

_ROUNDING = 1e-9


def choose(
    cost: dict,
    condition: str,
    agreement: dict | None,
    accuracy: float | None = None,
    budget: float | None = None,
) -> dict:
    """The point of the ``cost`` study with an error bound ``trusted_deg_s`` of the settled rates of
    at most ``accuracy`` (deg/s) on ``condition`` and a wall time of at most ``budget`` (s); ``why``
    is the reason as a sentence.

    Raises StudyError where no model fits, with the nearest ones.
    """
    there = {} if condition == cost["condition"] else elsewhere(agreement, condition)
    points = trusted(cost["points"], cost["band_deg_s"], there)
    fit = [
        point
        for point in points
        if math.isfinite(point["trusted_deg_s"])
        and _within(point["trusted_deg_s"], accuracy)
        and _within(point["wall_s"], budget)
    ]
    if not fit:
        raise StudyError(_refusal(points, accuracy, budget) + _measured(cost, condition, there))
    by_time, by_error = (
        (lambda p: (p["wall_s"], p["trusted_deg_s"])),
        (lambda p: (p["trusted_deg_s"], p["wall_s"])),
    )
    best = min(fit, key=by_time if accuracy is not None else by_error)
    reason = (
        "the fastest with this accuracy"
        if accuracy is not None
        else "the most accurate within this time"
    )
    return best | {
        "why": f"{words(best)}: {reason}, of {len(points)} measured on {cost['condition']}"
        + _measured(cost, condition, there)
    }


def elsewhere(agreement: dict | None, condition: str) -> dict[str, float]:
    """Error bounds (deg/s) of the models on a condition of the ``agreement`` study, infinite where
    unknown; empty without a study or its condition. ``coarsest_m`` (m) is the coarsest mesh with a
    known error."""
    if agreement is None:
        return {}
    rows_of = {
        "uncalibrated": agreement["uncalibrated"],
        "calibrated": agreement["fitted"] + agreement["held_out"],
        "compliant": agreement["compliant"],
        "modal": agreement["modal"],
    }
    found = {
        name: row for name, rows in rows_of.items() for row in rows if row["condition"] == condition
    }
    if not found:
        return {}
    uncertainty = _known(found["compliant"]["reference_uncertainty_deg_s"])
    alone = next(
        row
        for row in agreement["simpler"]
        if (row["condition"], row["patterns"], row["coupled"]) == (condition, 1, False)
    )
    return {
        name: max(uncertainty, _known(row["settled_rate_error_deg_s"]))
        for name, row in (found | {"along": alone}).items()
    } | {"highfi": uncertainty, "coarsest_m": COARSER * agreement["element_size_m"]}


def trusted(
    points: list[dict], band: float | None, there: dict[str, float] | None = None
) -> list[dict]:
    """The points that have an error, and the reference, each with its error bound ``trusted_deg_s``,
    which is at least the bound of its model ``there``; infinite where the uncertainty ``band`` of the
    reference is not known."""
    found = []
    for point in points:
        error = 0.0 if point["reference"] else point["error_deg_s"]
        if error is not None and point["status"] == "exited":
            bound = max(error, _known(band), _elsewhere(point, there) if there else 0.0)
            found.append(point | {"trusted_deg_s": bound})
    return found


def _elsewhere(point: dict, there: dict[str, float]) -> float:
    too_coarse = (
        point["rung"] == "highfi" and point["setting"] > (1.0 + _ROUNDING) * there["coarsest_m"]
    )
    return (
        math.inf if too_coarse or point["modes"] is not None else there.get(point["rung"], math.inf)
    )


def _known(value: float | None) -> float:
    return math.inf if value is None else value


def _measured(cost: dict, condition: str, there: dict[str, float]) -> str:
    """Origin of the errors, where they were measured on another condition."""
    if condition == cost["condition"]:
        return ""
    return (
        f"; errors on {condition} from tipoff compare"
        if there
        else f"; the errors are those of {cost['condition']}, none are measured on {condition}"
    )


def words(point: dict) -> str:
    """A point in words and units."""
    bound = (
        f"{point['trusted_deg_s']:.2g} deg/s"
        if math.isfinite(point["trusted_deg_s"])
        else "error unknown"
    )
    return f"{point['model']}, {point['numerics']} ({bound}, {point['wall_s']:.2g} s)"


def _within(value: float, limit: float | None) -> bool:
    return limit is None or value <= limit


def _refusal(points: list[dict], accuracy: float | None, budget: float | None) -> str:
    limits = " and ".join(
        filter(
            None,
            [
                None if accuracy is None else f"{accuracy:g} deg/s",
                None if budget is None else f"{budget:g} s",
            ],
        )
    )
    nearest = []
    in_time = [point for point in points if _within(point["wall_s"], budget)]
    accurate = [point for point in points if _within(point["trusted_deg_s"], accuracy)]
    if in_time:
        best = min(in_time, key=lambda point: (point["trusted_deg_s"], point["wall_s"]))
        nearest.append(
            ("most accurate: " if budget is None else "most accurate in this time: ") + words(best)
        )
    if accurate:
        best = min(accurate, key=lambda point: point["wall_s"])
        nearest.append(
            ("fastest: " if accuracy is None else "fastest with this accuracy: ") + words(best)
        )
    if not nearest:
        nearest = (
            [
                "most accurate: "
                + words(min(points, key=lambda p: (p["trusted_deg_s"], p["wall_s"]))),
                "fastest: " + words(min(points, key=lambda p: p["wall_s"])),
            ]
            if points
            else ["no model settled"]
        )
    return f"no model fits {limits}\n  " + "\n  ".join(nearest)
