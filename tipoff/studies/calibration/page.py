"""A calibration on the page."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tipoff.studies.calibration.compliance import Compliance
from tipoff.studies.calibration.stage import STAGE, Fit
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Column, Table, span
from tipoff.studies.render.uncertain import LEAST, Measured, rounded

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_INTERVALS = (
    "The intervals are linear and treat the residuals as scatter about a correct model. They do not "
    "include the model error, which can shift the constants by more. Not determined: the curves do "
    "not determine the constant, so it has no interval."
)


def draw(page: "Page") -> list[Part]:
    """The calibration, or the command that makes it."""
    return page.shown(STAGE, calibration, "calibrate")


def of_models(found: dict, folder: Path) -> list[Part]:
    """The results of both models, or of one, for the terminal, with the files in ``folder``."""
    parts: list[Part] = []
    if "compliance" in found:
        parts += _compliance(found["compliance"], folder)
    if "springs" in found:
        parts += terminal(found["springs"], folder)
    return parts


def terminal(found: Fit, folder: Path) -> list[Part]:
    """A fit for the terminal: the constants with intervals, weak directions, its file in
    ``folder``."""
    # a kept value is not the fitted one, and the interval belongs to the fitted one
    kept = found.values != found.fitted
    columns: list[tuple[Column | str, Sequence[Any]]] = [
        ("constant", found.parameters),
        (
            Column("fitted" if kept else "value", form=".5g"),
            list(map(constant, found.fitted, found.intervals)),
        ),
        ("unit", found.units),
        ("95 % interval", list(map(interval, found.intervals))),
    ]
    if found.with_model_error:
        columns.append(("with model error", list(map(interval, found.with_model_error))))
    if kept:
        columns.append((Column("kept, the scene's", form=".5g"), found.values))
    title = f"Fitted to {', '.join(found.conditions)}: objective {found.objective:.4g}."
    notes = [f"Weak: {words}" for words in found.weak_directions]
    notes += [f"Verdict: {found.verdict}"] if found.verdict else []
    heads, cells = zip(*columns)
    return [
        Table(heads, list(zip(*cells)), notes=tuple(notes), title=title),
        _residuals(found),
        f"  {folder / found.calibration}",
    ]


def _compliance(found: Compliance, folder: Path) -> list[Part]:
    if found.file is None or found.under_a_pad is None:
        return ["no contact: no compliance"]
    largest = max(max(values) for values in found.under_a_pad.direct_m_per_n.values())
    columns = (
        "stations",
        Column("elements", "mm", "g", 1e3),
        Column("compliance under a pad, largest", "nm/N", ".3g", 1e9),
    )
    row = (found.stations, found.element_size_m, largest)
    return [Table(columns, [row], title="Rail compliance."), f"  {folder / found.file}"]


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


def calibration(found: Fit) -> list[Part]:
    """Fitted constants with bounds and reasons, weak directions, residuals."""
    # fits of springs only: their values are never replaced by the scene's
    columns: dict[Column | str, Sequence[Any]] = {
        "constant": found.parameters,
        Column("value", form=".3g"): list(map(constant, found.fitted, found.intervals)),
        "95 % interval": list(map(interval, found.intervals)),
        "unit": found.units,
        Column("lower bound", form=".4g"): found.lower,
        Column("upper bound", form=".4g"): found.upper,
        "reasons for fit and bounds": found.justification,
    }
    weak = [(line,) for line in found.weak_directions or ["none"]]
    constants = [(f"`{key}`", value) for key, value in found.constants.items()]
    matrix = [(name, *row) for name, row in zip(found.parameters, found.information)]
    return [
        f"Fitted to {', '.join(found.conditions)} together; objective {found.objective:.4g}.",
        Table(list(columns), list(zip(*columns.values())), notes=(_INTERVALS,)),
        Table(("weak directions, and constants that the curves do not determine",), weak),
        Fold(
            "Constants of the surrogate (SI)",
            [Table(("key", Column("value", form=".6g")), constants)],
        ),
        Fold("Provenance", [Table(("", ""), list(found.provenance.items()))]),
        Fold("Residuals of each condition", [_residuals(found)]),
        Fold(
            "Information matrix of the scaled constants",
            [Table(("", *found.parameters), matrix)],
        ),
    ]
