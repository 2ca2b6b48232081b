"""Stress of the rails on the page: the peak of each condition, warnings, pictures."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tipoff.studies.render.document import Caption, Image, Notice, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.runs.results import ConditionRun
from tipoff.workspace.words import counted

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
        *(part for view in views for part in _pictures(view, folder)),
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


def _pictures(view: "View", folder: Path) -> Iterator[Part]:
    """The pictures of one condition, or the command that makes them."""
    name = view.condition
    yield (
        f"Condition {name}: {counted(len(view.frames), 'frame')} for ParaView in `{view.collection}`. "
        f"{view.without_pictures}"
    )
    if not view.pictures:
        return
    for kind in ("peak", "ejection"):
        light, dark = (folder / view.pictures[key] for key in (kind, f"{kind}-dark"))
        yield Image(light, f"{kind} of {name}", dark)
    yield Caption(
        f"Condition {name}, elements of {1e3 * view.element_size_m:g} mm, seen from the "
        f"platform. Above: the instant of the peak stress. Below: the ejection. The rails are drawn "
        f"with {view.factor:g} times their deformation, payload and pads to scale, so pads can "
        "appear inside a rail."
    )


def _how(command: str) -> Caption:
    return Caption(
        f"`{command}` adds files for ParaView; with pyvista installed it adds pictures too."
    )
