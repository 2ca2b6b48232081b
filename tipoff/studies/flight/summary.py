"""What flights amount to in the units an engineer reads: rows of one case, distributions over many,
and data.

Beside each stands what the payload left its rail with, under the names that every study of
tolerances has for it.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.stats import binomtest

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.flight import bodies
from tipoff.studies.flight.flown import Flown
from tipoff.studies.populations import answers, order_statistics, population
from tipoff.studies.populations.answers import Left
from tipoff.studies.populations.population import Population

if TYPE_CHECKING:
    import xarray

SHARES = (0.0027, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_SCATTERED = 2000  # points of a picture


class Quantity(NamedTuple):
    """``name`` with its unit as in result files, ``words`` for the reader, and its values (n,) of
    flights."""

    name: str
    words: str
    of: Callable[[Flown], np.ndarray]


QUANTITIES = (
    Quantity("miss_m", "miss of the target (m)", lambda found: np.hypot(*found.miss.T)),
    Quantity(
        "tip_off_miss_m",
        "of which errors of the ejection (m)",
        lambda found: np.hypot(*(found.miss - found.orbital).T),
    ),
    Quantity("passes_s", "passes the target after (s)", lambda found: found.passes),
    Quantity(
        "pointing_deg", "pointing error there (deg)", lambda found: np.degrees(found.pointing)
    ),
    Quantity("limit_s", "pointing limit reached after (s)", lambda found: found.limit),
    Quantity(
        "cone_least_deg",
        "x axis from angular momentum, least (deg)",
        lambda found: np.degrees(found.cone[:, 0]),
    ),
    Quantity(
        "cone_largest_deg",
        "x axis from angular momentum, largest (deg)",
        lambda found: np.degrees(found.cone[:, 1]),
    ),
    Quantity(
        "coning_deg_s",
        "x axis about angular momentum (deg/s)",
        lambda found: np.degrees(found.coning),
    ),
    Quantity("nutation_s", "nutation period (s)", lambda found: found.nutation),
    Quantity("clearance_mm", "least clearance (mm)", lambda found: 1e3 * found.clearance),
    Quantity("closest_ms", "least clearance after (ms)", lambda found: 1e3 * found.closest),
    Quantity("returns_m", "comes back to (m)", lambda found: found.returns),
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
    """The requested flight, resolved; ``no_clearance`` says why none is computed, empty where one
    is; ``rails_listed`` whether the rails are among the boxes only if the scene lists them."""
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
    """One case, and what it ``left`` its rail with; None for what has no value, or is never."""
    values = {item.name: float(item.of(left)[case]) for item in answers.ALL}
    values |= {item.name: float(item.of(found)[case]) for item in QUANTITIES}
    values |= {name: float(of(found)[case]) for name, of in _SIDES.items()}
    return {name: value if np.isfinite(value) else None for name, value in values.items()}


def cases(found: Flown, population: Population, uncertainty: Uncertainty) -> dict:
    """Counts, quantiles with bounds, how many touch again and how many never reach the target, and
    points to draw."""
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
        else f"none: points of {uncertainty.sampling} depend on each other"
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
        # all: none was asked for
        "limit_open": 0 if np.isnan(found.limit).all() else int(np.isnan(found.limit).sum()),
        "touch": _share(found.clearance[known] <= 0.0, independent),
        "not_reached": _share(~reached, independent),
        "points_m": [[float(f"{value:.6g}") for value in point] for point in points],
    }


def _quantiles(values: np.ndarray, independent: bool) -> list[dict]:
    """Quantiles that are values of cases, so that a time that is never stays one: None."""
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
    """How many of the cases, their share, and its bounds (Clopper and Pearson); None without
    cases."""
    if not len(flags):
        return None
    count = int(flags.sum())
    ends = (
        binomtest(count, len(flags)).proportion_ci(CONFIDENCE, "exact")
        if independent
        else (None, None)
    )
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
    """Every quantity by condition, as it flew and with which ``exits``, and by case, with its unit
    in its name."""
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


def lines(found: dict) -> list[str]:
    """The result in words and units."""
    flight, many = found["flight"], found["cases"]
    text = [
        f"{found['scene']}: target {flight['range_m']:g} m along the launch axis, orbit of "
        f"{flight['period_s'] / 60.0:.4g} min",
        f"  {population.model_line(found)}",
    ]
    for item in found["conditions"]:
        text.append(
            f"  {item['condition']:10} "
            + (_one(item["flown"]) if item["flown"] else item["status"])
        )
    counts = many["counts"]
    text.append(
        f"  {counts['asked']:,} cases = {counts['ok']:,} ok + {counts['refused']:,} refused + "
        f"{counts['failed']:,} failed; "
        f"{many['settled']:,} flown"
    )
    text += [
        f"  {WORDS[name]:44} " + "  ".join(_quantile(row) for row in rows)
        for name, rows in many["quantiles"].items()
    ]
    if many["touch"]:
        text.append(
            f"  touch again                                  {many['touch']['count']:,} of "
            f"{many['touch']['of']:,}"
        )
    if doubt := doubts(found):
        text.append(f"  {doubt}")
    return [
        *text,
        f"  bounds: {many['confidence']:.0%} confidence, {many['bounds']}",
        f"  store {many['store']}, data {found['data']}",
    ]


def doubts(found: dict) -> str:
    """What is to be known of the result beside its numbers, or nothing."""
    flight, left = found["flight"], found["cases"]["limit_open"]
    text = [f"no clearance is computed: {flight['no_clearance']}"] if flight["no_clearance"] else []
    if flight["rails_listed"]:
        text.append(
            "the rails are given by a file: the clearance counts them only as far as "
            "flight.envelope lists them"
        )
    if left:
        text.append(
            f"whether {left:,} cases reach the pointing limit stayed open, and they are not counted"
        )
    return "; ".join(text)


def _one(row: dict) -> str:
    target = "never passes the target"
    if row["miss_m"] is not None:
        target = (
            f"misses by {row['miss_m']:.4g} m, {row['tip_off_miss_m']:.3g} m of it by errors, "
            f"pointing {row['pointing_deg']:.3g} deg off"
        )
    return target + (
        "" if row["clearance_mm"] is None else f"; clearance {row['clearance_mm']:.3g} mm"
    )


def _quantile(row: dict) -> str:
    value, low, high = (
        None if row[name] is None else f"{row[name]:.4g}" for name in ("value", "low", "high")
    )
    bounds = "" if low is None and high is None else f" [{low or 'none'}, {high or 'none'}]"
    return f"{row['share']:.4g}: {value or 'never'}{bounds}"
