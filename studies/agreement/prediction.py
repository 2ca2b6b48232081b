"""Settled rates as the calibrated surrogate predicts them, with what is not known of its constants and of itself, and how many of
the reference's lie inside.

    w = w_f(theta_k) + |w_f(theta_k)| s_k t        k over draws of the posterior, t a Student t, s_k the discrepancy at theta_k

The first term alone scatters by the constants; with the second it says where the reference should be. If 95 % of n intervals are
to hold their value, the number that do scatters binomially, provided the n are independent of each other. The three axes of a
condition are not, nor conditions a few degrees apart, so the band is the narrowest there could be. A condition in which no pad
touches tests none of this and is left out, and so is one whose reference is not converged (``studies.agreement.verdicts``): it is
not known what should lie inside.
"""

from typing import Callable, Mapping

import numpy as np
from scipy.stats import binom

import calibrate
import lowfi
from scenes.scene import Scene
from scenes.walls import Walls
from studies.agreement.metrics import AXES

LEVEL = 0.95
TOLERANCE = 1e-4


def rates(posterior: calibrate.Posterior, scenes: Mapping[str, Scene], workers: int | None = None,
          progress: Callable[[float], None] = lambda fraction: None, walls: Walls | None = None) -> dict[str, np.ndarray]:
    """Settled rates (k,3) rad/s of each scene under every draw, NaN where it did not settle; rigid ``walls`` where rails are
    warm."""
    rows, found, numerics = calibrate.draws(posterior), {}, lowfi.Numerics(relative_tolerance=TOLERANCE)
    for name, scene in scenes.items():
        # Springs stand on rails that do not bend, whatever else the scene asks of them.
        many = lowfi.run_many(scene.replace({"flexibility": None}), rows, workers=workers, numerics=numerics, walls=walls)
        found[name] = many.rate.values
        progress(len(found) / len(scenes))
    return found


def row(condition: str, role: str, posterior: calibrate.Posterior, drawn: np.ndarray, reference: list[float] | None,
        touches: bool = True, converged: bool = True, seed: int = 0) -> dict:
    """Intervals of one condition (deg/s) by axis from settled rates (k,3) rad/s of every draw, and which hold the reference's."""
    settled = np.flatnonzero(np.isfinite(drawn).all(axis=1))
    wanted = None if reference is None else np.degrees(reference)
    found = {"condition": condition, "role": role, "touches": touches, "reference_converged": converged,
             "settled": len(settled), "draws": len(drawn),
             "reference_deg_s": None if wanted is None else wanted.tolist()}
    if not settled.size:
        return found | dict.fromkeys(("median_deg_s", "parameter_deg_s", "total_deg_s", "parameter_holds", "total_holds"))
    kept = drawn[settled]
    for name, values in (("parameter", kept), ("total", calibrate.disturbed(posterior, kept, settled, seed))):
        low, high = np.degrees(np.quantile(values, [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL], axis=0))
        found[f"{name}_deg_s"] = np.column_stack([low, high]).tolist()
        found[f"{name}_holds"] = None if wanted is None else ((low <= wanted) & (wanted <= high)).tolist()
    return found | {"median_deg_s": np.degrees(np.median(kept, axis=0)).tolist()}


def coverage(rows: list[dict]) -> dict:
    """Of all axes with a touch, a converged reference and an interval: how many intervals hold it, with and without discrepancy,
    the 95 % band, and which do not; and the conditions that were ``not_judged`` for their reference."""
    known = [item for item in rows if item["touches"] and item["total_holds"] is not None]
    judged = [item for item in known if item["reference_converged"]]
    count = 3 * len(judged)
    low, high = binom.interval(LEVEL, count, LEVEL) if count else (0, 0)
    return {"values": count, "parameter": sum(sum(item["parameter_holds"]) for item in judged),
            "total": sum(sum(item["total_holds"]) for item in judged), "band": [int(low), int(high)],
            "not_judged": [item["condition"] for item in known if not item["reference_converged"]],
            "missed": {item["condition"]: missed for item in judged if (missed := [
                axis for axis, held in zip(AXES, item["total_holds"]) if not held])}}


def covered(found: dict[str, dict]) -> str:
    """``coverage`` by role in words."""
    return "; ".join(_covered(role.replace("_", "-"), item) for role, item in found.items())


def _covered(role: str, item: dict) -> str:
    missed = ", ".join(f"{name} ({', '.join(axes)})" for name, axes in item["missed"].items())
    missed = f", not in {missed}" if missed else ""
    unjudged = f" (reference not converged, so not judged: {', '.join(item['not_judged'])})" if item["not_judged"] else ""
    if not item["values"]:
        return f"no {role} settled rate can be judged{unjudged}"
    return (f"{item['total']} of {item['values']} {role} settled rates inside their 95 % interval, {item['parameter']} inside "
            f"that of the constants alone (95 % band {item['band'][0]} to {item['band'][1]}){missed}{unjudged}")
