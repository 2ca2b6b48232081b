"""Choice of a model from the measured points of the cost study: the fastest one for an accuracy, or
the most accurate one for a time.

The error bound of a point is the larger of its error against the finest mesh and the uncertainty of that
mesh, measured on one condition. On another condition the bound is at least the error and the uncertainty
of the reference that the agreement study measured there. A model that the agreement study lacks (other
rail modes, a coarser mesh than its coarse one) has no bound on that condition and is not chosen.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import NamedTuple

from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.cost.results import Cost, Point
from tipoff.workspace.settings import COARSER
from tipoff.workspace.study import StudyError

_ROUNDING = 1e-9
_SPRINGS = "uncalibrated", "calibrated"  # rungs of the agreement study


class Trusted(NamedTuple):
    """A point with its error bound; infinite if it is not known."""

    point: Point
    bound_deg_s: float


class Choice(NamedTuple):
    """The chosen point, its error bound, and the reason as a sentence."""

    point: Point
    bound_deg_s: float
    why: str

    def plain(self) -> dict:
        """The choice as JSON values."""
        return asdict(self.point) | {"trusted_deg_s": self.bound_deg_s, "why": self.why}


def choose(
    cost: Cost,
    condition: str,
    agreement: Agreement | None,
    accuracy: float | None = None,
    budget: float | None = None,
) -> Choice:
    """The point of the ``cost`` study with an error bound of the settled rates of at most ``accuracy``
    (deg/s) on ``condition`` and a wall time of at most ``budget`` (s).

    Raises StudyError with the nearest models if no model fits.
    """
    there = {} if condition == cost.condition else elsewhere(agreement, condition)
    points = trusted(cost.points, cost.band_deg_s, there)
    fit = [
        item
        for item in points
        if math.isfinite(item.bound_deg_s)
        and _within(item.bound_deg_s, accuracy)
        and _within(item.point.wall_s, budget)
    ]
    if not fit:
        raise StudyError(_refusal(points, accuracy, budget) + _measured(cost, condition, there))
    unsure = unranked(condition, there.get("highfi", cost.band_deg_s))
    best, reason = _best(fit, accuracy is not None, unsure)
    why = f"{words(best)}: {reason}, of {len(points)} measured on {cost.condition}"
    return Choice(*best, why + _measured(cost, condition, there))


def unranked(condition: str, uncertainty: float | None) -> str:
    """Why errors do not rank the models on a condition; empty if they do. They do not where the
    ``uncertainty`` (deg/s) of the reference is above the limit of agreement, as it is under chaos."""
    if uncertainty is None or uncertainty <= verdicts.CONVERGED_DEG_S:
        return ""
    return (
        f"On {condition} the reference is uncertain by {uncertainty:.2g} deg/s, more than the "
        f"{verdicts.CONVERGED_DEG_S:g} deg/s of agreement. Smaller errors do not rank the models, so none "
        "is recommended. Finer elements may help. Where 1 µm changes the launch, compare distributions: "
        "tipoff compare --neighbours"
    )


def _best(fit: list[Trusted], cheapest: bool, unsure: str) -> tuple[Trusted, str]:
    """The best of the points that ``fit``, with the reason: the ``cheapest`` or the most accurate. If
    the errors rank no model, compliant contact is preferred to springs."""
    if cheapest:
        return min(fit, key=_by_time), "the fastest with this accuracy"
    if unsure:
        found = min(fit, key=lambda item: (item.point.rung in _SPRINGS, *_by_error(item)))
        return found, "its contact follows from the rail, and no error ranks the models"
    return min(fit, key=_by_error), "the most accurate within this time"


def _by_time(item: Trusted) -> tuple[float, float]:
    return item.point.wall_s, item.bound_deg_s


def _by_error(item: Trusted) -> tuple[float, float]:
    return item.bound_deg_s, item.point.wall_s


def elsewhere(agreement: Agreement | None, condition: str) -> dict[str, float]:
    """Error bounds (deg/s) of the models on a condition of the ``agreement`` study, infinite where
    unknown; empty without a study or its condition. ``coarsest_m`` (m) is the coarsest mesh with a
    known error."""
    if agreement is None:
        return {}
    own = next((row for row in agreement.compliant if row.condition == condition), None)
    if own is None:
        return {}
    uncertainty = _known(own.reference_uncertainty_deg_s)
    alone = [row for row in agreement.simpler if row.patterns == 1 and not row.coupled]
    return {
        name: max(uncertainty, _known(row.settled_rate_error_deg_s))
        for name, rows in (
            ("uncalibrated", agreement.uncalibrated),
            ("calibrated", agreement.calibrated),
            ("compliant", agreement.compliant),
            ("modal", agreement.modal),
            ("along", alone),
        )
        for row in rows
        if row.condition == condition
    } | {"highfi": uncertainty, "coarsest_m": COARSER * agreement.element_size_m}


def trusted(
    points: Sequence[Point], band: float | None, there: dict[str, float] | None = None
) -> list[Trusted]:
    """The points that have an error, and the reference, each with an error bound of at least the
    bound of its model in ``there``; infinite if the uncertainty ``band`` of the reference is not
    known."""
    found = []
    for point in points:
        error = 0.0 if point.reference else point.error_deg_s
        if error is not None and point.status == "exited":
            bound = max(error, _known(band), _elsewhere(point, there) if there else 0.0)
            found.append(Trusted(point, bound))
    return found


def _elsewhere(point: Point, there: dict[str, float]) -> float:
    too_coarse = point.rung == "highfi" and point.setting > (1.0 + _ROUNDING) * there["coarsest_m"]
    return math.inf if too_coarse or point.modes is not None else there.get(point.rung, math.inf)


def _known(value: float | None) -> float:
    return math.inf if value is None else value


def _measured(cost: Cost, condition: str, there: dict[str, float]) -> str:
    """Origin of the errors if they were measured on another condition."""
    if condition == cost.condition:
        return ""
    return (
        f"; errors on {condition} from tipoff compare"
        if there
        else f"; the errors are those of {cost.condition}, none are measured on {condition}"
    )


def words(item: Trusted) -> str:
    """A point in words and units."""
    point, bound = item
    error = f"{bound:.2g} deg/s" if math.isfinite(bound) else "error unknown"
    return f"{point.model}, {point.numerics} ({error}, {point.wall_s:.2g} s)"


def _within(value: float, limit: float | None) -> bool:
    return limit is None or value <= limit


def _refusal(points: list[Trusted], accuracy: float | None, budget: float | None) -> str:
    limits = [
        *([] if accuracy is None else [f"{accuracy:g} deg/s"]),
        *([] if budget is None else [f"{budget:g} s"]),
    ]
    in_time = [item for item in points if _within(item.point.wall_s, budget)]
    accurate = [item for item in points if _within(item.bound_deg_s, accuracy)]
    nearest = []
    if in_time:
        how = "most accurate: " if budget is None else "most accurate in this time: "
        nearest.append(how + words(min(in_time, key=_by_error)))
    if accurate:
        how = "fastest: " if accuracy is None else "fastest with this accuracy: "
        nearest.append(how + words(min(accurate, key=lambda item: item.point.wall_s)))
    if points and not nearest:
        fastest = min(points, key=lambda item: item.point.wall_s)
        nearest = [
            f"most accurate: {words(min(points, key=_by_error))}",
            f"fastest: {words(fastest)}",
        ]
    lines = nearest or ["no model settled"]
    return f"no model fits {' and '.join(limits)}\n  " + "\n  ".join(lines)
