"""Agreement on conditions drawn by a seed that nobody chose, on the page."""

import math

from tipoff.studies.agreement.page import judged, summary
from tipoff.studies.render.document import Caption, Fold, Part
from tipoff.studies.render.table import Column, Table

_WORDS = (
    "Drawn from the distributions “{vary}” with seed {seed}{origin}. Every condition has its own "
    "floor and its own reference uncertainty, by mesh, step and penalty."
)


def draw(found: dict) -> list[Part]:
    """The section."""
    options, compliant, calibrated = found["asked"], found["compliant"], found["calibrated"]
    origin = (
        ", which follows from the sources and the scene: a change of the code draws others"
        if options["seed"] is None
        else ""
    )
    return [
        "On compliant contact, nothing fitted: " + summary(compliant),
        judged(compliant, "blind-compliant"),
        Caption(_WORDS.format(vary=options["vary"], seed=found["seed"], origin=origin)),
        "Calibrated springs: " + summary(calibrated),
        judged(calibrated, "blind-calibrated"),
        Fold("What was drawn", [_drawn(found["conditions"])]),
    ]


def verdicts(found: dict) -> list[Part]:
    """The verdicts for the terminal."""
    heads = (
        "model",
        "condition",
        Column("rate L2", "%", scale=100.0),
        Column("settled error", "deg/s"),
        Column("reference ±", "deg/s"),
        "verdict",
    )
    rows = [
        (
            model,
            row["condition"],
            row["rate_relative_l2"],
            row["settled_rate_error_deg_s"],
            row["reference_uncertainty_deg_s"],
            row["verdict"],
        )
        for model in ("calibrated", "compliant")
        for row in found[model]
    ]
    count = len(found["conditions"])
    return [Table(heads, rows, title=f"{count} conditions drawn with seed {found['seed']}")]


def _drawn(conditions: dict) -> Table:
    keys = list(dict.fromkeys(key for row in conditions.values() for key in row))
    rows = [
        [name, *(_value(key, row.get(key)) for key in keys)] for name, row in conditions.items()
    ]
    return Table(["condition", *keys], rows, dense=True)


def _value(key: str, value: float | None) -> str | None:
    """Angles in degrees, lengths in mm; else SI."""
    if value is None:
        return None
    angle = "misalignment" in key or key.endswith("radial")
    return (
        f"{math.degrees(value):.4g} deg"
        if angle
        else f"{1e3 * value:.4g} mm"
        if "eccentricity" in key
        else f"{value:.4g}"
    )
