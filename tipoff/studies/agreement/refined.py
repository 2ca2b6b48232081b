"""Runs of the reference with a finer mesh, a shorter step, or more contact cells."""

from collections.abc import Iterable
from typing import NamedTuple

from tipoff.highfi.numerics import LEAST_CELLS, Numerics
from tipoff.highfi.rail import refinement as mesh_files
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement.refinement import (
    CELLS,
    MESH,
    STEP,
    Refinement,
    refinement,
)
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

_TWO = 2  # meshes show a change
_SAFETIES = (Numerics().safety, 0.45)


class Group(NamedTuple):
    """Runs of one refinement at their ``sizes``, coarsest first, and the number of the run that is
    ``used`` elsewhere."""

    sizes: list[float]
    runs: list[Run]
    used: int


def meshes(study: Study, name: str, sizes: Iterable[float]) -> list[Run]:
    """One run for each element size (m). Runs that several stages make have one name, so that the
    store has them once."""
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
    """Element sizes (m) to ask for, coarsest first, and those of the meshes that they give. A file
    gives one mesh for several ``given`` sizes: the size of the other stages, or else the smallest,
    stands for them, and finer ones follow until there are ``least``, where they fit."""
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
        if count == LEAST_CELLS  # what every run has
        else study.coarse(name, tag=f"-cells-{count}", cells=count)
        for count in counts
    ]


def groups(study: Study, name: str) -> dict[str, Group]:
    """The refinements of a condition by cause: the mesh, and on the scene's refined conditions step
    and cells."""
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
    """Uncertainties of the reference on the conditions ``names`` (default: all). That by the mesh
    also reveals chaotic conditions."""
    wanted = [
        (name, cause, group)
        for name in (study.conditions if names is None else names)
        for cause, group in groups(study, name).items()
    ]
    runs = iter(study.store.fill("refinement", [run for *_, group in wanted for run in group.runs]))
    found = []
    for name, cause, group in wanted:
        made = [next(runs) for _ in group.runs]
        found.append(refinement(name, cause, group.sizes, made, group.used))
    return found
