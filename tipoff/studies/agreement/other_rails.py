"""Agreement on other rails: scenes whose results are in folders beside that of the page."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tipoff import scenes
from tipoff.scenes.rail_compliance import digest
from tipoff.studies.agreement import stage as compare
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.render.column import Column
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Table
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, picked

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_NOTE = (
    "The springs are calibrated for each scene. Conditions with contact are judged, as curves or as "
    "distributions. Errors are those of the conditions judged as curves. `tipoff compare --scene thin "
    '--set studies.element_size="4 mm"` computes those of the thin rail of the catalogue.'
)


@dataclass(frozen=True)
class Scene:
    """Agreement of a scene of the catalogue, and its calibrated ``constants`` (SI)."""

    name: str
    agreement: Agreement
    constants: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class OtherRail:
    """One model over the conditions with contact of a scene; largest errors over conditions judged
    as curves, None without such a condition."""

    scene: Annotated[str, Column("scene")]
    element_size_m: Annotated[float, Column("elements", "mm", "g", 1e3)]
    model: Annotated[str, Column("model")]
    judged: Annotated[str, Column("judged")]
    agree: Annotated[int, Column("agree")]
    as_distributions: Annotated[int, Column("as distributions")]
    rate_relative_l2: Annotated[float | None, Column("largest rate L2", "%", ".2g", 100.0)]
    settled_rate_error_deg_s: Annotated[
        float | None, Column("largest settled error", "deg/s", ".2g")
    ]
    lost: Annotated[str, Column("not judged")]


def beside(folder: Path) -> list[Scene]:
    """The catalogue's scenes with other rails or pads, from current results in folders beside
    ``folder``."""
    found, own = [], digest(scenes.load(folder.name)) if folder.name in scenes.catalog() else None
    for path in sorted(folder.parent.glob("*/agreement.json")):
        name = path.parent.name
        if name not in scenes.catalog() or digest(scenes.load(name)) == own:
            continue
        size = picked(path, lambda found: float(found["element_size_m"]))
        if size is None:
            continue
        other = Study(scenes.load(name), path.parent, replace(defaults(name), element_size=size))
        agreement = compare.stored(other)
        constants = picked(other.path("calibration.json"), lambda found: dict(found["constants"]))
        if agreement is not None and constants is not None:
            found.append(Scene(name, agreement, constants))
    return found


def draw(page: "Page") -> list[Part]:
    """The section; empty if no other scene has results."""
    found = page.results.get("rails")
    return parts(found) if found else []


def parts(found: Sequence[Scene]) -> list[Part]:
    """Agreement and constants of the scenes ``found``."""
    rows = [
        (
            scene.name,
            ", ".join(
                f"{key.removeprefix('contact.')} {value:.4g}"
                for key, value in scene.constants.items()
            ),
        )
        for scene in found
    ]
    return [table(found, _NOTE), Table(("scene", "calibrated constants (SI)"), rows)]


def table(found: Sequence[Scene], *notes: str, title: str = "") -> Table:
    """Two rows a scene: calibrated springs and compliant contact."""
    rows = [
        _row(scene, model, own)
        for scene in found
        for model, own in (
            ("springs, calibrated", scene.agreement.calibrated),
            ("compliant", scene.agreement.compliant),
        )
    ]
    return Table.of_records(rows, kind=OtherRail, notes=notes, title=title)


def _row(scene: Scene, model: str, rows: Sequence[verdicts.JudgedCondition]) -> OtherRail:
    touched = [row for row in rows if row.touches]
    judged = [row for row in touched if row.judgement != verdicts.CANNOT]
    curves = [row for row in judged if row.is_judged_as_curve]
    words = [row.judgement for row in judged]
    return OtherRail(
        scene=scene.name,
        element_size_m=scene.agreement.element_size_m,
        model=model,
        judged=f"{len(judged)} of {len(touched)}",
        agree=words.count(verdicts.AGREES),
        as_distributions=words.count(verdicts.AS_DISTRIBUTION),
        rate_relative_l2=verdicts.largest(row.rate_relative_l2 for row in curves),
        settled_rate_error_deg_s=verdicts.largest(row.settled_rate_error_deg_s for row in curves),
        lost=", ".join(row.condition for row in touched if row.judgement == verdicts.CANNOT),
    )
