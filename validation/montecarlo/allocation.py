"""Numbers of runs of two models that estimate a mean at the lowest cost.

With the correlation r of both models, and w the cost of a run of the reference over that of the
surrogate (Peherstorfer, Willcox and Gunzburger, SIAM J. Sci. Comput. 38 (2016) A3163):

    N / n = sqrt(w r^2 / (1 - r^2))                     cases of the surrogate per run of the reference
    variance over that of the reference alone at the same cost = (sqrt(1 - r^2) + sqrt(r^2 / w))^2
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Allocation:
    """``cases_per_run`` of the surrogate for a run of the reference, at least one, None if there is
    no upper limit; and the ``variance_ratio``."""

    cases_per_run: float | None
    variance_ratio: float


def optimal(correlation: float, cost_ratio: float) -> Allocation:
    """The optimal allocation; the reference alone, ratio one, if the surrogate saves nothing."""
    explained = correlation**2
    left = max(1.0 - explained, 0.0)
    ratio = (math.sqrt(left) + math.sqrt(explained / cost_ratio)) ** 2
    if cost_ratio * explained <= left or ratio >= 1.0:
        return Allocation(1.0, 1.0)
    return Allocation(math.sqrt(cost_ratio * explained / left) if left > 0.0 else None, ratio)
