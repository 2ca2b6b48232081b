"""Error of a model from the stored agreement table for this scene and code."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.names import NOMINAL
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.workspace.errors import StudyError
from tipoff.workspace.study import Study
from tipoff.workspace.words import counted

if TYPE_CHECKING:
    from tipoff.studies.agreement.stage import Agreement


def _stored(study: Study) -> "Agreement | None":
    from tipoff.studies.agreement import stage  # slow to load

    return stage.stored(study.unrestricted())


def _rows(
    found: "Agreement | None", model: str, calibrated: bool = False, modes: int | str = AUTO
) -> Sequence[JudgedCondition]:
    """Rows of ``model`` with its options in the agreement table; none without one."""
    if found is None or model == FINITE_ELEMENTS or (calibrated and model == COMPLIANT):
        return ()
    if model != COMPLIANT:
        return found.calibrated if calibrated else found.uncalibrated
    if modes == AUTO:
        return found.compliant
    return found.modal if modes == found.rail_modes else ()


def require_accepted(study: Study, name: str | None, condition: str | None = None) -> None:
    """Raises StudyError if ``name`` is None and the stored agreement table rejects the default
    model on ``condition`` or, without one, on any condition of the scene. A miss of a distribution
    counts for its own condition only: the error is above a share of the effect of 1 um, and other
    cases differ by much more than 1 um."""
    if name is not None:
        return
    missed = [
        row
        for row in _rows(_stored(study), COMPLIANT)
        if row.judgement == verdicts.MISSES
        and (row.judged_as == verdicts.CURVE if condition is None else row.condition == condition)
    ]
    if missed:
        listed = "\n  ".join(f"{row.condition}: {row.verdict}" for row in missed)
        raise StudyError(
            f"compliant contact does not agree with the converged reference:\n  {listed}\n"
            f"name a model: --model {FINITE_ELEMENTS} for the reference, or --model {COMPLIANT} "
            "to use compliant contact anyway"
        )


def words(
    study: Study,
    model: str,
    condition: str | None = None,
    calibration: Calibration | None = None,
    modes: int | str = AUTO,
    numerics: str = "",
) -> str:
    """The error of ``model`` on ``condition`` as text, or the largest error over all conditions
    with contact and a converged reference. ``numerics``: as text, those that are not the default."""
    if model == FINITE_ELEMENTS:
        return "the reference itself"
    calibrated = calibration is not None
    if calibrated and model == COMPLIANT:
        return "not measured: the agreement table has compliant contact with the scene's constants"
    if numerics:
        return f"not measured with {numerics}: tipoff compare has the default"
    if calibration is not None and calibration.constants != _own_constants(study):
        return "not measured with these constants: tipoff compare has those of tipoff calibrate"
    table = _stored(study)
    found = _rows(table, model, calibrated, modes)
    own = [row for row in found if row.condition == condition]
    if own:
        return _one(own[0])
    if not found:
        if table is None or model != COMPLIANT or modes == AUTO:
            return "not measured for this scene with this code (tipoff compare measures it)"
        return f"not measured with {modes} modes: tipoff compare has {AUTO} and {table.rail_modes}"
    touched = [row for row in found if row.touches]
    judged = [row for row in touched if row.is_judged_as_curve]
    if not touched:
        return f"not known: no pad touches on any of {counted(len(found), 'compared condition')}"
    if not judged:
        lost = [row.condition for row in touched if row.judgement == verdicts.CANNOT]
        why = f"; {', '.join(lost)} cannot be judged" if lost else ""
        return (
            f"not known: tipoff compare could judge none of {counted(len(touched), 'condition')} "
            f"with contact by single runs{why}{_others(touched)}"
        )
    where = "" if condition in (None, NOMINAL) else f"; {condition} is not one of them"
    errors = [row.settled_rate_error_deg_s for row in judged]
    known = [error for error in errors if error is not None]
    parts = []
    if known:
        parts.append(
            f"at most {max(known):.2g} deg/s from the reference on {counted(len(known), 'condition')} where "
            "that is converged and pads touch"
        )
    if lost_count := len(errors) - len(known):
        parts.append(f"it does not settle on {lost_count} where the reference does")
    return f"{'; '.join(parts)}{_others(touched)}{where}"


def _own_constants(study: Study) -> dict | None:
    """The calibrated constants of springs in the agreement table; None without."""
    from tipoff.studies.calibration import stage  # slow to load

    try:
        return stage.constants(study)
    except KeyError:
        return None


def _others(rows: Sequence[JudgedCondition]) -> str:
    """How many conditions agree as distributions, and which miss; empty without distributions."""
    alike = [row for row in rows if row.judged_as == verdicts.DISTRIBUTION]
    agree = sum(row.judgement == verdicts.AS_DISTRIBUTION for row in alike)
    lost = [row.condition for row in alike if row.judgement == verdicts.MISSES]
    return (f"; {agree} more agree as distributions" if agree else "") + (
        f"; as distributions it misses {', '.join(lost)}" if lost else ""
    )


def _one(row: JudgedCondition) -> str:
    if row.settled_rate_error_deg_s is None or row.rate_relative_l2 is None:
        return "unknown: the reference or this model did not settle"
    off = (
        f"settled rates within {row.settled_rate_error_deg_s:.2g} deg/s of the reference, "
        f"curves within "
        f"{100.0 * row.rate_relative_l2:.2g} %"
    )
    if row.is_judged_as_curve:
        return off
    if row.judged_as == verdicts.DISTRIBUTION:
        return f"{off}, but 1 µm or the mesh changes the reference as much; it {row.verdict}"
    return f"{off}, but the reference is not converged there"
