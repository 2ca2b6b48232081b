"""How many cases of an ensemble are sensitive: 1 um more of every clearance, or a tighter tolerance,
changes a settled rate by more than the limit of agreement, or the case does not settle.

``workspace.disturbed`` does the same for one run. Chaos is the usual cause.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tipoff.lowfi.ensemble import twins
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.store import Store

CAUSES = {
    "clearance": f"{1e6 * twins.CLEARANCE_CHANGE:g} µm of clearance",
    "tolerance": "a tighter tolerance",
}


@dataclass(frozen=True, kw_only=True)
class Change:
    """Changes of the settled rates by one cause: cases above the limit, cases whose twin does not
    settle, quantiles (None without a change), digest of the twins."""

    above_limit: int
    unsettled: int
    median_deg_s: float | None
    q95_deg_s: float | None
    largest_deg_s: float | None
    digest: str


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How many cases are ``sensitive``, and the changes by cause."""

    limit_deg_s: float
    clearance_change_m: float
    sensitive: int
    by: dict[str, Change]


def compared(store: Store, disturbed: Mapping[str, Store], limit: float) -> Sensitivity:
    """The sensitivity of a whole ``store``, from the stores of its twins by cause; ``limit``
    (deg/s)."""
    settled = np.isfinite(store.column("lateral_velocity"))
    beyond, found = np.zeros(store.asked, dtype=bool), {}
    for cause, twin in disturbed.items():
        change = np.degrees(np.concatenate([[], *twins.changes(store, twin)]))
        known, large = np.isfinite(change), change > limit  # False where it is NaN
        lost = settled & ~known
        beyond |= large | lost
        ends = np.quantile(change[known], (0.5, 0.95, 1.0)).tolist() if known.any() else [None] * 3
        found[cause] = Change(
            above_limit=int(large.sum()),
            unsettled=int(lost.sum()),
            median_deg_s=ends[0],
            q95_deg_s=ends[1],
            largest_deg_s=ends[2],
            digest=twin.digest(),
        )
    return Sensitivity(
        limit_deg_s=limit,
        clearance_change_m=twins.CLEARANCE_CHANGE,
        sensitive=int(beyond.sum()),
        by=found,
    )


def of_case(ensemble: Ensemble, number: int, nominal: Case) -> dict[str, float | None]:
    """Changes of the settled rates of one case (deg/s) by cause; None where the case or its twin
    does not settle."""
    found: dict[str, float | None] = {}
    for cause, twin in twins.of_ensemble(ensemble).items():
        rates = nominal.outcome.rate, twin.case(number)[1].outcome.rate
        found[cause] = None
        if rates[0] is not None and rates[1] is not None:
            (change,) = twins.change(*(np.array([rate]) for rate in rates))
            found[cause] = float(np.degrees(change))
    return found
