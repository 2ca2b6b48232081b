"""Agreement on other rails: scenes whose results are in folders beside that of the page."""

from typing import TYPE_CHECKING

from tipoff.studies.agreement import verdicts
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Column, Table

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_HEADS = (
    "scene",
    Column("elements", "mm", "g", 1e3),
    "model",
    "judged",
    "agree",
    "as distributions",
    Column("largest rate L2", "%", ".2g", 100.0),
    Column("largest settled error", "deg/s", ".2g"),
    "not judged",
)


def draw(page: "Page") -> list[Part]:
    """The section, where other scenes have results."""
    found = page.documents.get("rails")
    return parts(found) if found else []


def parts(found: list[dict]) -> list[Part]:
    """Agreement and constants of the scenes ``found``."""
    note = (
        "The springs are calibrated for each scene. Conditions with contact are judged, as "
        "curves or as distributions. Errors are those of the conditions judged as curves. "
        "`tipoff compare --scene thin --element-size 4` computes those of the thin rail of the "
        "catalogue."
    )
    rows = [
        (
            scene["name"],
            ", ".join(
                f"{key.removeprefix('contact.')} {value:.4g}"
                for key, value in scene["constants"].items()
            ),
        )
        for scene in found
    ]
    return [table(found, note), Table(("scene", "calibrated constants (SI)"), rows)]


def table(found: list[dict], *notes: str, title: str = "") -> Table:
    """Two rows a scene, calibrated springs and compliant contact, over its conditions with contact:
    number judged, numbers that agree, largest errors of those judged as curves, and names of those
    not judged."""
    rows = [
        (
            scene["name"],
            scene["element_size_m"],
            model,
            *_judged([row for kind in kinds for row in scene["agreement"][kind]]),
        )
        for scene in found
        for model, kinds in (
            ("springs, calibrated", ("fitted", "held_out")),
            ("compliant", ("compliant",)),
        )
    ]
    return Table(_HEADS, rows, notes, title)


def _judged(rows: list[dict]) -> tuple:
    touched = [row for row in rows if row["touches"]]
    judged = [row for row in touched if row["judgement"] != verdicts.CANNOT]
    curves = [row for row in judged if row["judged_as"] == verdicts.CURVE]
    largest = (
        max((row[key] for row in curves if row[key] is not None), default=None)
        for key in ("rate_relative_l2", "settled_rate_error_deg_s")
    )
    return (
        f"{len(judged)} of {len(touched)}",
        *(
            sum(row["judgement"] == word for row in judged)
            for word in (verdicts.AGREES, verdicts.AS_DISTRIBUTION)
        ),
        *largest,
        ", ".join(row["condition"] for row in touched if row["judgement"] == verdicts.CANNOT),
    )
