"""Agreement on conditions drawn by a seed that nobody chose, on the page."""

import math
from collections.abc import Callable

from tipoff.studies.render.chart import Chart, Picture
from tipoff.studies.render.markup import Html, caption, fold, paragraph, table
from tipoff.studies.report import tables

_WORDS = (
    "Drawn from the distributions “{vary}” with seed {seed}{origin}. Every condition has a floor "
    "and an "
    "uncertainty of the reference of its own, by mesh, step and penalty."
)


def draw(found: dict, figure: Callable[[Chart | Picture, str], Html]) -> Html:
    """The section."""
    origin = (
        ", which follows from the sources and the scene: a change of the code draws others"
        if found["asked"]["seed"] is None
        else ""
    )
    words = _WORDS.format(vary=found["asked"]["vary"], seed=found["seed"], origin=origin)
    compliant, calibrated = found["compliant"], found["calibrated"]
    return Html(
        "".join(
            [
                paragraph("On compliant contact, nothing fitted: " + tables.summary(compliant)),
                tables.judged(compliant, "blind-compliant"),
                caption(words),
                paragraph("Calibrated springs: " + tables.summary(calibrated)),
                tables.judged(calibrated, "blind-calibrated"),
                fold("What was drawn", _drawn(found["conditions"])),
            ]
        )
    )


def _drawn(conditions: dict) -> Html:
    keys = list(dict.fromkeys(key for row in conditions.values() for key in row))
    rows = [
        (name, *(_value(key, row.get(key)) for key in keys)) for name, row in conditions.items()
    ]
    return table(("condition", *keys), rows, dense=True)


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
