"""Ends of all searches, admissible points, Pareto front and exit state of the best set, as a netCDF
file with names and units.

Each input is a variable in its printed unit, with its bounds.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tipoff.files import write_netcdf
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.populations import answers
from validation import published
from validation.paper import exits, inputs, misfit, solutions, summary

if TYPE_CHECKING:
    import xarray


def save(path: Path, found: list[solutions.Search], best: int, left: Columns) -> None:
    """Write ``dataset`` atomically."""
    write_netcdf(path, dataset(found, best, left))


def dataset(found: list[solutions.Search], best: int, left: Columns) -> "xarray.Dataset":
    """Ends of the searches by ``search``, the exit state ``left`` of number ``best``, admissible
    points by ``point``, the Pareto front by ``pair``."""
    import xarray

    points = np.vstack([item.admissible for item in found])
    origin = np.repeat(np.arange(len(found)), [len(item.admissible) for item in found])
    variables = (
        _ends(found)
        | _inputs(
            "end", "search", np.array([item.shares for item in found]), "at the end of a search"
        )
        | _inputs("admissible", "point", points, "at an admissible point")
        | {"admissible_search": _of("point", origin, "search that found the point", "1")}
        | _traded(found)
        | {
            f"exit_{item.name}": _of(
                "condition",
                item.of(left),
                f"{item.label}, best set, NaN where it did not settle",
                item.unit,
            )
            for item in answers.ALL
        }
    )
    return xarray.Dataset(
        variables,
        _coordinates(len(found)),
        {
            "source": published.CITATION,
            "best_search": best,
            "admissible_deg_s": solutions.ADMISSIBLE,
            "negligible_deg_s": misfit.NEGLIGIBLE,
            "calibration": exits.CALIBRATION,
        },
    )


def _of(dimensions, values, words: str, unit: str, **more) -> tuple:
    return dimensions, values, {"long_name": words, "units": unit} | more


def _ends(found: list[solutions.Search]) -> dict[str, tuple]:
    return {
        "stress": _of(
            "search",
            [item.stress for item in found],
            "weight of the rates of conditions 1 and 5 in the search",
            "1",
        ),
        "seed": _of("search", [item.seed for item in found], "seed of the search", "1"),
        "misfit": _of(
            "search",
            [summary.misfit_of(item) for item in found],
            "misfit with conditions 1 and 5 at full weight",
            "1",
        ),
        "rates_deg_s": _of(
            ("search", "condition", "axis"),
            [item.rates for item in found],
            "settled rates",
            "deg/s",
        ),
        "changed_deg_s": _of(
            ("search", "sensitive_condition", "change", "axis"),
            [item.changed for item in found],
            "settled rates with one contact constant changed",
            "deg/s",
        ),
    }


def _inputs(prefix: str, dimension: str, shares: np.ndarray, where: str) -> dict[str, tuple]:
    """A variable for each input at points (n,p) of the unit cube."""
    return {
        f"{prefix}_{item.name}": _of(
            dimension,
            np.array([item.factor * item.value(share) for share in column]),
            f"{item.name.replace('_', ' ')} {where}"
            + (f", {item.unit}" if item.unit.startswith("of") else ""),
            "1" if item.unit.startswith("of") else item.unit,
            lower_bound=item.factor * item.low,
            upper_bound=item.factor * item.high,
            searched="logarithmic" if item.logarithmic else "linear",
            reason=item.reason,
        )
        for item, column in zip(inputs.UNKNOWNS, shares.T)
    }


def _traded(found: list[solutions.Search]) -> dict[str, tuple]:
    errors, sizes = summary.front(found).T
    return {
        "front_largest_error_deg_s": _of(
            "pair", errors, "largest error of the nine printed rates", "deg/s"
        ),
        "front_largest_negligible_deg_s": _of(
            "pair", sizes, "largest rate of conditions 1 and 5", "deg/s"
        ),
    }


def _coordinates(count: int) -> dict[str, tuple]:
    angles = published.angles()
    axial, radial = np.array(list(angles.values())).T
    return {
        "search": _of("search", np.arange(count), "number of the search in paper.json", "1"),
        "condition": _of("condition", list(angles), "condition of the paper's Table 1", "1"),
        "axial_misalignment": _of("condition", axial, "axial misalignment of the thrust", "deg"),
        "radial_misalignment": _of("condition", radial, "radial misalignment of the thrust", "deg"),
        "sensitive_condition": _of(
            "sensitive_condition",
            list(published.SENSITIVE),
            "condition of the paper's Table 2",
            "1",
        ),
        "change": (
            "change",
            list(summary.CHANGES),
            {"long_name": "changed contact constant and its value"},
        ),
        "axis": ("axis", list("xyz"), {"long_name": "payload body axis"}),
    }
