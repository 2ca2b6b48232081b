"""Statistics of cases that ran in both models: differences, their dependence on the number of
contacts, and statistics of the whole population corrected by them."""

from collections.abc import Callable

import numpy as np

from tipoff.lowfi.ensemble import twins
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.populations import answers, exceedance, spread
from tipoff.studies.populations.draws import Draws
from tipoff.studies.populations.population import Population
from validation.montecarlo import allocation, control_variate, poststratified, rungs
from validation.montecarlo.control_variate import Estimate, Pairs
from validation.montecarlo.results import (
    Agreement,
    Apart,
    ByContacts,
    ByRung,
    CorrectedTail,
    DrawnPairs,
    Errors,
    Ladder,
    Optimal,
    Statistic,
)

RATES = (*answers.RATES, answers.TOTAL_RATE)
_MOST_CONTACTS = 4  # draws with more contacts are in the same row
_QUANTILES = (0.5, 0.9, 0.95, 0.99)


def both_settled(drawn: Draws, whole: Population) -> np.ndarray:
    """Whether a draw settled in the reference and in the population (n,)."""
    count = len(drawn.reference.exit_time)
    return np.isfinite(drawn.reference.rate[:, 0]) & whole.settled[:count]


def _part(found: Columns, which: slice | np.ndarray) -> Columns:
    return Columns(*[values[which] for values in found])


def _apart(quantity: answers.Quantity, one: Columns, other: Columns) -> Apart | None:
    """The difference over cases that settled in both; None without one."""
    values, others = quantity.of(one), quantity.of(other)
    both = np.isfinite(values) & np.isfinite(others)
    if not both.any():
        return None
    apart = (values - others)[both]
    size = np.abs(apart)
    return Apart(
        draws=int(both.sum()),
        mean=float(apart.mean()),
        median=float(np.median(size)),
        most_95=float(np.quantile(size, 0.95)),
        most=float(size.max()),
        correlation=control_variate.correlation(values[both], others[both]),
    )


def errors(quantity: answers.Quantity, drawn: Draws, whole: Population) -> Errors:
    """Differences from the reference."""
    count, fine = len(drawn.reference.exit_time), len(drawn.fine.exit_time)
    cases = _part(whole.results, slice(count))
    return Errors(
        **quantity.named,
        same_mesh=_apart(quantity, drawn.surrogate, drawn.reference),
        population=_apart(quantity, cases, drawn.reference),
        mesh=_apart(quantity, _part(drawn.reference, slice(fine)), drawn.fine),
        finer=_apart(quantity, _part(cases, slice(fine)), drawn.fine),
    )


def by_contacts(drawn: Draws, gate: float) -> list[ByContacts]:
    """The largest error (deg/s) of any rate of a draw on the same mesh, by the number of contacts;
    the last row has all draws."""
    error = _largest(drawn.surrogate, drawn.reference)
    number = np.minimum(drawn.contacts, _MOST_CONTACTS)
    groups = [(str(count), number == count) for count in range(_MOST_CONTACTS)]
    groups += [(f"{_MOST_CONTACTS} or more", number == _MOST_CONTACTS)]
    groups += [("all", np.ones_like(error, dtype=bool))]
    return [
        ByContacts(**vars(_agreement(error[inside], gate)), contacts=name)
        for name, inside in groups
    ]


def _largest(one: Columns, other: Columns) -> np.ndarray:
    """Largest difference (n,) of the settled rates over the axes, deg/s; NaN where a draw did not
    settle."""
    return np.degrees(twins.change(one.rate, other.rate))


def _agreement(error: np.ndarray, gate: float) -> Agreement:
    """Agreement over draws with an ``error`` (deg/s), NaN where a draw did not settle."""
    found = error[np.isfinite(error)]
    within, some = int((found <= gate).sum()), bool(found.size)
    low, high = exceedance.bounds(within, found.size, spread.CONFIDENCE) if some else (None, None)
    return Agreement(
        draws=int(error.size),
        settled=int(found.size),
        median=float(np.median(found)) if some else None,
        most=float(found.max()) if some else None,
        within_gate=float((found <= gate).mean()) if some else None,
        low=low,
        high=high,
    )


