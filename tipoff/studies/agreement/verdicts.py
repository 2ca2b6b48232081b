"""Rows of the agreement table: metrics, gates, floor, and uncertainty of the reference.

* **Floor**: change of a model by +-1 um of clearance, in the same two metrics. Smaller differences
  have no meaning.
* **Reference uncertainty**: the largest of those of its settled rates by mesh, step and contact
  cells (``agreement.refinement``). Agreement requires at most 0.1 deg/s. The interface stiffness is
  no part of it: it is physics, which both models share (``agreement.interface``).

* **Gates**: v_x within 0.1 %, rates and settled rates within the limits of the scene's
  ``[agreement]``; the limit of the settled rates is at least twice the floor, of which at most
  0.1 deg/s counts.

The uncertainty by the mesh is measured on every condition, the others on conditions that the scene
names; the remaining conditions take the largest value, with a mark.

Every row has one word, its ``judgement``: agrees, agrees as distribution, misses, cannot be judged. A
row is first judged as a curve; ``agreement.distributions`` judges those that no single run can judge.
"""

import math
from dataclasses import dataclass
from typing import TypeVar

from tipoff.comparison.metrics import Difference, compare, settled_rate_errors
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement.refinement import Refinement

VELOCITY_LIMIT = 0.001
CONVERGED_DEG_S = 0.1
FLOOR_CAP_DEG_S = 0.1
AGREES, AS_DISTRIBUTION = "agrees", "agrees as distribution"
MISSES, CANNOT = "misses", "cannot be judged"
JUDGEMENTS = (AGREES, AS_DISTRIBUTION, MISSES, CANNOT)
CURVE, DISTRIBUTION = "curve", "distribution"
NOT_CONVERGED = f"{CANNOT}: reference not converged"
NOT_KNOWN = f"{CANNOT}: convergence of the reference not known"
UNTOUCHED = f"{AGREES} (no pad touches)"
_SHORT = {
    "rate_relative_l2": "rate L2",
    "velocity_relative_l2": "v_x L2",
    "settled_rate_error_deg_s": "settled rate",
}


def gates(scene: Scene) -> dict[str, float]:
    """Limits of the metrics by name, before any floor."""
    roles = scene.agreement
    return {
        "rate_relative_l2": roles.rate_limit,
        "velocity_relative_l2": VELOCITY_LIMIT,
        "settled_rate_error_deg_s": math.degrees(roles.settled_limit),
    }


@dataclass(frozen=True)
class Spread:
    """Change of one model by one cause on one condition, the larger of its cases; None where a run
    did not settle."""

    condition: str
    model: str
    cause: str
    rate_relative_l2: float | None
    settled_rate_change_deg_s: float | None


def spread(
    condition: str, model: str, cause: str, nominal: Trajectory, changed: list[Trajectory]
) -> Spread:
    """Largest change of both metrics over the ``changed`` runs of one model."""
    found = [compare(nominal, run) for run in changed]
    return Spread(
        condition,
        model,
        cause,
        largest_known(item.rate_relative_l2 for item in found),
        largest_known(item.settled_rate_error_deg_s for item in found),
    )


def settled_change(nominal: Trajectory, changed: Trajectory) -> float | None:
    """Largest change of a settled rate (deg/s), or None where one of the runs did not settle."""
    errors = settled_rate_errors(nominal, changed)
    return None if errors is None else max(abs(error) for error in errors)


def largest(values) -> float | None:
    """Largest of the values that are not None, or None."""
    known = [value for value in values if value is not None]
    return max(known) if known else None


def largest_known(values) -> float | None:
    """Largest of the values, or None where one of them is: the unknown one may be larger."""
    found = list(values)
    return None if None in found else largest(found)


_Measured = TypeVar("_Measured", Spread, Refinement)


