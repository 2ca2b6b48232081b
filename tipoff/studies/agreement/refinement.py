"""Uncertainty of the reference by its own refinements: mesh, step, contact cells.

Each is refined alone, and the settled rates are extrapolated with their observed order
(``comparison.extrapolation``). The result is the uncertainty of the run that every other stage uses. For
the mesh this is the mesh of the scene. Step and cells are refined further, on the coarse mesh: their
uncertainty is that of the finest run plus the distance to it. A mesh file that cannot be coarsened is
refined instead.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from tipoff.comparison.extrapolation import Estimate, estimate
from tipoff.comparison.metrics import compare
from tipoff.highfi.numerics import LEAST_CELLS, Numerics
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement.verdicts import CONVERGED_DEG_S, Refinement
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

MESH, STEP, CELLS = "mesh", "step", "cells"
_TWO = 2  # meshes, the fewest that show a change
_SAFETIES = (Numerics().safety, 0.45)


class Group(NamedTuple):
    """Runs of one refinement at their ``sizes``, coarsest first, and the number of the run that is
    ``used`` elsewhere."""

    sizes: list[float]
    runs: list[Run]
    used: int


def meshes(study: Study, name: str, sizes: Iterable[float]) -> list[Run]:
    """One run for each element size (m). A run that several stages make has one name, so the store
    keeps it once."""
    settings = study.settings
    known = {
        2.0 * settings.coarse_size: "-coarsest",
        settings.coarse_size: "-coarse",
        settings.element_size: "",
    }
    return [
        study.highfi(name, element_size=size, tag=known.get(size, f"-{1e3 * size:g}mm"))
        for size in sizes
    ]


def mesh_sizes(
    study: Study, scene: Scene, given: Iterable[float], least: int
) -> tuple[list[float], list[float]]:
    """Requested element sizes (m), coarsest first, and the sizes of their meshes. A file gives one
    mesh for several ``given`` sizes. Then only the size of the other stages is used, or else the
    smallest, and finer sizes follow until there are ``least`` meshes, if they fit."""
    from tipoff.highfi.rail import refinement as mesh_files  # slow to load

    wanted = list(given)
    own: dict[float, float] = {}
    for asked, size in zip(wanted, mesh_files.sizes(scene, wanted)):
        if own.get(size) != study.settings.element_size:
            own[size] = asked
    while len(own) < least:
        finer = 0.5 * min(own)
        if reason := mesh_files.too_fine(scene, finer):
            say(f"  a finer mesh is left out: {reason}")
            break
        own[finer] = finer
    return list(own.values()), list(own)


def steps(study: Study, name: str, safeties: Iterable[float]) -> list[Run]:
    """One run on the coarse mesh for each share of the critical step."""
    known = {
        Numerics().safety: study.coarse(name),
        0.45: study.coarse(name, tag="-step", safety=0.45),
    }
    return [
        known.get(safety) or study.coarse(name, tag=f"-safety-{safety:g}", safety=safety)
        for safety in safeties
    ]


def contact_cells(study: Study, name: str, counts: Iterable[int]) -> list[Run]:
    """One run on the coarse mesh for each number of contact cells along an edge of a pad."""
    return [
        study.coarse(name)
        if count == LEAST_CELLS  # the number of every other run
        else study.coarse(name, tag=f"-cells-{count}", cells=count)
        for count in counts
    ]


def groups(study: Study, name: str) -> dict[str, Group]:
    """The refinements of a condition by cause: the mesh; on the scene's refined conditions also
    step and cells."""
    scene, settings = study.condition(name), study.settings
    asked, sizes = mesh_sizes(study, scene, settings.judged_sizes, _TWO)
    found = {MESH: Group(sizes, meshes(study, name, asked), asked.index(settings.element_size))}
    if name in study.scene.agreement.refined:
        found[STEP] = Group(list(_SAFETIES), steps(study, name, _SAFETIES), 0)
        if study.scene.contact is not None:
            counts = (LEAST_CELLS // 2, LEAST_CELLS, 2 * LEAST_CELLS)
            spacing = [1.0 / count for count in counts]
            found[CELLS] = Group(spacing, contact_cells(study, name, counts), 1)
    return found


def refinements(study: Study, names: Iterable[str] | None = None) -> list[Refinement]:
    """Uncertainties of the reference on the conditions ``names`` (default: all). The uncertainty by
    the mesh also reveals chaotic conditions. Where it alone is too large, step and cells are not
    refined: no single run judges such a condition."""
    wanted = {name: groups(study, name) for name in (names or study.conditions)}
    by_mesh = _measured(study, [(name, MESH, found[MESH]) for name, found in wanted.items()])
    further = [
        (item.condition, cause, group)
        for item in by_mesh
        if item.uncertainty_deg_s is not None and item.uncertainty_deg_s <= CONVERGED_DEG_S
        for cause, group in wanted[item.condition].items()
        if cause != MESH
    ]
    return by_mesh + _measured(study, further)


def _measured(study: Study, wanted: Sequence[tuple[str, str, Group]]) -> list[Refinement]:
    """Uncertainties of conditions by a cause each."""
    runs = iter(study.store.fill("refinement", [run for *_, group in wanted for run in group.runs]))
    return [
        refinement(name, cause, group.sizes, [next(runs) for _ in group.runs], group.used)
        for name, cause, group in wanted
    ]


def refinement(
    condition: str, cause: str, sizes: Sequence[float], runs: Sequence[Trajectory], used: int
) -> Refinement:
    """Uncertainty of the run number ``used`` of the ``runs`` of the reference at falling ``sizes``
    in any unit."""
    last = compare(runs[-1], runs[-2]) if len(runs) > 1 else None
    uncertainty, found = _largest(sizes, runs, used)
    return Refinement(
        condition=condition,
        model="reference",
        cause=cause,
        sizes=list(sizes),
        rate_relative_l2=None if last is None else last.rate_relative_l2,
        settled_rate_change_deg_s=None if last is None else last.settled_rate_error_deg_s,
        uncertainty_deg_s=uncertainty,
        order=found.order,
        method=found.method,
    )


def _largest(
    sizes: Sequence[float], runs: Sequence[Trajectory], used: int
) -> tuple[float | None, Estimate]:
    """The largest uncertainty (deg/s) over the axes, and its estimate."""
    rates = [run.outcome.rate for run in runs]
    if any(rate is None for rate in rates):
        return None, estimate(sizes, [None] * len(sizes))
    columns = np.degrees(np.array(rates, dtype=float)).T.tolist()
    found = [estimate(sizes, column) for column in columns]
    total = [
        None if item.uncertainty is None else item.uncertainty + abs(column[used] - column[-1])
        for item, column in zip(found, columns)
    ]
    return max(zip(total, found), key=lambda pair: math.inf if pair[0] is None else pair[0])
