"""Results of flights: quantities of one case, distributions over many cases, and a dataset.

Each also holds the state at the exit, under the names of ``studies.populations.answers``.
"""

from typing import TYPE_CHECKING

import numpy as np

from tipoff.comparison import order_statistics
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty, Varied
from tipoff.studies.flight import bodies
from tipoff.studies.flight.flown import Flown
from tipoff.studies.flight.results import ManyFlights, Orbit, Share
from tipoff.studies.populations import answers, exceedance
from tipoff.studies.populations.answers import Left, Quantity
from tipoff.studies.populations.population import Population
from tipoff.studies.populations.spread import Quantile

if TYPE_CHECKING:
    import xarray

SHARES = (0.0027, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_SCATTERED = 2000  # points of a picture


def _apart(found: Flown) -> np.ndarray:
    return np.hypot(*(found.miss - found.orbital).T)


QUANTITIES = (
    Quantity("miss_m", "miss distance", "m", lambda found: np.hypot(*found.miss.T)),
    Quantity("tip_off_miss_m", "miss distance by ejection errors", "m", _apart),
    Quantity("passes_s", "time of passing the target", "s", lambda found: found.passes),
    Quantity(
        "pointing_deg",
        "pointing error at the target",
        "deg",
        lambda found: np.degrees(found.pointing),
    ),
    Quantity("limit_s", "time to the pointing limit", "s", lambda found: found.limit),
    Quantity(
        "cone_least_deg", "smallest cone angle", "deg", lambda found: np.degrees(found.cone[:, 0])
    ),
    Quantity(
        "cone_largest_deg", "largest cone angle", "deg", lambda found: np.degrees(found.cone[:, 1])
    ),
    Quantity("coning_deg_s", "coning rate", "deg/s", lambda found: np.degrees(found.coning)),
    Quantity("nutation_s", "nutation period", "s", lambda found: found.nutation),
    Quantity("clearance_mm", "smallest clearance", "mm", lambda found: 1e3 * found.clearance),
    Quantity("closest_ms", "time of smallest clearance", "ms", lambda found: 1e3 * found.closest),
    Quantity("returns_m", "smallest gap on return", "m", lambda found: found.returns),
)
SIDES = (
    Quantity("miss_y_m", "miss along y", "m", lambda found: found.miss[:, 0]),
    Quantity("miss_z_m", "miss along z", "m", lambda found: found.miss[:, 1]),
    Quantity("orbital_y_m", "miss along y without errors", "m", lambda found: found.orbital[:, 0]),
    Quantity("orbital_z_m", "miss along z without errors", "m", lambda found: found.orbital[:, 1]),
)
BY_NAME = {item.name: item for item in (*answers.ALL, *QUANTITIES)}
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


def orbit(scene: Scene) -> Orbit:
    """The requested flight of a scene."""
    flight = bodies.table_of(scene).record()
    return Orbit(
        mean_motion_rad_s=flight.mean_motion,
        period_s=2.0 * np.pi / flight.mean_motion,
        duration_s=flight.duration,
        range_m=flight.range,
        launch_axis=tuple(flight.axes[:, 0].tolist()),
        no_clearance=bodies.unknown_size(scene),
        rails_listed=bodies.unknown_rails(scene),
        pointing_limit_deg=flight.pointing_limit and float(np.degrees(flight.pointing_limit)),
    )


def _values(found: Flown, left: Left) -> dict[str, np.ndarray]:
    """All quantities (n,) of flights and of their states at the exit, ``left``, by name."""
    return {item.name: item.of(left) for item in answers.ALL} | {
        item.name: item.of(found) for item in (*QUANTITIES, *SIDES)
    }


def row(found: Flown, left: Left, case: int) -> dict[str, float | None]:
    """One case; None for a value that does not exist, or an event that does not occur."""
    return {name: _finite(values[case]) for name, values in _values(found, left).items()}


def _finite(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)


def cases(found: Flown, population: Population, uncertainty: Uncertainty) -> ManyFlights:
    """The distributions over the flights of a population."""
    independent = uncertainty.sampling == "random"
    known, reached, settled = (
        np.isfinite(found.clearance),
        np.isfinite(found.passes),
        population.settled,
    )
    judged = {item.name: item.of(population.results)[settled] for item in answers.ALL}
    judged |= {
        name: values for name in _JUDGED if np.isfinite(values := BY_NAME[name].of(found)).any()
    }
    points = np.hstack([found.miss, found.orbital])[reached][:_SCATTERED]
    why = (
        "order statistics of independent draws"
        if independent
        else f"none: {uncertainty.sampling} samples are not independent"
    )
    is_open = np.isnan(found.limit)
    return ManyFlights(
        counts=population.counts,
        settled=int(settled.sum()),
        store=population.store,
        confidence=CONFIDENCE,
        varied=Varied(**uncertainty.resolved()),
        bounds=why,
        quantiles={
            name: tuple(_quantiles(values[~np.isnan(values)], independent))
            for name, values in judged.items()
        },
        # if it is open in all cases, the scene has no limit
        limit_open=0 if is_open.all() else int(is_open.sum()),
        touch=_share(found.clearance[known] <= 0.0, independent),
        not_reached=_share(~reached, independent),
        points_m=plain(points),
    )


def plain(values: np.ndarray) -> tuple:
    """Values with six digits, enough for every figure."""
    if values.ndim > 1:
        return tuple(map(plain, values))
    return tuple(float(f"{value:.6g}") for value in values)


def _quantiles(values: np.ndarray, independent: bool) -> list[Quantile]:
    """Quantiles that are values of cases; None if that case does not reach the event."""
    rows = []
    for share in SHARES:
        ends = order_statistics.bounds(values, share, CONFIDENCE) if independent else (None, None)
        value = np.quantile(values, share, method="inverted_cdf")
        rows.append(Quantile(share, *map(_finite, (value, *ends))))
    return rows


def _share(flags: np.ndarray, independent: bool) -> Share | None:
    """The cases with a flag; None without cases."""
    if not len(flags):
        return None
    count = int(flags.sum())
    low, high = exceedance.bounds(count, len(flags), CONFIDENCE) if independent else (None, None)
    return Share(count=count, of=len(flags), share=count / len(flags), low=low, high=high)


def dataset(
    names: list[str], single: Flown | None, exits: Columns | None, many: Flown, left: Columns
) -> "xarray.Dataset":
    """Every quantity by condition (its flight and its ``exits``) and by case; names hold the
    unit."""
    import xarray

    variables = {name: ("case", values) for name, values in _values(many, left).items()}
    if single is not None and exits is not None:
        variables |= {
            f"condition_{name}": ("condition", values)
            for name, values in _values(single, exits).items()
        }
    return xarray.Dataset(variables, {"condition": names, "case": np.arange(len(many.passes))})