@dataclass(frozen=True)
class Context:
    """Inputs of the verdicts: ``floors``, spreads of both models by the clearance; ``refinements``,
    those of the reference by mesh, step and cells; ``gates``."""

    floors: list[Spread]
    refinements: list[Refinement]
    gates: dict[str, float]

    def limits(self, floor_deg_s: float | None) -> dict[str, float]:
        """The gates on a condition with this floor."""
        settled = "settled_rate_error_deg_s"
        return self.gates | {
            settled: max(self.gates[settled], 2.0 * min(floor_deg_s or 0.0, FLOOR_CAP_DEG_S))
        }

    def floor(self, condition: str) -> tuple[float | None, float | None, bool]:
        """Floor of the settled rates (deg/s) and of the rate L2, None where a run did not settle, and
        whether it was measured on this very condition."""
        own, measured = _own(self.floors, condition)
        return (
            largest_known(item.settled_rate_change_deg_s for item in own),
            largest_known(item.rate_relative_l2 for item in own),
            measured,
        )

    def uncertainty(self, condition: str) -> tuple[float | None, dict[str, float | None], bool]:
        """Reference uncertainty (deg/s), the same by cause, and whether all of it was measured on
        this very condition."""
        causes: dict[str, float | None] = {}
        here = []
        for cause in dict.fromkeys(item.cause for item in self.refinements):
            own, measured = _own(
                [item for item in self.refinements if item.cause == cause], condition
            )
            found = [item.uncertainty_deg_s for item in own]
            # Unknown where the payload did not settle with a refinement, or a mesh is not refined:
            # what is borrowed of several conditions is unknown where one of them is.
            causes[cause] = largest_known(found)
            here.append(measured)
        unknown = not causes or None in causes.values()
        return None if unknown else largest(causes.values()), causes, bool(here) and all(here)

    def known(self, condition: str) -> bool:
        """Whether there are refinements to judge this condition by, own or borrowed ones, and every one
        that was wanted on it could be run."""
        return bool(self.refinements) and all(
            item.rate_relative_l2 is not None
            for item in self.refinements
            if item.condition == condition
        )

    def converged(self, condition: str) -> bool:
        """Whether the uncertainty of the reference is at most ``CONVERGED_DEG_S`` there."""
        uncertainty = self.uncertainty(condition)[0]
        return uncertainty is not None and uncertainty <= CONVERGED_DEG_S


def _own(spreads: list[_Measured], condition: str) -> tuple[list[_Measured], bool]:
    own = [item for item in spreads if item.condition == condition]
    return (own, True) if own else (spreads, False)


def row(
    condition: str, role: str, reference: Trajectory, surrogate: Trajectory, context: Context
) -> dict:
    """One line of the agreement table as result files hold it."""
    difference = compare(reference, surrogate)
    floor_deg_s, floor_l2, floor_measured = context.floor(condition)
    uncertainty, causes, uncertainty_measured = context.uncertainty(condition)
    touches = bool(reference.pad_force.any())
    return {
        "condition": condition,
        "role": role,
        "reference_status": reference.status,
        "surrogate_status": surrogate.status,
        **difference.as_dict(),
        "floor_deg_s": floor_deg_s,
        "floor_l2": floor_l2,
        "floor_measured_here": floor_measured,
        "reference_uncertainty_deg_s": uncertainty,
        "reference_uncertainty_by_cause_deg_s": causes,
        "reference_uncertainty_measured_here": uncertainty_measured,
        "reference_converged": context.converged(condition),
        "touches": touches,
        "judged_as": CURVE,
        **single(condition, difference, context, touches),
    }


def single(condition: str, difference: Difference, context: Context, touches: bool) -> dict:
    """``gates``, ``judgement`` and ``verdict`` on the ``difference`` of two single runs, in the
    reference of which a pad ``touches`` a rail or none."""
    gates = {
        name: gate(getattr(difference, name), limit)
        for name, limit in context.limits(context.floor(condition)[0]).items()
    }
    converged, known = context.converged(condition), context.known(condition)
    passes = all(item["passes"] for item in gates.values())
    return {
        "gates": gates,
        "judgement": judgement(passes, converged and known),
        "verdict": verdict(gates, converged, touches) if known else NOT_KNOWN,
    }


def is_judged_as_curve(row: dict) -> bool:
    """Whether single runs are compared on the condition of a ``row``, with a verdict."""
    return row["judged_as"] == CURVE and row["judgement"] != CANNOT


def judgement(passes: bool, converged: bool) -> str:
    """The word for a curve that ``passes`` its gates or not."""
    return CANNOT if not converged else AGREES if passes else MISSES


def gate(value: float | None, limit: float) -> dict:
    """Whether ``value`` is within ``limit``, and how many times the limit it is."""
    return {
        "limit": limit,
        "passes": value is not None and value <= limit,
        "times_limit": None if value is None else value / limit,
    }


def verdict(gates: dict[str, dict], converged: bool, touches: bool = True) -> str:
    """Verdict as a phrase. A reference that is not converged comes first; agreement without contact
    is marked."""
    if not converged:
        return NOT_CONVERGED
    missed = [
        f"{_SHORT[name]} "
        f"{'unknown' if item['times_limit'] is None else format(item['times_limit'], '.3g') + ' x limit'}"
        for name, item in gates.items()
        if not item["passes"]
    ]
    if missed:
        return f"{MISSES}: " + ", ".join(missed)
    return AGREES if touches else UNTOUCHED
