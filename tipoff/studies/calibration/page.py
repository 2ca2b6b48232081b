"""A calibration on the page."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
    """The calibration, or how to make it."""
    return page.shown("calibration", calibration, "calibrate")


def terminal(document: dict, folder: Path) -> list[Part]:
    """What the terminal shows: the compliance, the constants with intervals, weak directions, files in
    ``folder``."""
    if "parameters" not in document:
        both = [
            *(_compliance(document["compliance"], folder) if "compliance" in document else []),
            *(terminal(document["springs"], folder) if "springs" in document else []),
        ]
        return both
    wide = document["with_model_error"]
    heads: list[Column | str] = ["constant", Column("value", form=".5g"), "unit", "95 % interval"]
    # a value that is kept is not that of the fit, and the interval is not its own
    keys = ("parameters", "fitted", "units", "intervals")
    rows = [list(row) for row in zip(*(document[key] for key in keys))]
    kept = document["values"] != document["fitted"]
    if kept:
        heads[1] = Column("fitted", form=".5g")
    for row in rows:
        row[1], row[3] = constant(row[1], row[3]), interval(row[3])
    if wide:
        heads.append("with model error")
        rows = [[*row, interval(ends)] for row, ends in zip(rows, wide)]
    if kept:
        heads.append(Column("kept, the scene's", form=".5g"))
        rows = [[*row, value] for row, value in zip(rows, document["values"])]
    fitted = (
        f"Fitted to {', '.join(document['conditions'])}: objective {document['objective']:.4g}."
    )
    notes = [f"Weak: {words}" for words in document["weak_directions"]]
    notes += [f"Verdict: {words}" for words in [document["verdict"]] if words]
    return [
        Table(heads, rows, tuple(notes), fitted),
        _residuals(document),
        f"  {folder / document['calibration']}",
    ]


def _compliance(document: dict, folder: Path) -> list[Part]:
    if document["file"] is None:
        return ["no contact: no compliance"]
    largest = max(max(values) for values in document["under_a_pad"]["direct_m_per_n"].values())
    columns = (
        "stations",
        Column("elements", "mm", "g", 1e3),
        Column("compliance under a pad, largest", "nm/N", ".3g", 1e9),
    )
    row = (document["stations"], document["element_size_m"], largest)
    return [
        Table(columns, [row], title="Rail compliance."),
        f"  {folder / document['file']}",
    ]


def _residuals(document: dict) -> Table:
    residuals = document["residuals"]
    names = list(dict.fromkeys(name for found in residuals.values() for name in found))
    return Table(
        ("condition", *(name.replace("_", " ") for name in names)),
        [(name, *map(found.get, names)) for name, found in residuals.items()],
    )


def constant(value: float, ends: Sequence[float | None]) -> Any:
    """A fitted constant, rounded to half its interval; as it is where it has none."""
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


def calibration(document: dict) -> list[Part]:
    """Fitted constants with bounds and reasons, weak directions, residuals."""
    columns = (
        "constant",
        Column("value", form=".3g"),
        "95 % interval",
        "unit",
        Column("lower bound", form=".4g"),
        Column("upper bound", form=".4g"),
        "reasons for fit and bounds",
    )
    # of springs, whose fitted values are never replaced by the scene's
    keys = ("parameters", "fitted", "intervals", "units", "lower", "upper", "justification")
    rows = [
        (name, constant(value, ends), interval(ends), *rest)
        for name, value, ends, *rest in zip(*(document[key] for key in keys))
    ]
    return [
        f"Fitted to {', '.join(document['conditions'])} together; objective "
        f"{document['objective']:.4g}.",
        Table(columns, rows, (_INTERVALS,)),
        Table(
            ("weak directions, and constants that the curves do not determine",),
            [(line,) for line in document["weak_directions"] or ["none"]],
        ),
        Fold(
            "Constants of the surrogate (SI)",
            [
                Table(
                    ("key", Column("value", form=".6g")),
                    [(f"`{key}`", value) for key, value in document["constants"].items()],
                )
            ],
        ),
        Fold("Provenance", [Table(("", ""), list(document["provenance"].items()))]),
        Fold("Residuals of each condition", [_residuals(document)]),
        Fold(
            "Information matrix of the scaled constants",
            [
                Table(
                    ("", *document["parameters"]),
                    [
                        (name, *row)
                        for name, row in zip(document["parameters"], document["information"])
                    ],
                )
            ],
        ),
    ]
