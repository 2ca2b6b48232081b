"""A calibration."""

from collections.abc import Sequence
from typing import Any

from tipoff.studies.calibration.stage import Fit
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Column, Table, span
from tipoff.uncertain import LEAST, Measured, rounded

_INTERVALS = (
    "The intervals are linear and treat the residuals as scatter about a correct model. They do not "
    "include the model error, which can shift the constants by more. Not determined: the curves do "
    "not determine the constant, so it has no interval."
)


def draw(found: Fit) -> list[Part]:
    """Fitted constants with intervals, bounds and reasons, weak directions, residuals."""
    # a kept value is not the fitted one, and the interval belongs to the fitted one
    kept = found.values != found.fitted
    fitted = Column("fitted" if kept else "value", form=".5g")
    columns: dict[Column | str, Sequence[Any]] = {
        "constant": found.parameters,
        fitted: list(map(constant, found.fitted, found.intervals)),
        "unit": found.units,
        "95 % interval": list(map(interval, found.intervals)),
    }
    if found.with_model_error:
        columns["with model error"] = list(map(interval, found.with_model_error))
    if kept:
        columns[Column("kept, the scene's", form=".5g")] = found.values
    columns |= {
        Column("lower bound", form=".4g", detail=True): found.lower,
        Column("upper bound", form=".4g", detail=True): found.upper,
        Column("reasons for fit and bounds", detail=True): found.justification,
    }
    notes = [_INTERVALS, *(f"Weak: {words}" for words in found.weak_directions)]
    notes += [f"Verdict: {found.verdict}"] if found.verdict else []
    constants = [(f"`{key}`", value) for key, value in found.constants.items()]
    matrix = [(name, *row) for name, row in zip(found.parameters, found.information)]
    return [
        f"Fitted to {', '.join(found.conditions)} together; objective {found.objective:.4g}.",
        Table(list(columns), list(zip(*columns.values())), notes=tuple(notes)),
        _residuals(found),
        Fold(
            "Constants of the surrogate (SI)",
            [Table(("key", Column("value", form=".6g")), constants)],
        ),
        Fold("Provenance", [Table(("", ""), list(found.provenance.items()))]),
        Fold(
            "Information matrix of the scaled constants",
            [Table(("", *found.parameters), matrix)],
        ),
    ]


def _residuals(found: Fit) -> Table:
    names = list(dict.fromkeys(name for own in found.residuals.values() for name in own))
    return Table(
        ("condition", *(name.replace("_", " ") for name in names)),
        [(name, *map(own.get, names)) for name, own in found.residuals.items()],
    )


def constant(value: float, ends: Sequence[float | None]) -> Any:
    """A fitted constant, rounded to half its interval; with all digits if it has no interval."""
    low, high = ends
    if low is None or high is None or high <= low:
        return value
    return Measured(value, 0.5 * (high - low), apart=True)


def interval(ends: Sequence[float | None]) -> str:
    """The 95 % interval of a constant, rounded to half its width."""
    low, high = ends
    if low is None or high is None:
        return "not determined by the curves"
    half = 0.5 * (high - low)
    if not half > 0.0:
        return span(low, high)
    return " to ".join(rounded(end, half, LEAST * half) for end in (low, high))
