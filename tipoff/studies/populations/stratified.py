"""An upper bound of the probability of an event in the reference, from strata of the surrogate.

The surrogate puts each of N independent cases into a stratum: it shows the event (above), is near the
event (near), or far from it (far). The reference runs some cases of the strata near and far. With the
weight W of a stratum, and the probability P of the event in it,

    p = W_above P_above + W_near P_near + W_far P_far
      <= U_far + (U_near - U_far) V_near + (1 - U_near) V_above,     U_near >= U_far

U is an upper bound of P, V_above of W_above, and V_near of W_above + W_near. All are bounds of Clopper
and Pearson, and their error probabilities add up to 1 - confidence. So the bound holds for any
population. P_above is at most one and needs no run.

n runs without the event give a bound of -ln(a) / n at an error probability a: 1.5 % after 200 plain runs.
A stratum with most of the cases has no smaller bound. Strata remove the chance in the number of events:
many cases of the surrogate give the weights of above and near, and a difference of both models near the
limit counts only with the small weight of the cases there.
"""

import math
from dataclasses import dataclass

from tipoff.studies.populations import exceedance

# Parts of the error probability: of both bounds of weights, of the near stratum, and of the far one,
# whose bound is the largest part.
_OF_WEIGHTS, _OF_NEAR, _OF_FAR = 0.1, 0.2, 0.7


@dataclass(frozen=True)
class Runs:
    """Number of runs of the reference in a stratum, and of ``events`` among them."""

    runs: int
    events: int


@dataclass(frozen=True)
class Bound:
    """``upper`` bound of the probability in the reference, its ``estimate``, and the bounds of the
    probability in the near and the far stratum."""

    upper: float
    estimate: float
    near_share: float
    far_share: float


def upper_bound(cases: tuple[int, int, int], near: Runs, far: Runs, confidence: float) -> Bound:
    """The bound from the numbers of ``cases`` of the surrogate that are above, near and far, and
    the ``near`` and ``far`` runs of the reference. The estimate takes P_above = 1, so it is at
    least the estimate of the surrogate."""
    total, error = sum(cases), 1.0 - confidence
    far_share = _at_most(far, _OF_FAR * error)
    near_share = max(_at_most(near, _OF_NEAR * error), far_share)
    sure = 1.0 - 0.5 * _OF_WEIGHTS * error
    above, within = (
        exceedance.at_most(count, total, sure) for count in (cases[0], cases[0] + cases[1])
    )
    upper = far_share + (near_share - far_share) * within + (1.0 - near_share) * above
    estimate = sum(
        count * (part.events / part.runs if part.runs else 1.0)
        for count, part in zip(cases, (Runs(0, 0), near, far))
    )
    return Bound(min(upper, 1.0), estimate / total, near_share, far_share)


def _at_most(found: Runs, error: float) -> float:
    return exceedance.at_most(found.events, found.runs, 1.0 - error) if found.runs else 1.0


def allocated(cases: tuple[int, int, int], runs: int, confidence: float) -> tuple[int, int]:
    """Runs near and far, at most the ``cases`` there. They give the smallest sum of bounds W
    ln(1/a) / n if no run shows the event, so n is proportional to sqrt(W ln(1/a))."""
    _, near, far = cases
    wish_near, wish_far = (
        math.sqrt(-count * math.log(part * (1.0 - confidence)))
        for count, part in ((near, _OF_NEAR), (far, _OF_FAR))
    )
    if near + far <= runs or not near:
        return near, min(far, runs)
    first = min(near, max(1, round(runs * wish_near / (wish_near + wish_far))))
    return first, min(far, runs - first)
