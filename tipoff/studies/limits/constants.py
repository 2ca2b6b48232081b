"""What is not certain about the calibrated constants and about the model they are constants of."""

from typing import NamedTuple

from tipoff.lowfi.ensemble.sampling import Points
from tipoff.mechanics.models import COMPLIANT
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.agreement import stage as compare
from tipoff.studies.core.study import Study, read
from tipoff.studies.populations.derived import law

_TWO_SIDED_95 = 1.959963984540054  # standard deviations


def draws(
    scene: Scene, fitted: Calibration, count: int, seed: int
) -> tuple[list[dict[str, float]], list[str]]:
    """``count`` sets of overrides of ``scene``, and the names of the constants that differ in them.

    Each is drawn by itself from the normal distribution of its 95 % interval, and inside it (a
    Latin hypercube). A constant without an interval keeps its value.
    """
    from tipoff.calibration import parameters

    laws = {}
    for name, value, (low, high), least, most in zip(
        fitted.parameters, fitted.values, fitted.intervals, fitted.lower, fitted.upper
    ):
        low, high, sd = max(low, least), min(high, most), 0.5 * (high - low) / _TWO_SIDED_95
        if 0.0 < sd < float("inf"):
            laws[name] = law(
                "truncated-normal", mean=value, sd=sd, low=low, high=high, rule="redraw"
            )
    if not laws or count == 0:
        return [], []
    points = Points(Uncertainty(count, seed, "latin-hypercube", laws)).draw(0, count)
    known = dict(zip(fitted.parameters, fitted.values))
    drawn = zip(*(item.ppf(column).tolist() for item, column in zip(laws.values(), points.T)))
    return [parameters.overrides(scene, known | dict(zip(laws, values))) for values in drawn], list(
        laws
    )


class Margin(NamedTuple):
    """What the surrogate's settled rates were off by at most, deg/s: about each axis and in
    magnitude; None where nothing was measured. ``said`` is where that is from."""

    deg_s: dict[str, float] | None
    said: str


def margin(study: Study, model: str) -> Margin:
    """The largest errors on the conditions of ``make compare`` that nothing was fitted to and whose
    reference is converged: elsewhere nobody knows whose error it is. Without any, those the fit
    itself leaves."""
    if study.scene.contact is None:
        return Margin(
            dict.fromkeys(("x", "y", "z", "total"), 0.0), "no contact, no error of a contact law"
        )
    table = (compare.stored(study) or {}).get("compliant" if model == COMPLIANT else "held_out", [])
    rows = [row for row in table if row["role"] == "held_out"]
    errors = [
        row["settled_rate_error_xyz_deg_s"]
        for row in rows
        if row["reference_converged"] and row["settled_rate_error_xyz_deg_s"] is not None
    ]
    if errors:
        found = {
            axis: max(abs(error[place]) for error in errors) for place, axis in enumerate("xyz")
        }
        found["total"] = max(sum(part**2 for part in error) ** 0.5 for error in errors)
        return Margin(
            found,
            f"largest of {len(errors)} held-out conditions; {len(rows) - len(errors)} more have no "
            f"converged "
            "reference, and errors there are not known",
        )
    left = [
        row["settled_rate_error_deg_s"]
        for row in (read(study.path("calibration.json")) or {}).get("residuals", {}).values()
    ]
    if model == COMPLIANT or not left or None in left:
        return Margin(None, "not measured: make compare measures it")
    worst = max(left)
    return Margin(
        {"x": worst, "y": worst, "z": worst, "total": 3**0.5 * worst},
        f"largest of the {len(left)} fitted conditions, for no held-out one was measured (make "
        f"compare)",
    )
