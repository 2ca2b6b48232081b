"""The uncertainty of the calibrated constants, and the error of the surrogate."""

from dataclasses import dataclass

from tipoff.lowfi.ensemble.derived import law
from tipoff.lowfi.ensemble.sampling import Points
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.agreement import stage as compare
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.calibration.stage import Fit
from tipoff.workspace.study import Study
from tipoff.workspace.words import counted

_TWO_SIDED_95 = 1.959963984540054  # standard deviations


def draws(
    scene: Scene, fitted: Calibration, count: int, seed: int
) -> tuple[list[dict[str, float]], list[str]]:
    """``count`` sets of overrides of ``scene``, and the names of the drawn constants.

    Each constant is drawn independently from the normal distribution of its 95 % interval,
    truncated to the interval (Latin hypercube). A constant without an interval keeps its value.
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
    nominal = dict(zip(fitted.parameters, fitted.values))
    drawn = zip(*(item.ppf(column).tolist() for item, column in zip(laws.values(), points.T)))
    return [
        parameters.overrides(scene, nominal | dict(zip(laws, values))) for values in drawn
    ], list(laws)


@dataclass(frozen=True)
class Margin:
    """The largest error of the surrogate's settled rates, deg/s, by axis x, y, z and in ``total``;
    None if not measured. ``said`` names the measured conditions."""

    deg_s: dict[str, float] | None
    said: str


def _residuals(found: Fit | None) -> list[float]:
    """Errors (deg/s) of the fitted conditions of a calibration; none where one of them did not settle."""
    errors = [own["settled_rate_error_deg_s"] for own in found.residuals.values()] if found else []
    known = [error for error in errors if error is not None]
    return known if len(known) == len(errors) else []


def margin(study: Study, model: str) -> Margin:
    """The largest errors on the held-out conditions of ``make compare`` that single runs judge. On
    other conditions the reference itself is too uncertain. Without such a condition: the largest
    residuals of the calibration of the present scene and code. Runs of compliant contact have the
    modes that each condition chose."""
    if study.scene.contact is None:
        return Margin(
            dict.fromkeys(("x", "y", "z", "total"), 0.0), "zero, because the scene has no contact"
        )
    table = compare.stored(study)
    every = () if table is None else table.compliant if model == COMPLIANT else table.held_out
    rows = [row for row in every if row.role == "held_out"]
    judged = [row for row in rows if row.is_judged_as_curve]
    found = [row.settled_rate_error_xyz_deg_s for row in judged]
    errors = [error for error in found if error is not None]
    if errors:
        largest = {
            axis: max(abs(error[place]) for error in errors) for place, axis in enumerate("xyz")
        }
        largest["total"] = max(sum(part**2 for part in error) ** 0.5 for error in errors)
        return Margin(
            largest,
            f"largest of {counted(len(errors), 'held-out condition')}; not judged as curves: "
            f"{len(rows) - len(judged)}; not settled: {len(judged) - len(errors)}",
        )
    stored = calibrate.stored(study)
    left = _residuals(stored.result if stored else None)
    if model == COMPLIANT or not left:
        if not rows:
            return Margin(None, "not measured (tipoff compare measures it)")
        return Margin(
            None,
            f"not known: tipoff compare could judge none of {counted(len(rows), 'held-out condition')} by "
            "single runs that settle",
        )
    worst = max(left)
    return Margin(
        {"x": worst, "y": worst, "z": worst, "total": 3**0.5 * worst},
        f"largest of {counted(len(left), 'fitted condition')}; no held-out condition is measured (make "
        "compare)",
    )
