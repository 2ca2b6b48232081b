"""Statistics of cases that ran in both models: differences, their dependence on the number of
contacts, and statistics of the whole population corrected by them."""

from collections.abc import Callable

import numpy as np

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.populations import (
    allocation,
    answers,
    control_variate,
    exceedance,
    poststratified,
    spread,
)
from tipoff.studies.populations.control_variate import Estimate, Pairs
from tipoff.studies.populations.draws import Draws
from tipoff.studies.populations.population import Population

RATES = (*answers.RATES, answers.TOTAL_RATE)
_MOST_CONTACTS = 4  # those with more are in the same row
_QUANTILES = (0.5, 0.9, 0.95, 0.99)


def both_settled(drawn: Draws, whole: Population) -> np.ndarray:
    """Whether a draw settled in the reference and in the population (n,)."""
    count = len(drawn.reference.exit_time)
    return np.isfinite(drawn.reference.exit_time) & whole.settled[:count]


def _first(found: Columns, count: int) -> Columns:
    return Columns(*[values[:count] for values in found])


def _apart(quantity: answers.Quantity, one: Columns, other: Columns) -> dict | None:
    """Quantiles of the magnitude of the difference, its mean, and the correlation, over cases that
    settled in both; None without one."""
    values, others = quantity.of(one), quantity.of(other)
    both = np.isfinite(values) & np.isfinite(others)
    if not both.any():
        return None
    apart = (values - others)[both]
    size = np.abs(apart)
    return {
        "draws": int(both.sum()),
        "mean": float(apart.mean()),
        "median": float(np.median(size)),
        "95": float(np.quantile(size, 0.95)),
        "most": float(size.max()),
        "correlation": control_variate.correlation(values[both], others[both]),
    }


def errors(quantity: answers.Quantity, drawn: Draws, whole: Population) -> dict:
    """Differences from the reference: of the surrogate on the ``same_mesh``, of the ``population``
    that is studied, of the reference on the finer mesh, ``mesh``, and of the population from that,
    ``finer``."""
    count, fine = len(drawn.reference.exit_time), len(drawn.fine.exit_time)
    cases = _first(whole.results, count)
    return {
        "name": quantity.name,
        "label": quantity.label,
        "unit": quantity.unit,
        "same_mesh": _apart(quantity, drawn.surrogate, drawn.reference),
        "population": _apart(quantity, cases, drawn.reference),
        "mesh": _apart(quantity, _first(drawn.reference, fine), drawn.fine),
        "finer": _apart(quantity, _first(cases, fine), drawn.fine),
    }


def by_contacts(drawn: Draws, gate: float) -> list[dict]:
    """The largest error (deg/s) of any rate of a draw on the same mesh, by the number of contacts,
    and the share of draws within the ``gate`` (deg/s); the last row has all draws."""
    error = np.abs(np.degrees(drawn.surrogate.rate - drawn.reference.rate)).max(axis=1)
    number = np.minimum(drawn.contacts, _MOST_CONTACTS)
    groups = [(str(count), number == count) for count in range(_MOST_CONTACTS)]
    groups += [(f"{_MOST_CONTACTS} or more", number == _MOST_CONTACTS)]
    rows = []
    for name, inside in (*groups, ("all", np.ones_like(error, dtype=bool))):
        found = error[inside & np.isfinite(error)]
        low, high = (
            exceedance.bounds(int((found <= gate).sum()), found.size, spread.CONFIDENCE)
            if found.size
            else (None, None)
        )
        rows.append(
            {
                "contacts": name,
                "draws": int(inside.sum()),
                "settled": int(found.size),
                "median": float(np.median(found)) if found.size else None,
                "most": float(found.max()) if found.size else None,
                "within_gate": float((found <= gate).mean()) if found.size else None,
                "low": low,
                "high": high,
            }
        )
    return rows


def of(quantity: answers.Quantity, drawn: Draws, whole: Population) -> list[dict]:
    """Mean, standard deviation and quantiles of ``quantity``, corrected."""
    both = both_settled(drawn, whole)
    values = quantity.of(whole.results)
    paired = Pairs(
        quantity.of(drawn.reference)[both],
        values[: both.size][both],
        values[whole.settled],
    )
    shares = {f"{100.0 * share:g} % below": share for share in _QUANTILES}
    made: dict[str, Callable[[Pairs, float], Estimate]] = {
        "mean": control_variate.mean,
        "standard deviation": control_variate.standard_deviation,
        **{words: _quantile(share) for words, share in shares.items()},
    }
    return [
        {
            "name": quantity.name,
            "label": quantity.label,
            "unit": quantity.unit,
            "statistic": words,
            "share": shares.get(words),
            **_row(estimate(paired, spread.CONFIDENCE), paired.reference.size),
        }
        for words, estimate in made.items()
    ]


def optimal(quantity: answers.Quantity, drawn: Draws, whole: Population, cost_ratio: float) -> dict:
    """The correlation of both models in ``quantity``, and the optimal allocation of runs for its mean
    at a ``cost_ratio`` of the reference to the surrogate."""
    both = both_settled(drawn, whole)
    found = control_variate.correlation(
        quantity.of(drawn.reference)[both], quantity.of(whole.results)[: both.size][both]
    )
    best = allocation.optimal(found or 0.0, cost_ratio)
    return {"name": quantity.name, "correlation": found, **best._asdict()}


def _quantile(share: float) -> Callable[[Pairs, float], Estimate]:
    return lambda pairs, confidence: poststratified.quantile(pairs, share, confidence)


def tail(limit: exceedance.Limit, reference: Columns, population_: Columns) -> dict:
    """Probability of a rate above ``limit``, corrected; a case that did not settle counts as
    above."""
    above = exceedance.above(np.degrees(population_.rate), limit)
    event = exceedance.above(np.degrees(reference.rate), limit)
    first = above[: event.size]
    found = poststratified.probability(
        event, first, float(above.mean()), above.size, spread.CONFIDENCE
    )
    return {
        "limit": limit.words,
        **limit._asdict(),
        "above": int(event.sum()),
        "missed": int((event & ~first).sum()),
        "false": int((first & ~event).sum()),
        **_row(found, event.size),
    }


def _row(found: Estimate, runs: int) -> dict:
    return {**found._asdict(), "equivalent_runs": control_variate.equivalent_runs(found, runs)}


def pairs(drawn: Draws, whole: Population) -> dict:
    """Rates of both models (deg/s) and the contacts of every draw that settled in both."""
    both = both_settled(drawn, whole)
    rates = {
        item.name: {
            "reference": item.of(drawn.reference)[both].tolist(),
            "surrogate": item.of(whole.results)[: both.size][both].tolist(),
        }
        for item in RATES
    }
    return {"contacts": drawn.contacts[both].tolist(), "rates": rates}
