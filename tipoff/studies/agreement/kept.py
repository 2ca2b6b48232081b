"""Error of a model from the stored agreement table for this scene and code."""

from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes.scene import NOMINAL
from tipoff.studies.core.study import Study


def rows(study: Study, model: str, calibrated: bool = False, modes: int | str = AUTO) -> list[dict]:
    """Rows of ``model`` with its options in the agreement table; none without a current table."""
    from tipoff.studies.agreement import stage as compare

    found = compare.stored(study.unrestricted())
    if found is None or model == FINITE_ELEMENTS or (calibrated and model == COMPLIANT):
        return []
    if model == COMPLIANT:
        return (
            found["compliant"]
            if modes == AUTO
            else found["modal"]
            if modes == found["rail_modes"]
            else []
        )
    return found["fitted"] + found["held_out"] if calibrated else found["uncalibrated"]


def missed(study: Study, model: str, condition: str | None = None) -> list[dict]:
    """Rows (of ``condition``, if given) with a converged reference in which ``model`` misses a
    gate."""
    return [
        row
        for row in rows(study, model)
        if row["reference_converged"]
        and not row["passes"]
        and condition in (None, row["condition"])
    ]


def words(
    study: Study,
    model: str,
    condition: str | None = None,
    calibrated: bool = False,
    modes: int | str = AUTO,
) -> str:
    """The error of ``model`` on ``condition``, or its largest over all conditions with contact and a
    converged reference, as text."""
    if model == FINITE_ELEMENTS:
        return "the reference itself"
    if calibrated and model == COMPLIANT:
        return "not measured: the agreement table has compliant contact with the scene's constants"
    found = rows(study, model, calibrated, modes)
    own = [row for row in found if row["condition"] == condition]
    if own:
        return _one(own[0])
    judged = [row for row in found if row["reference_converged"] and row["touches"]]
    if not judged:
        return "not measured for this scene with this code (tipoff compare measures it)"
    where = "" if condition in (None, NOMINAL) else f"; {condition} is not one of them"
    return (
        f"at most {max(row['settled_rate_error_deg_s'] for row in judged):.2g} deg/s from the "
        f"reference on the "
        f"{len(judged)} conditions where that is converged and pads touch{where}"
    )


def _one(row: dict) -> str:
    if row["settled_rate_error_deg_s"] is None:
        return "unknown: the reference or this model did not settle"
    off = (
        f"settled rates within {row['settled_rate_error_deg_s']:.2g} deg/s of the reference, "
        f"curves within "
        f"{100.0 * row['rate_relative_l2']:.2g} %"
    )
    return off if row["reference_converged"] else f"{off}, but the reference is not converged there"
