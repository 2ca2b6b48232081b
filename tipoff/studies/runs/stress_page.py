"""Stress of the rails on the page: the peak of each condition, warnings, pictures."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tipoff.studies.render.document import Caption, Notice, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.runs.results import ConditionRun
from tipoff.studies.view import page as views_page

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page
    from tipoff.studies.view.stage import View


def draw(page: "Page") -> list[Part]:
    """Peak stresses of all conditions, and pictures of those with a result of ``tipoff view``."""
    rows = page.rows()["highfi"]
    if not rows:
        return [page.missing("highfi", "highfi")]
    return shown(rows, page.results.get("view") or [], page.folder, page.command("view"))


def shown(
    rows: Sequence[ConditionRun], views: "Sequence[View]", folder: Path, command: str
) -> list[Part]:
    """The section: ``rows`` of highfi.json; ``views``, results of the stage ``view``, with files
    below ``folder``; ``command``, which makes these results."""
    measured = [row for row in rows if row.peak_stress_pa is not None]
    if not measured:
        return ["No run of the reference contains peak stresses."]
    warnings = [f"{row.condition}: {line}" for row in measured for line in row.warnings]
    strengths = {row.yield_strength_pa for row in measured if row.yield_strength_pa is not None}
    strength = ", ".join(f"{1e-6 * value:g} MPa" for value in sorted(strengths))
    note = (
        "Largest von Mises stress at any node of any element, not averaged. Yield strength: "
        f"{strength or 'not stated by the scene'}. At a sharp inner corner or the border of a clamp "
        "linear elasticity has no finite stress: there the peak grows with each refinement, and the "
        "convergence study uses means over patches of 4 mm. Rails are elastic; strains and "
        "rotations are small."
    )
    columns = (
        *("condition", "peak_stress_pa"),
        (Column("of yield", "%", scale=100.0), _of_yield),
        ("x, y, z (mm)", _place),
        *("peak_stress_rail", "peak_stress_time_s", "largest_strain"),
        (Column("largest rotation", "deg", ".2g"), _rotation),
    )
    table = Table.of_records(measured, *columns, notes=(note,))
    return [
        *map(Notice, warnings),
        replace(table, dense=True),
        *(part for view in views for part in views_page.draw(view, folder)),
        *([] if views else [_how(command)]),
    ]


def _of_yield(row: ConditionRun) -> float | None:
    if row.yield_strength_pa is None or row.peak_stress_pa is None:
        return None
    return row.peak_stress_pa / row.yield_strength_pa


def _place(row: ConditionRun) -> str:
    return ", ".join(f"{1e3 * value + 0.0:.5g}" for value in row.peak_stress_place_m or ())


def _rotation(row: ConditionRun) -> float | None:
    return row.largest_rotation_rad and math.degrees(row.largest_rotation_rad)


def _how(command: str) -> Caption:
    return Caption(
        f"`{command}` adds files for ParaView; with pyvista installed it adds pictures too."
    )
