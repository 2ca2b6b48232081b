"""Calibrated springs on the page."""

from html import escape
from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, caption, code, fold, joined, number, paragraph, table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_INTERVALS = (
    "Intervals are linear and take what the fit leaves for scatter about a model that is right. "
    "Model error is not in "
    "them: what the surrogate lacks may move its constants by more than they say. "
    "Not told: the curves do not fix the constant, and no interval is made up."
)


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    return page.section("calibration", "calibration", "Calibration", calibration, "calibrate")


def calibration(document: dict) -> Html:
    """Fitted constants with bounds and reasons, what the curves cannot tell, residuals."""
    rows = [
        (name, number(value, 5), _interval(ends), unit, number(low, 4), number(high, 4), why)
        for name, value, ends, unit, low, high, why in zip(
            *(
                document[key]
                for key in (
                    "parameters",
                    "values",
                    "intervals",
                    "units",
                    "lower",
                    "upper",
                    "justification",
                )
            )
        )
    ]
    weak = (
        "".join(f"<li>{escape(line)}</li>" for line in document["weak_directions"])
        or "<li>none</li>"
    )
    names = list(dict.fromkeys(key for found in document["residuals"].values() for key in found))
    residuals = [
        (condition, *(found.get(name) for name in names))
        for condition, found in document["residuals"].items()
    ]
    information = [
        (name, *line) for name, line in zip(document["parameters"], document["information"])
    ]
    applied = [(code(key), number(value, 6)) for key, value in document["constants"].items()]
    return joined(
        paragraph(
            f"Fitted to {', '.join(document['conditions'])} at once; objective "
            f"{document['objective']:.4g}."
        ),
        table(
            (
                "constant",
                "value",
                "95 % interval",
                "unit",
                "lower bound",
                "upper bound",
                "why free, why these bounds",
            ),
            rows,
        ),
        caption(_INTERVALS),
        Html(f"<h3>What the curves cannot tell</h3><ul>{weak}</ul>"),
        fold("constants the surrogate then uses (SI)", table(("key", "value"), applied)),
        fold("how they were found", table(("", ""), document["provenance"].items())),
        fold(
            "residuals per condition",
            table(("condition", *(name.replace("_", " ") for name in names)), residuals),
        ),
        fold(
            "information matrix of the scaled constants",
            table(("", *document["parameters"]), information),
        ),
    )


def _interval(ends: list[float | None]) -> Html | str:
    return "not told" if None in ends else Html(f"{number(ends[0], 4)} to {number(ends[1], 4)}")
