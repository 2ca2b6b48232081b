"""Statistics of cases that ran in both models: differences, their dependence on the number of
contacts, and statistics of the whole population corrected by them."""

from collections.abc import Callable

import numpy as np

from tipoff.lowfi.ensemble import twins
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
from tipoff.studies.populations.own_modes import OwnModes
from tipoff.studies.populations.population import Population

RATES = (*answers.RATES, answers.TOTAL_RATE)
_MOST_CONTACTS = 4  # those with more are in the same row
_QUANTILES = (0.5, 0.9, 0.95, 0.99)


def both_settled(drawn: Draws, whole: Population) -> np.ndarray:
    """Whether a draw settled in the reference and in the population (n,)."""
    count = len(drawn.reference.exit_time)
    return np.isfinite(drawn.reference.exit_time) & whole.settled[:count]


def _part(found: Columns, which: slice | np.ndarray) -> Columns:
    return Columns(*[values[which] for values in found])


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
    cases = _part(whole.results, slice(count))
    return {
        "name": quantity.name,
        "label": quantity.label,
        "unit": quantity.unit,
        "same_mesh": _apart(quantity, drawn.surrogate, drawn.reference),
        "population": _apart(quantity, cases, drawn.reference),
        "mesh": _apart(quantity, _part(drawn.reference, slice(fine)), drawn.fine),
        "finer": _apart(quantity, _part(cases, slice(fine)), drawn.fine),
    }


def by_contacts(drawn: Draws, gate: float) -> list[dict]:
    """The largest error (deg/s) of any rate of a draw on the same mesh, by the number of contacts,
    and the share of draws within the ``gate`` (deg/s); the last row has all draws."""
    error = _largest(drawn.surrogate, drawn.reference)
    number = np.minimum(drawn.contacts, _MOST_CONTACTS)
    groups = [(str(count), number == count) for count in range(_MOST_CONTACTS)]
    groups += [(f"{_MOST_CONTACTS} or more", number == _MOST_CONTACTS)]
    groups += [("all", np.ones_like(error, dtype=bool))]
    return [{"contacts": name, **_agreement(error[inside], gate)} for name, inside in groups]


def _largest(one: Columns, other: Columns) -> np.ndarray:
    """Largest difference (n,) of the settled rates over the axes, deg/s; NaN where one has none."""
    return np.degrees(twins.change(one.rate, other.rate))


def _agreement(error: np.ndarray, gate: float) -> dict:
    """Median and largest ``error`` (deg/s) of draws that settled, and their share within the ``gate``
    (deg/s) with its bounds."""
    found = error[np.isfinite(error)]
    low, high = (
        exceedance.bounds(int((found <= gate).sum()), found.size, spread.CONFIDENCE)
        if found.size
        else (None, None)
    )
    return {
        "draws": int(error.size),
        "settled": int(found.size),
        "median": float(np.median(found)) if found.size else None,
        "most": float(found.max()) if found.size else None,
        "within_gate": float((found <= gate).mean()) if found.size else None,
        "low": low,
        "high": high,
    }


def by_modes(own: OwnModes, drawn: Draws, gate: float) -> dict:
    """The draws by rail modes. ``rows``: agreement as in ``by_contacts``, ``modes`` and processor
    seconds of a single run and of a case of a population, with one number in every draw and, last,
    with those that each draw chooses.
    ``choosing``: how many draws choose some modes, ``choosing_all`` those that the rails have.
    ``moved_deg_s``: largest change of a rate by the chosen modes, median over the draws that choose
    some; ``moved_by_clearance_deg_s``: the same by ``clearance_change_m``; ``more_by_clearance``:
    how many of these draws the clearance moves more."""
    chose = own.chosen > 0
    with_modes, without = (_part(series.results, chose) for series in (own.own, own.same[0]))
    by_choice, by_clearance = (_largest(with_modes, other) for other in (without, own.wider))
    return {
        "held": own.held,
        "choosing": int(chose.sum()),
        "choosing_all": int((own.chosen == own.held).sum()),
        "moved_deg_s": _median(by_choice),
        "clearance_change_m": own.clearance_change,
        "moved_by_clearance_deg_s": _median(by_clearance),
        "more_by_clearance": int((by_clearance > by_choice).sum()),
        "rows": [
            {
                "modes": series.modes,
                "cpu_s": series.cpu_s,
                "case_s": series.case_s,
                **_agreement(_largest(series.results, drawn.reference), gate),
            }
            for series in (*own.same, own.own)
        ],
    }


def _median(values: np.ndarray) -> float | None:
    """Median of those that are finite; None without one."""
    found = values[np.isfinite(values)]
    return float(np.median(found)) if found.size else None


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
        **vars(limit),
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
