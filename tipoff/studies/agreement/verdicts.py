"""Rows of the agreement table: metrics, gates, floor, and uncertainty of the reference.

* **Floor**: change of a model by +-1 um of clearance, in the same two metrics. Smaller differences are
  not significant.
* **Reference uncertainty**: the largest uncertainty of its settled rates by mesh, step and contact cells
  (``agreement.refinement``). Agreement requires at most 0.1 deg/s. It does not include the interface
  stiffness, a physical value that both models share (``agreement.interface``).

* **Gates**: v_x within 0.1 %, rates and settled rates within the limits of the scene's ``[agreement]``.
  The limit of the settled rates is at least twice the floor, with a floor of at most 0.1 deg/s.

The uncertainty by the mesh is measured on every condition, the others on conditions that the scene
names; the remaining conditions take the largest value, with a mark.

Every row has a ``judgement``: agrees, agrees as distribution, misses, cannot be judged. A row is first
judged as a curve; ``agreement.distributions`` judges the rows that no single run can judge.
"""

import math
from dataclasses import dataclass, replace
from typing import Annotated, TypeVar

from tipoff.comparison.metrics import Difference, compare, settled_rate_errors
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.render.column import Column

VELOCITY_LIMIT = 0.001
CONVERGED_DEG_S = 0.1
FLOOR_CAP_DEG_S = 0.1
AGREES, AS_DISTRIBUTION = "agrees", "agrees as distribution"
MISSES, CANNOT = "misses", "cannot be judged"
CURVE, DISTRIBUTION = "curve", "distribution"
NOT_CONVERGED = f"{CANNOT}: reference not converged"
NOT_KNOWN = f"{CANNOT}: convergence of the reference not known"
UNTOUCHED = f"{AGREES} (no pad touches)"
_SHORT = {
    "rate_relative_l2": "rate L2",
    "velocity_relative_l2": "v_x L2",
    "settled_rate_error_deg_s": "settled rate",
}

# metrics as columns of tables
RateL2 = Annotated[float | None, Column("rate L2", "%", ".2g", 100.0)]
SettledError = Annotated[float | None, Column("settled error", "deg/s", ".2g")]


@dataclass(frozen=True)
class Gates:
    """Limits of the metrics."""

    rate_relative_l2: float
    velocity_relative_l2: float
    settled_rate_error_deg_s: float


def gates(scene: Scene) -> Gates:
    """Limits of the metrics, before any floor."""
    roles = scene.agreement
    return Gates(roles.rate_limit, VELOCITY_LIMIT, math.degrees(roles.settled_limit))


