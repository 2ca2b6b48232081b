"""Results of drop tests as plain values (deg/s), as result files hold them, and in words."""

import numpy as np

from tipoff.lowfi.ensemble.columns import Columns
from tipoff.studies.droptest import judgement, power
from tipoff.studies.droptest.analysis import Drop
from tipoff.studies.droptest.events import WINDOWS
from tipoff.studies.droptest.reduction import COVERAGE
from tipoff.studies.populations import answers, population, spread

MAGNITUDES = ("roll", "transverse", "total")
PAIRS = ((0, 1), (0, 2), (1, 2))
_EVERY = 4  # samples: the curves of a result file are thinned where nothing happens
_AROUND = 0.12  # s around ignition where they are not


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
    """``together``: p of all tests, and of the two ways to ask for it after Bonferroni; ``regions``
    of prediction for each pair of components; ``power`` of what is asked of them."""
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
    """Of what the ``settled`` (n,) cases leave their rail with, by name, in the units of the name;
    bounded where draws are ``independent``."""
    found = {item.name: spread.quantiles(item.of(results)[settled]) for item in answers.ALL}
    nothing = {} if independent else {"low": None, "high": None}
    return {name: [row | nothing for row in rows] for name, rows in found.items()}


def summary(scene: str, found: dict) -> list[str]:
    """The whole result in words, one line each."""
    cases, tests = found["cases"], found["tests"]
    text = [
        f"{scene}: {len(tests)} drop tests against {cases['settled']:,} settled of "
        f"{cases['asked']:,} cases of the surrogate, "
        f"{_drawn(found)}",
        f"  {population.model_line(found)}",
    ]
    if any(row["simulated"] for row in tests):
        text.append(
            "  SIMULATED     logs marked so come from a sensor model: they show that the reduction "
            "works and say "
            "nothing of a launcher"
        )
    for row in tests:
        text += _test_lines(row)
    return [*text, *_cases(found["cases"]), *_verdict(found)]


def _cases(cases: dict) -> list[str]:
    """Medians and 95 % quantiles of the simulated cases beside their rates, which logs do not
    tell."""
    at = {
        name: {row["share"]: row["value"] for row in rows}
        for name, rows in cases["quantiles"].items()
    }
    return [
        "  cases         "
        + ", ".join(
            f"{item.label} {at[item.name][0.5]:.3g} ({at[item.name][0.95]:.3g}) {item.unit}"
            for item in (*answers.VELOCITY, *answers.ATTITUDE)
        )
        + ": median (95 %)"
    ]


def _drawn(found: dict) -> str:
    """What the cases are of, in words."""
    request = found["request"]
    condition = f"condition {request['condition']}, " if request["condition"] else ""
    return f"{condition}errors of {request['vary']}, seed {found['varied']['seed']}"


def _test_lines(row: dict) -> list[str]:
    largest = sorted(row["budget_deg_s"], key=lambda name: -max(row["budget_deg_s"][name]))[:3]
    parts = ", ".join(f"{name} {max(row['budget_deg_s'][name]):.2g}" for name in largest)
    values = ", ".join(
        f"{axis} {value:+.3f} ± {uncertainty:.3f}"
        for axis, value, uncertainty in zip(
            "xyz", row["change_deg_s"], row["expanded_uncertainty_deg_s"]
        )
    )
    places = ", ".join(
        f"{axis} {100.0 * share:.1f} % (p {p:.3f})"
        for axis, share, p in zip("xyz", row["percentile"], row["p"])
    )
    sizes = ", ".join(
        f"{name} {100.0 * item['percentile']:.1f} %" for name, item in row["magnitudes"].items()
    )
    rest = "kept" if row["rest_kept"] else "BROKEN"
    return [
        f"  {row['test']}{' (SIMULATED log)' if row['simulated'] else ''}, CFC "
        f"{row['channel_class']}",
        f"    events        release {row['release_s']:.4f} s, ignition {row['ignition_s']:.4f} s; "
        f"settling rule {rest}: "
        f"{row['rest_deg_s']:.2g} of {row['rest_limit_deg_s']:g} deg/s",
        f"    change        {values} deg/s ({100.0 * row['coverage']:g} %)",
        f"    uncertainty   largest standard parts, deg/s: {parts}",
        f"    percentiles   {places}; all three by distance p {row['p_distance']:.3f}",
        f"    any angle     {sizes} of the magnitudes",
        *(f"    note          {words}" for words in row["notes"]),
    ]


def _verdict(found: dict) -> list[str]:
    together, tests = found["together"], len(found["tests"])
    verdict = "do not contradict" if together["p"] > power.LEVEL else "contradict"
    inside = "all tests lie inside" if together["inside_range"] else "not all tests lie inside"
    rows = {row["factor"]: row for row in found["power"]}
    passing, flagged, seen = (
        [f"{100.0 * rows[factor][name]:.1f} %" for factor in (1.0, 3.0, 0.5)]
        for name in ("passes_one_axis", "flagged_by_spread", "flagged_in_cloud")
    )
    return [
        f"  together      the tests {verdict} the simulated distribution: p {together['p']:.3f}, "
        f"twice the smaller of "
        f"{together['p_distance']:.3f} (so far out) and {together['p_spread']:.3f} (such a spread, "
        f"two-sided)",
        f"  range         {inside} the range of the cases. {tests} tests pass that {passing[0]} of "
        f"the time with a right "
        f"model, {passing[1]} with one three times too wide, {passing[2]} with one half as wide as "
        f"the truth (one axis, normal "
        "distribution): it is no validation",
        f"  power         the spread of all components flags a model three times too wide "
        f"{flagged[1]} of the time, one half "
        f"as wide as the truth {flagged[2]}, a right one {flagged[0]} (normal distribution; in "
        f"this cloud {seen[1]}, "
        f"{seen[2]} and {seen[0]})",
    ]
