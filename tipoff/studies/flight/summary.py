"""Results of flights as plain values with units: rows of one case, distributions over many cases,
and a dataset.

Each also holds the state at the exit, under the names of ``studies.populations.answers``.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tipoff.comparison import order_statistics
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.flight import bodies
from tipoff.studies.flight.flown import Flown
from tipoff.studies.populations import answers, exceedance
from tipoff.studies.populations.answers import Left
from tipoff.studies.populations.population import Population

if TYPE_CHECKING:
    import xarray

SHARES = (0.0027, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_SCATTERED = 2000  # points of a picture


class Quantity(NamedTuple):
    """``name`` with its unit as in result files, ``words`` as label, and its values (n,) of
    flights."""

    name: str
    words: str
    of: Callable[[Flown], np.ndarray]


QUANTITIES = (
    Quantity("miss_m", "miss distance (m)", lambda found: np.hypot(*found.miss.T)),
    Quantity(
        "tip_off_miss_m",
        "miss distance by ejection errors (m)",
        lambda found: np.hypot(*(found.miss - found.orbital).T),
    ),
    Quantity("passes_s", "time of passing the target (s)", lambda found: found.passes),
    Quantity(
        "pointing_deg",
        "pointing error at the target (deg)",
        lambda found: np.degrees(found.pointing),
    ),
    Quantity("limit_s", "time to the pointing limit (s)", lambda found: found.limit),
    Quantity(
        "cone_least_deg",
        "smallest cone angle (deg)",
        lambda found: np.degrees(found.cone[:, 0]),
    ),
    Quantity(
        "cone_largest_deg",
        "largest cone angle (deg)",
        lambda found: np.degrees(found.cone[:, 1]),
    ),
    Quantity(
        "coning_deg_s",
        "coning rate (deg/s)",
        lambda found: np.degrees(found.coning),
    ),
    Quantity("nutation_s", "nutation period (s)", lambda found: found.nutation),
    Quantity("clearance_mm", "smallest clearance (mm)", lambda found: 1e3 * found.clearance),
    Quantity("closest_ms", "time of smallest clearance (ms)", lambda found: 1e3 * found.closest),
    Quantity("returns_m", "smallest gap on return (m)", lambda found: found.returns),
)
_SIDES: dict[str, Callable[[Flown], np.ndarray]] = {
    "miss_y_m": lambda found: found.miss[:, 0],
    "miss_z_m": lambda found: found.miss[:, 1],
    "orbital_y_m": lambda found: found.orbital[:, 0],
    "orbital_z_m": lambda found: found.orbital[:, 1],
}
WORDS = {item.name: f"{item.label} ({item.unit})" for item in answers.ALL} | {
    item.name: item.words for item in QUANTITIES
}
_JUDGED = (
    "miss_m",
    "tip_off_miss_m",
    "pointing_deg",
    "limit_s",
    "cone_largest_deg",
    "coning_deg_s",
    "clearance_mm",
    "returns_m",
)


def orbit(scene: Scene) -> dict:
    """The requested flight, resolved. ``no_clearance`` is the reason why no clearance is computed,
    empty where one is; ``rails_listed``: the rails count only where ``flight.envelope`` lists
    them."""
    flight = bodies.table_of(scene).record()
    return {
        "mean_motion_rad_s": flight.mean_motion,
        "period_s": 2.0 * np.pi / flight.mean_motion,
        "duration_s": flight.duration,
        "range_m": flight.range,
        "launch_axis": flight.axes[:, 0].tolist(),
        "no_clearance": bodies.unknown_size(scene),
        "rails_listed": bodies.unknown_rails(scene),
        "pointing_limit_deg": flight.pointing_limit and float(np.degrees(flight.pointing_limit)),
    }


def row(found: Flown, left: Left, case: int) -> dict:
    """One case with its state ``left`` at the exit; None for a value that does not exist, or an
    instant that never comes."""
    values = {item.name: float(item.of(left)[case]) for item in answers.ALL}
    values |= {item.name: float(item.of(found)[case]) for item in QUANTITIES}
    values |= {name: float(of(found)[case]) for name, of in _SIDES.items()}
    return {name: value if np.isfinite(value) else None for name, value in values.items()}


def cases(found: Flown, population: Population, uncertainty: Uncertainty) -> dict:
    """Counts, quantiles with bounds, the shares that touch the platform again and that never reach
    the target, and points for the figure."""
    independent = uncertainty.sampling == "random"
    known, reached, settled = (
        np.isfinite(found.clearance),
        np.isfinite(found.passes),
        population.settled,
    )
    judged = {item.name: item.of(population.results)[settled] for item in answers.ALL}
    judged |= {
        item.name: values
        for item in QUANTITIES
        if item.name in _JUDGED and np.isfinite(values := item.of(found)).any()
    }
    points = np.hstack([found.miss, found.orbital])[reached][:_SCATTERED]
    why = (
        "order statistics of independent draws"
        if independent
        else f"none: {uncertainty.sampling} samples are not independent"
    )
    return {
        "counts": population.counts,
        "settled": int(settled.sum()),
        "store": population.store,
        "confidence": CONFIDENCE,
        "varied": uncertainty.resolved(),
        "bounds": why,
        "quantiles": {
            name: _quantiles(values[~np.isnan(values)], independent)
            for name, values in judged.items()
        },
        # where all are open, the scene has no limit
        "limit_open": 0 if np.isnan(found.limit).all() else int(np.isnan(found.limit).sum()),
        "touch": _share(found.clearance[known] <= 0.0, independent),
        "not_reached": _share(~reached, independent),
        "points_m": [[float(f"{value:.6g}") for value in point] for point in points],
    }


def _quantiles(values: np.ndarray, independent: bool) -> list[dict]:
    """Quantiles that are values of cases; None where that case never reaches the event."""
    rows = []
    for share in SHARES:
        ends = order_statistics.bounds(values, share, CONFIDENCE) if independent else (None, None)
        value = np.quantile(values, share, method="inverted_cdf")
        rows.append(
            {
                "share": share,
                **{
                    name: None if end is None or not np.isfinite(end) else float(end)
                    for name, end in zip(("value", "low", "high"), (value, *ends))
                },
            }
        )
    return rows


def _share(flags: np.ndarray, independent: bool) -> dict | None:
    """Count of the cases with a flag, their share, and its bounds (Clopper and Pearson); None
    without cases."""
    if not len(flags):
        return None
    count = int(flags.sum())
    ends = exceedance.bounds(count, len(flags), CONFIDENCE) if independent else (None, None)
    return {
        "count": count,
        "of": len(flags),
        "share": count / len(flags),
        "low": ends[0],
        "high": ends[1],
    }


def dataset(
    names: list[str], single: Flown | None, exits: bodies.Exits | None, many: Flown, left: Columns
) -> "xarray.Dataset":
    """Every quantity by condition (its flight and its ``exits``) and by case; names hold the
    unit."""
    import xarray

    variables = {item.name: ("case", item.of(left)) for item in answers.ALL}
    variables |= {item.name: ("case", item.of(many)) for item in QUANTITIES}
    variables |= {name: ("case", of(many)) for name, of in _SIDES.items()}
    if single is not None and exits is not None:
        variables |= {
            f"condition_{item.name}": ("condition", item.of(exits)) for item in answers.ALL
        }
        variables |= {
            f"condition_{item.name}": ("condition", item.of(single)) for item in QUANTITIES
        }
    return xarray.Dataset(variables, {"condition": names, "case": np.arange(len(many.passes))})
