"""Results of drop tests as plain values (deg/s), as result files hold them."""

import numpy as np

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.droptest import judgement, power
from tipoff.studies.droptest.analysis import Drop
from tipoff.studies.droptest.events import WINDOWS
from tipoff.studies.droptest.reduction import COVERAGE
from tipoff.studies.populations import answers, spread

MAGNITUDES = ("roll", "transverse", "total")
PAIRS = ((0, 1), (0, 2), (1, 2))
_EVERY = 4  # curves of a result file hold every fourth sample
_AROUND = 0.12  # s before and after ignition, where they hold all samples


def row_of(number: int, drop: Drop, simulated: np.ndarray) -> dict:
    """One test among simulated rates (n,3) deg/s."""
    found, events, sheet = drop.reduced, drop.events, drop.sheet
    change, uncertainty = np.degrees(found.change), np.degrees(found.combined)
    place = judgement.standing(simulated, change, uncertainty, number)
    return {
        "test": drop.name,
        "simulated": sheet.simulated,
        "description": sheet.description,
        "notes": list(drop.notes),
        "channel_class": sheet.channel_class,
        "interval_s": float(drop.samples.time[1] - drop.samples.time[0]),
        "release_s": events.release,
        "ignition_s": events.ignition,
        "events_given": events.given,
        "windows_s": {name: list(getattr(drop.spans, name)) for name in WINDOWS},
        "instant_s": drop.spans.instant,
        "rest_deg_s": float(np.degrees(drop.unrest)),
        "rest_limit_deg_s": float(np.degrees(sheet.windows.rest_rate)),
        "rest_kept": bool(drop.unrest <= sheet.windows.rest_rate),
        "before_deg_s": np.degrees(found.before).tolist(),
        "after_deg_s": np.degrees(found.after).tolist(),
        "change_deg_s": change.tolist(),
        "standard_uncertainty_deg_s": uncertainty.tolist(),
        "coverage_factor": found.factor.tolist(),
        "expanded_uncertainty_deg_s": (found.factor * uncertainty).tolist(),
        "coverage": COVERAGE,
        "budget_deg_s": {name: np.degrees(part).tolist() for name, part in found.parts.items()},
        "noise_deg_s": np.degrees(found.noise).tolist(),
        "correlation_samples": found.correlation,
        "inside_range": (
            (simulated.min(axis=0) <= change) & (change <= simulated.max(axis=0))
        ).tolist(),
        "percentile": place.percentile.tolist(),
        "p": place.p.tolist(),
        "p_distance": place.p_distance,
        "magnitudes": {
            name: {"value_deg_s": float(value), "percentile": float(share), "p": float(p)}
            for name, value, share, p in zip(
                MAGNITUDES,
                judgement.magnitudes(change),
                place.magnitude_percentile,
                place.magnitude_p,
            )
        },
        "curve": _curve(drop),
    }


def _curve(drop: Drop) -> dict:
    """Filtered rates over the time after ignition, all samples near it and every fourth
    elsewhere."""
    time = drop.samples.time - drop.events.ignition
    keep = (np.abs(time) < _AROUND) | (np.arange(time.size) % _EVERY == 0)
    return {
        "time_s": np.round(time[keep], 6).tolist(),
        "rate_deg_s": np.round(np.degrees(drop.filtered[keep]), 4).tolist(),
    }


def joint(tests: list[dict], simulated: np.ndarray) -> dict:
    """``together``: p of all tests by distance and by spread, and the smaller after Bonferroni;
    ``regions`` of prediction for each pair of components; ``power`` of both tests."""
    changes = np.array([row["change_deg_s"] for row in tests])
    uncertainty = np.array([row["standard_uncertainty_deg_s"] for row in tests])
    regions = []
    for pair in PAIRS:
        centre, covariance, radius = judgement.region(simulated[:, pair])
        regions.append(
            {
                "components": ["xyz"[place] for place in pair],
                "share": judgement.SHARE,
                "centre_deg_s": centre.tolist(),
                "covariance": covariance.tolist(),
                "squared_radius": radius if np.isfinite(radius) else None,
            }
        )
    out, spread = (
        judgement.combined([row["p_distance"] for row in tests]),
        judgement.p_spread(simulated, changes, uncertainty),
    )
    return {
        "together": {
            "p_distance": out,
            "p_spread": spread,
            "p": min(1.0, 2.0 * min(out, spread)),
            "smallest_p": 1.0 / (len(simulated) + 1),
            "inside_range": all(all(row["inside_range"]) for row in tests),
        },
        "regions": regions,
        "power": power.table(simulated, len(tests)),
    }


def quantiles(results: Columns, settled: np.ndarray, independent: bool) -> dict[str, list[dict]]:
    """Quantiles of the exit state of the ``settled`` (n,) cases by name, in the units of the name;
    with bounds where draws are ``independent``."""
    found = {item.name: spread.quantiles(item.of(results)[settled]) for item in answers.ALL}
    nothing = {} if independent else {"low": None, "high": None}
    return {name: [vars(row) | nothing for row in rows] for name, rows in found.items()}
