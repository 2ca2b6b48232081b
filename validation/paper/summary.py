"""Results of the searches in the paper's units: errors of each search, range of every input, counts
of admissible points."""

import numpy as np

from validation import published
from validation.paper import inputs, misfit, solutions

_UNITS = {"k": "N/mm^e", "c": "N s/mm", "d": "mm"}
# the rows of Table 2 in words
CHANGES = tuple(f"{name} = {value:g} {_UNITS[name]}" for name, value in published.CHANGES)


def misfit_of(found: solutions.Search) -> float:
    """Misfit with full weight of the rates of conditions 1 and 5."""
    return misfit.whole(found.rates, found.changed, 1.0)


def of_search(found: solutions.Search) -> dict:
    """End of a search: errors and rates in deg/s, ``values`` of the inputs in SI."""
    return {
        "stress": found.stress,
        "seed": found.seed,
        "largest_error_deg_s": float(np.abs(misfit.nine(found.rates)).max()),
        "largest_negligible_deg_s": solutions.largest_negligible(found.rates),
        "largest_deviation_error_deg_s": solutions.largest_of_deviations(
            found.rates, found.changed
        ),
        "misfit": misfit_of(found),
        "rates_deg_s": found.rates.tolist(),
        "changed_deg_s": found.changed.tolist(),
        "values": inputs.values(found.shares),
        "admissible": len(found.admissible),
    }


def ranges(found: list[solutions.Search], best: solutions.Search) -> list[dict]:
    """Every input in its printed unit: bounds, best, range of the admissible set and its share of
    the bounds on the scale of the search; None if the set is empty."""
    points = np.vstack([item.admissible for item in found])
    rows = []
    for number, item in enumerate(inputs.UNKNOWNS):
        ends = (
            [float(end) for end in np.quantile(points[:, number], (0.0, 1.0))]
            if len(points)
            else None
        )
        rows.append(
            {
                "name": item.name,
                "unit": item.unit,
                "low": item.factor * item.low,
                "high": item.factor * item.high,
                "best": item.factor * item.value(best.shares[number]),
                "from": ends and item.factor * item.value(ends[0]),
                "to": ends and item.factor * item.value(ends[1]),
                "share": ends and ends[1] - ends[0],
                "reason": item.reason,
            }
        )
    return rows


def counted(found: list[solutions.Search]) -> dict[str, int]:
    """Numbers of admissible points, of searches with such points, and of points of one search at
    most."""
    counts = [len(item.admissible) for item in found]
    return {
        "points": sum(counts),
        "searches": sum(count > 0 for count in counts),
        "most_of_one": max(counts),
    }


def front(found: list[solutions.Search]) -> np.ndarray:
    """Pareto front (m,2), deg/s, of all searches together; see ``solutions.Search.front``."""
    return solutions.front(*np.vstack([item.front for item in found]).T)