def ladder(found: rungs.Rungs, drawn: Draws, gate: float) -> Ladder:
    """The draws by settings of the surrogate, with agreement as in ``by_contacts``."""
    chose = found.chosen > 0
    with_modes, without = (_part(rung.results, chose) for rung in (found.own, found.same[0]))
    by_choice, by_clearance = (_largest(with_modes, other) for other in (without, found.wider))
    return Ladder(
        held=found.held,
        choosing=int(chose.sum()),
        choosing_all=int((found.chosen == found.held).sum()),
        moved_deg_s=_median(by_choice),
        clearance_change_m=found.clearance_change,
        moved_by_clearance_deg_s=_median(by_clearance),
        more_by_clearance=int((by_clearance > by_choice).sum()),
        rows=tuple(_by_rung(rung, drawn, gate) for rung in (*found.same, found.own, *found.others)),
    )


def _by_rung(rung: rungs.Rung, drawn: Draws, gate: float) -> ByRung:
    error, numerics = _largest(rung.results, drawn.reference), rung.numerics
    settled = error[np.isfinite(error)]
    return ByRung(
        **vars(_agreement(error, gate)),
        most_95=float(np.quantile(settled, 0.95)) if settled.size else None,
        model=rung.model,
        modes=numerics.modes,
        degree=numerics.known_degree,
        cells=numerics.cells,
        cpu_s=rung.cpu_s,
        case_s=rung.case_s,
    )


def _median(values: np.ndarray) -> float | None:
    """Median of the finite values; None without one."""
    found = values[np.isfinite(values)]
    return float(np.median(found)) if found.size else None


def statistics(quantity: answers.Quantity, drawn: Draws, whole: Population) -> list[Statistic]:
    """Mean, standard deviation and quantiles of ``quantity``, corrected."""
    both = both_settled(drawn, whole)
    values = quantity.of(whole.results)
    paired = Pairs(
        quantity.of(drawn.reference)[both], values[: both.size][both], values[whole.settled]
    )
    shares = {f"{100.0 * share:g} % below": share for share in _QUANTILES}
    made: dict[str, Callable[[Pairs, float], Estimate]] = {
        "mean": control_variate.mean,
        "standard deviation": control_variate.standard_deviation,
        **{words: _quantile(share) for words, share in shares.items()},
    }
    found = {words: estimate(paired, spread.CONFIDENCE) for words, estimate in made.items()}
    return [
        Statistic(
            **vars(each),
            **quantity.named,
            statistic=words,
            share=shares.get(words),
            equivalent_runs=control_variate.equivalent_runs(each, paired.reference.size),
        )
        for words, each in found.items()
    ]


def optimal(
    quantity: answers.Quantity, drawn: Draws, whole: Population, cost_ratio: float
) -> Optimal:
    """The correlation of both models in ``quantity``, and the optimal allocation of runs for its mean
    at a ``cost_ratio`` of the reference to the surrogate."""
    both = both_settled(drawn, whole)
    found = control_variate.correlation(
        quantity.of(drawn.reference)[both], quantity.of(whole.results)[: both.size][both]
    )
    best = allocation.optimal(found or 0.0, cost_ratio)
    return Optimal(**vars(best), name=quantity.name, correlation=found)


def _quantile(share: float) -> Callable[[Pairs, float], Estimate]:
    return lambda pairs, confidence: poststratified.quantile(pairs, share, confidence)


def tail(limit: exceedance.Limit, reference: Columns, population_: Columns) -> CorrectedTail:
    """Probability of a rate above ``limit``, corrected; a case that did not settle counts as
    above."""
    above = exceedance.above(np.degrees(population_.rate), limit)
    event = exceedance.above(np.degrees(reference.rate), limit)
    first = above[: event.size]
    found = poststratified.probability(
        event, first, float(above.mean()), above.size, spread.CONFIDENCE
    )
    return CorrectedTail(
        **vars(limit),
        **vars(found),
        limit=limit.words,
        above=int(event.sum()),
        missed=int((event & ~first).sum()),
        false=int((first & ~event).sum()),
        equivalent_runs=control_variate.equivalent_runs(found, event.size),
    )


def pairs(drawn: Draws, whole: Population) -> DrawnPairs:
    """Rates of both models and the contacts of every draw that settled in both."""
    both = both_settled(drawn, whole)
    rates = {
        item.name: {
            "reference": tuple(item.of(drawn.reference)[both].tolist()),
            "surrogate": tuple(item.of(whole.results)[: both.size][both].tolist()),
        }
        for item in RATES
    }
    return DrawnPairs(contacts=tuple(drawn.contacts[both].tolist()), rates=rates)
