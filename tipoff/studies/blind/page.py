"""Agreement on blind conditions."""

import math

from tipoff.scenes import halving
from tipoff.studies.agreement import distribution_page
from tipoff.studies.agreement.page import judged, summary
from tipoff.studies.blind.stage import Blind
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Table


def draw(found: Blind) -> list[Part]:
    """The section."""
    compliant, calibrated = found.compliant, found.calibrated
    origin = (
        ", a digest of the sources and the scene: other code draws other conditions"
        if found.asked.seed is None
        else ""
    )
    note = (
        "Every condition has its own floor and its own uncertainty of the reference by mesh, "
        "step and contact cells. A condition is judged as a distribution if its reference is "
        "not converged, or if 1 µm changes a settled rate by more than the limit of agreement."
    )
    return [
        f"{len(found.conditions)} conditions drawn with seed {found.seed}{origin}, from the "
        f"distributions {halving.with_sizes(found.errors, found.sizes)}.",
        f"Compliant contact, no fitted constants: {summary(compliant)}.",
        judged(compliant, "blind-compliant", (note,)),
        f"Calibrated springs: {summary(calibrated)}.",
        judged(calibrated, "blind-calibrated"),
        *distribution_page.parts(
            found.distributions, found.clearance_change_m, "blind-distributions"
        ),
        Fold("Drawn conditions", [_drawn(found.conditions)]),
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
