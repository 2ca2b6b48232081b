"""Agreement on blind conditions on the page and in the terminal."""

import math

from tipoff.studies.agreement import distribution_page
from tipoff.studies.agreement.page import judged, summary
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Cells, Column, Table


def draw(found: dict) -> list[Part]:
    """The section."""
    options, compliant, calibrated = found["asked"], found["compliant"], found["calibrated"]
    origin = (
        " (a digest of the sources and the scene, so other code draws other conditions)"
        if options["seed"] is None
        else ""
    )
    note = (
        f"Drawn from the distributions “{options['vary']}” with seed {found['seed']}{origin}. "
        "Every condition has its own floor and its own uncertainty of the reference by mesh, "
        "step and contact cells. A condition is judged as a distribution if its reference is "
        "not converged, or if 1 µm changes a settled rate by more than the limit of agreement."
    )
    return [
        f"Compliant contact, no fitted constants: {summary(compliant)}.",
        judged(compliant, "blind-compliant", (note,)),
        f"Calibrated springs: {summary(calibrated)}.",
        judged(calibrated, "blind-calibrated"),
        *distribution_page.parts(found, "blind-distributions"),
        Fold("Drawn conditions", [_drawn(found["conditions"])]),
    ]


def terminal(found: dict) -> list[Part]:
    """The verdicts for the terminal."""
    columns: Cells = (
        ("model", "model"),
        ("condition", "condition"),
        (Column("rate L2", "%", scale=100.0), "rate_relative_l2"),
        (Column("settled error", "deg/s"), "settled_rate_error_deg_s"),
        (Column("reference ±", "deg/s"), "reference_uncertainty_deg_s"),
        ("judged as", "judged_as"),
        ("verdict", "verdict"),
    )
    rows = [
        {**row, "model": model} for model in ("calibrated", "compliant") for row in found[model]
    ]
    count = len(found["conditions"])
    alike = found["distributions"]
    return [
        Table.of(rows, columns, title=f"{count} conditions drawn with seed {found['seed']}"),
        *([distribution_page.verdicts_of(alike)] if alike else []),
    ]


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
