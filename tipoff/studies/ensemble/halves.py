"""What halving each tolerance of an ensemble gains, one at a time: the quantile of the total rate, and the
probability that a rate is above a limit.

All populations have the same draws, so a change is that of the tolerance, and its bounds come from the
pairs of cases (``populations.paired``).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tipoff.scenes import halving
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.populations import exceedance, paired, spread
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.paired import Bounded

SHARE = 0.95
Rates = Callable[[Uncertainty, str], np.ndarray]
"""Rates (n,3), deg/s, of the cases of errors; NaN in a case without a rate. The text is the name of the
halved tolerance, empty if none is."""


@dataclass(frozen=True, kw_only=True)
class Halved:
    """Cases with the ``tolerance`` halved (None: none is): 95 % of its values as stated and halved;
    ``rate``, the quantile of the total rate (deg/s); ``above``, the share of the cases above any limit or
    without a rate, None without a limit; the changes from the
    errors as stated, None in their own row; ``unsettled``, cases without a rate."""

    tolerance: str | None
    stated: str
    halved: str
    rate: Bounded
    rate_change: Bounded | None
    above: Bounded | None
    above_change: Bounded | None
    unsettled: int


def table(errors: Uncertainty, rates: Rates, limits: Sequence[Limit]) -> tuple[Halved, ...]:
    """The row of the ``errors`` as stated, then a row for each tolerance, the largest decrease of the
    quantile first. Empty if no case has a rate with one of them."""
    bounded = errors.sampling == "random"
    names = [None, *halving.tolerances(errors)]
    changed = [errors if name is None else halving.halved(errors, name) for name in names]
    all_rates = [rates(each, name or "") for each, name in zip(changed, names)]
    totals = [np.linalg.norm(each, axis=1) for each in all_rates]
    if not all(np.isfinite(each).any() for each in totals):
        return ()
    events = [exceedance.any_above(each, limits) for each in all_rates] if limits else None
    changes = paired.quantile_changes(totals[0], totals[1:], SHARE, spread.CONFIDENCE)
    rows = []
    for place, name in enumerate(names):
        settled = totals[place][np.isfinite(totals[place])]
        rows.append(
            Halved(
                tolerance=name,
                stated="" if name is None else halving.words(errors, name),
                halved="" if name is None else halving.words(changed[place], name),
                rate=_quantile(settled, bounded),
                rate_change=_bounded(changes[place - 1], bounded) if name else None,
                above=None if events is None else _share(events[place], bounded),
                above_change=_bounded(
                    paired.share_change(events[0], events[place], spread.CONFIDENCE), bounded
                )
                if events is not None and name
                else None,
                unsettled=len(totals[place]) - len(settled),
            )
        )
    return rows[0], *sorted(rows[1:], key=_value)


def _value(row: Halved) -> float:
    assert row.rate_change is not None  # every row but the first has one
    return row.rate_change.value


def _quantile(values: np.ndarray, bounded: bool) -> Bounded:
    (found,) = spread.quantiles(values, (SHARE,), bounded)
    assert found.value is not None  # there are values
    return Bounded(found.value, found.low, found.high)


def _share(events: np.ndarray, bounded: bool) -> Bounded:
    count = int(events.sum())
    low, high = (
        exceedance.bounds(count, len(events), spread.CONFIDENCE) if bounded else (None, None)
    )
    return Bounded(count / len(events), low, high)


def _bounded(change: Bounded, bounded: bool) -> Bounded:
    return change if bounded else Bounded(change.value, None, None)
