"""Which model answers a question: the cheapest that reached an accuracy, or the most accurate
within a time, as measured.

A point of the cost study counts with its error against the finest mesh and the uncertainty of that
mesh, of which the larger is what it can be trusted to; the finest mesh itself with its uncertainty.
That was measured on one condition. On another, each model counts with its error there, and with the
uncertainty of the reference there, as the agreement study found them, where that is more; one that
the agreement study does not have, with other modes of the rails or on a coarser mesh than its
coarse one, is not known there, and never chosen.
"""

import math

from tipoff.studies.core.settings import COARSER
from tipoff.studies.core.study import StudyError

_ROUNDING = 1e-9


def choose(
    cost: dict,
    condition: str,
    agreement: dict | None,
    accuracy: float | None = None,
    budget: float | None = None,
) -> dict:
    """The point of the ``cost`` study, with ``trusted_deg_s`` and ``why`` in words, for an error of
    the settled rates of at most ``accuracy`` (deg/s) on ``condition`` and a wall time of at most
    ``budget`` (s).

    Raises StudyError where no model fits, with the nearest that does.
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
        "the cheapest that is so exact"
        if accuracy is not None
        else "the most exact within the time"
    )
    return best | {
        "why": f"{words(best)}: {reason}, of {len(points)} measured on {cost['condition']}"
        + _measured(cost, condition, there)
    }


def elsewhere(agreement: dict | None, condition: str) -> dict[str, float]:
    """What each rung can be trusted to (deg/s) on a condition of the ``agreement`` study, infinite
    where that is not known; empty without one, or for a condition that it does not have. Of the
    meshes, ``coarsest_m`` is the coarsest whose error is known."""
    if agreement is None:
        return {}
    rungs = {
        "uncalibrated": agreement["uncalibrated"],
        "calibrated": agreement["fitted"] + agreement["held_out"],
        "compliant": agreement["compliant"],
        "modal": agreement["modal"],
    }
    found = {
        rung: row for rung, rows in rungs.items() for row in rows if row["condition"] == condition
    }
    if not found:
        return {}
    unsure = _known(found["compliant"]["reference_uncertainty_deg_s"])
    alone = next(
        row
        for row in agreement["simpler"]
        if (row["condition"], row["patterns"], row["coupled"]) == (condition, 1, False)
    )
    return {
        rung: max(unsure, _known(row["settled_rate_error_deg_s"]))
        for rung, row in (found | {"along": alone}).items()
    } | {"highfi": unsure, "coarsest_m": COARSER * agreement["element_size_m"]}


def trusted(
    points: list[dict], band: float | None, there: dict[str, float] | None = None
) -> list[dict]:
    """The points that have an error, each with what it can be trusted to (deg/s), at least what is
    known of its rung ``there``."""
    known = []
    for point in points:
        error = point["error_deg_s"] if point["error_deg_s"] is not None else band
        if error is not None and point["status"] == "exited":
            known.append(
                point
                | {
                    "trusted_deg_s": max(
                        error, band or 0.0, _elsewhere(point, there) if there else 0.0
                    )
                }
            )
    return known


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
    """What the errors rest on, where they were measured on another condition."""
    if condition == cost["condition"]:
        return ""
    return (
        f"; errors on {condition} as make compare found them"
        if there
        else f"; the errors are those of {cost['condition']}: nothing is known of {condition}"
    )


def words(point: dict) -> str:
    """A point in words and units."""
    trusted_to = (
        f"{point['trusted_deg_s']:.2g} deg/s"
        if math.isfinite(point["trusted_deg_s"])
        else "error unknown"
    )
    return f"{point['model']}, {point['numerics']} ({trusted_to}, {point['wall_s']:.2g} s)"


def _within(value: float, limit: float | None) -> bool:
    return limit is None or value <= limit


def _refusal(points: list[dict], accuracy: float | None, budget: float | None) -> str:
    asked = " and ".join(
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
    exact = [point for point in points if _within(point["trusted_deg_s"], accuracy)]
    if in_time:
        best = min(in_time, key=lambda point: (point["trusted_deg_s"], point["wall_s"]))
        nearest.append(
            ("most exact of all: " if budget is None else "most exact in that time: ") + words(best)
        )
    if exact:
        best = min(exact, key=lambda point: point["wall_s"])
        nearest.append(
            ("fastest of all: " if accuracy is None else "cheapest that is so exact: ")
            + words(best)
        )
    if not nearest:
        nearest = (
            [
                "most exact of all: "
                + words(min(points, key=lambda p: (p["trusted_deg_s"], p["wall_s"]))),
                "fastest of all: " + words(min(points, key=lambda p: p["wall_s"])),
            ]
            if points
            else ["no model settled"]
        )
    return f"no model fits {asked}\n  " + "\n  ".join(nearest)