@dataclass(frozen=True)
class Gate:
    """Whether a metric ``passes`` its ``limit``, and the ratio of the metric to the limit, None if
    not known."""

    limit: float
    passes: bool
    times_limit: float | None


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A condition with one of the four words above, and the ``verdict`` as a phrase."""

    condition: Annotated[str, Column("condition")]
    judgement: str
    verdict: Annotated[str, Column("verdict")]


@dataclass(frozen=True)
class AtFactor:
    """Verdict at ``factor`` times the interface stiffness."""

    factor: float
    verdict: str


@dataclass(frozen=True, kw_only=True)
class JudgedCondition(Difference, Judged):
    """One line of the agreement table: the metrics of one surrogate on one condition, None if a run
    did not settle. ``_measured_here``: False for the largest value of other conditions.
    ``touches``: whether a pad of the reference touches a rail. ``interface``: verdicts at other
    values of its stiffness."""

    role: Annotated[str, Column("role")]
    reference_status: str
    surrogate_status: str
    rate_relative_l2: RateL2
    settled_rate_error_deg_s: SettledError
    floor_deg_s: Annotated[float | None, Column("floor", "deg/s", ".2g")]
    floor_l2: float | None
    floor_measured_here: bool
    reference_uncertainty_deg_s: Annotated[float | None, Column("reference ±", "deg/s", ".2g")]
    reference_uncertainty_by_cause_deg_s: dict[str, float | None]
    reference_uncertainty_measured_here: bool
    reference_converged: bool
    touches: bool
    judged_as: Annotated[str, Column("judged as")] = CURVE
    gates: dict[str, Gate]
    interface: tuple[AtFactor, ...] = ()

    @property
    def is_judged_as_curve(self) -> bool:
        """Whether single runs are compared on this condition, with a verdict."""
        return self.judged_as == CURVE and self.judgement != CANNOT


@dataclass(frozen=True)
class Spread:
    """Change of one model by one cause on one condition, the largest over its cases; None if a run
    did not settle."""

    condition: Annotated[str, Column("condition")]
    model: Annotated[str, Column("model")]
    cause: Annotated[str, Column("changed input")]
    rate_relative_l2: RateL2
    settled_rate_change_deg_s: Annotated[float | None, Column("settled rates", "deg/s")]


@dataclass(frozen=True, kw_only=True)
class Refinement(Spread):
    """Refinement of one ``cause`` on one condition: ``sizes``, coarsest first; change of both
    metrics between the last two runs; ``uncertainty_deg_s`` of the settled rates, None if not
    known; ``order`` and ``method`` of the axis with the largest uncertainty."""

    cause: Annotated[str, Column("refined")]
    sizes: list[float]
    uncertainty_deg_s: Annotated[float | None, Column("uncertainty", "deg/s", ".2g")]
    order: Annotated[float | None, Column("order", form=".2g")]
    method: Annotated[str, Column("method")]


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
    """Largest of the values, or None if one of them is None, because the unknown value may be
    larger."""
    found = list(values)
    return None if None in found else largest(found)


_Measured = TypeVar("_Measured", bound=Spread)


@dataclass(frozen=True)
class Context:
    """Inputs of the verdicts: ``floors``, spreads of both models by the clearance; ``refinements``,
    those of the reference by mesh, step and cells; ``gates``."""

    floors: list[Spread]
    refinements: list[Refinement]
    gates: Gates

    def limits(self, floor_deg_s: float | None) -> Gates:
        """The gates on a condition with this floor."""
        least = 2.0 * min(floor_deg_s or 0.0, FLOOR_CAP_DEG_S)
        settled = max(self.gates.settled_rate_error_deg_s, least)
        return replace(self.gates, settled_rate_error_deg_s=settled)

    def floor(self, condition: str) -> tuple[float | None, float | None, bool]:
        """Floor of the settled rates (deg/s) and of the rate L2, None if a run did not settle, and
        whether it was measured on this condition."""
        own, measured = _own(self.floors, condition)
        return (
            largest_known(item.settled_rate_change_deg_s for item in own),
            largest_known(item.rate_relative_l2 for item in own),
            measured,
        )

    def uncertainty(self, condition: str) -> tuple[float | None, dict[str, float | None], bool]:
        """Reference uncertainty (deg/s), the same by cause, and whether every part was measured on
        this condition."""
        causes: dict[str, float | None] = {}
        here = []
        for cause in dict.fromkeys(item.cause for item in self.refinements):
            own, measured = _own(
                [item for item in self.refinements if item.cause == cause], condition
            )
            found = [item.uncertainty_deg_s for item in own]
            # Unknown if the payload did not settle with a refinement, or if a mesh is not refined.
            # A value from several other conditions is unknown if one of these is unknown.
            causes[cause] = largest_known(found)
            here.append(measured)
        unknown = not causes or None in causes.values()
        return None if unknown else largest(causes.values()), causes, bool(here) and all(here)

    def known(self, condition: str) -> bool:
        """Whether this condition has refinements, its own or those of other conditions, and every
        requested refinement could run."""
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
) -> JudgedCondition:
    """One line of the agreement table."""
    difference = compare(reference, surrogate)
    floor_deg_s, floor_l2, floor_measured = context.floor(condition)
    uncertainty, causes, uncertainty_measured = context.uncertainty(condition)
    touches = bool(reference.pad_force.any())
    gates, judgement, verdict = single(condition, difference, context, touches)
    return JudgedCondition(
        **vars(difference),
        condition=condition,
        role=role,
        reference_status=reference.status,
        surrogate_status=surrogate.status,
        floor_deg_s=floor_deg_s,
        floor_l2=floor_l2,
        floor_measured_here=floor_measured,
        reference_uncertainty_deg_s=uncertainty,
        reference_uncertainty_by_cause_deg_s=causes,
        reference_uncertainty_measured_here=uncertainty_measured,
        reference_converged=context.converged(condition),
        touches=touches,
        gates=gates,
        judgement=judgement,
        verdict=verdict,
    )


def single(
    condition: str, difference: Difference, context: Context, touches: bool
) -> tuple[dict[str, Gate], str, str]:
    """Gates by metric, judgement and verdict on the ``difference`` of two single runs; ``touches``:
    whether a pad of the reference touches a rail."""
    gates = {}
    for name, limit in vars(context.limits(context.floor(condition)[0])).items():
        value = getattr(difference, name)
        known = value is not None
        gates[name] = Gate(limit, known and value <= limit, value / limit if known else None)
    if not context.known(condition):
        return gates, CANNOT, NOT_KNOWN
    # a reference that is not converged has priority
    if not context.converged(condition):
        return gates, CANNOT, NOT_CONVERGED
    missed = [
        f"{_SHORT[name]} "
        f"{'unknown' if gate.times_limit is None else format(gate.times_limit, '.3g') + ' x limit'}"
        for name, gate in gates.items()
        if not gate.passes
    ]
    if missed:
        return gates, MISSES, f"{MISSES}: {', '.join(missed)}"
    return gates, AGREES, AGREES if touches else UNTOUCHED
