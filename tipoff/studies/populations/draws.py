"""The first cases of a population, run by run through the finite-element reference and the surrogate.

A case has the same overrides of the scene in both models. The reference has the element size of studies
with many runs (``Settings.coarse_size``), and half of it for some cases, which gives the error of the
mesh. The surrogate has the rail compliance of the same mesh, the rail modes of the population, and the
step of single runs.
"""

import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Case, Family
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.threads import completed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.names import NOMINAL
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import growth
from tipoff.studies.populations.population import TOLERANCE, Surrogate
from tipoff.workspace import kernel_marks
from tipoff.workspace.announcing import announce
from tipoff.workspace.errors import FAILED, StudyError
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

_PIECE = 16  # runs in memory at once
_REPEATS = 3  # timed runs of the surrogate

Rows = Sequence[Mapping[str, Any]]


class Draws(NamedTuple):
    """``reference`` and ``surrogate``, results of n cases on the same mesh; ``fine``, of the first
    m on the finer mesh; ``contacts`` (n,), the number of contacts of a case in the surrogate:
    intervals in which some pad has a force, as in ``growth.contacts``; ``lost``, status and message
    of each run of the reference that did not settle; processor seconds of a run of the reference,
    ``reference_cpu_s``, and on the finer mesh, ``fine_cpu_s``; numbers of ``elements`` and
    ``fine_elements``."""

    reference: Columns
    surrogate: Columns
    fine: Columns
    contacts: np.ndarray
    lost: list["Lost"]
    reference_cpu_s: float
    fine_cpu_s: float
    elements: int
    fine_elements: int


def run(study: Study, model: Surrogate, rows: Rows, fine: int) -> Draws:
    """The cases with the overrides ``rows`` of the scene, the first ``fine`` of them on the finer
    mesh too. The store of the study keeps the runs, so an interrupted call continues."""
    coarse, finer, surrogates = requests(study, model, rows, fine)
    announce(study, [*coarse, *finer])
    many = filled(study, "tails, reference", coarse)
    few = filled(study, "tails, finer mesh", finer)
    surrogate = filled(study, "tails, surrogate", surrogates)
    at = model.instant.at
    return Draws(
        results(many, at),
        results(surrogate, at),
        fine=results(few, at),
        contacts=np.array([each.contacts for each in surrogate]),
        lost=[*lost(coarse, many), *lost(finer, few)],
        reference_cpu_s=statistics.median(each.cpu_s for each in many),
        fine_cpu_s=statistics.median(each.cpu_s for each in few),
        elements=many[0].elements,
        fine_elements=few[0].elements,
    )


def requests(
    study: Study, model: Surrogate, rows: Rows, fine: int
) -> tuple[list[Run], list[Run], list[Run]]:
    """The runs of the reference, on the coarse and on the finer mesh, and the runs of the surrogate
    ``model``. Raises ValueError before the population has chosen its modes."""
    coarse_size, fine_size = study.settings.coarse_size, study.settings.element_size
    coarse, finer = (
        [
            reference(study, label + tag, study.scene.replace(dict(row)), size)
            for label, row in zip(_labels(part), part)
        ]
        for part, tag, size in ((rows, "-coarse", coarse_size), (rows[:fine], "", fine_size))
    )
    return coarse, finer, beside(study, model, rows, model.numerics(Numerics().relative_tolerance))


def beside(
    study: Study, model: Surrogate, rows: Rows, numerics: Numerics, tag: str = ""
) -> list[Run]:
    """Runs of the surrogate ``model`` with ``numerics``, on the rail compliance of the mesh of the
    reference; ``tag`` distinguishes their labels."""
    under = model.compliance
    if model.name == COMPLIANT and study.scene.contact is not None:
        size, degree = study.settings.coarse_size, numerics.needed_degree
        under = study.rail_compliance(study.scene, element_size=size, degree=degree)
    return [
        Run(
            "lowfi",
            f"{label}-{model.name}{tag}",
            scene=model.at(dict(row)).scene,
            numerics=numerics,
            calibration=None,
            compliance=under,
        )
        for label, row in zip(_labels(rows), rows)
    ]


def _labels(rows: Rows) -> list[str]:
    return [f"{NOMINAL}-draw{number}" for number in range(len(rows))]


def reference(study: Study, label: str, scene: Scene, element_size: float) -> Run:
    """A run of the reference of a changed ``scene`` on elements of ``element_size`` (m)."""
    return replace(study.highfi(NOMINAL, element_size=element_size), label=label, scene=scene)


def seconds_per_case(model: Surrogate, rows: Rows) -> float:
    """Processor seconds of a population of the ``model``, with its modes, for a case of the
    ``rows`` that takes its steps, without compilation. Raises StudyError without any."""
    numerics = model.numerics(TOLERANCE)
    family = Family(model.scene, None, numerics, model.compliance)

    def once(part: Rows) -> float:
        began = time.process_time()
        (cases,) = completed(family, [part], 1)
        spent = time.process_time() - began
        # a refused case takes no time and no step
        stepped = sum(case.steps > 0 and case.status not in FAILED for case in cases)
        if not stepped:
            raise StudyError(f"none of {len(part)} timed cases took its steps")
        return spent / stepped

    like = Run(
        "lowfi",
        "timed",
        scene=model.scene,
        numerics=numerics,
        calibration=None,
        compliance=model.compliance,
    )
    with kernel_marks.first_use(like):
        once(rows[:1])
    return statistics.median(once(rows) for _ in range(_REPEATS))


class Kept(NamedTuple):
    """The kept values of a run: its result, number of contacts, processor seconds, number of
    elements (zero in the surrogate), and the number of rail modes that it chose (zero if it was
    given)."""

    case: Case
    contacts: int
    cpu_s: float
    elements: int
    modes: int = 0


def results(runs: Sequence[Kept], at: str) -> Columns:
    """Results of runs as columns, with velocity and rate of the instant ``at``."""
    return columns.seen(columns.of_cases([each.case for each in runs]), at)


@dataclass(frozen=True)
class Lost:
    """Label, status and message of a run that did not settle."""

    run: str
    status: str
    message: str

    @property
    def words(self) -> str:
        """All three as text."""
        return f"{self.run}: {self.status} {self.message}"


def lost(requested: Sequence[Run], runs: Sequence[Kept]) -> list[Lost]:
    """Each run that did not settle."""
    return [
        Lost(request.label, each.case.status, each.case.message)
        for request, each in zip(requested, runs)
        if each.case.outcome.rate is None
    ]


def filled(study: Study, title: str, runs: Sequence[Run]) -> list[Kept]:
    """The kept values of each of ``runs``; few runs are in memory at once."""
    found: list[Kept] = []
    for begin in range(0, len(runs), _PIECE):
        piece = runs[begin : begin + _PIECE]
        label = f"{title} {begin + 1} to {begin + len(piece)} of {len(runs)}:"
        found += [_kept(each) for each in study.store.fill(label, piece)]
    return found


def _kept(found: Trajectory) -> Kept:
    cost = found.cost
    steps = int(cost["steps"])
    case = Case(found.status, found.message, found.outcome, steps, cost["wall_s"])
    loaded = (
        np.abs(found.pad_force).max(axis=(1, 2)) > 0.0
        if found.pad_force.size
        else np.zeros(found.time.size, dtype=bool)
    )
    return Kept(
        case,
        len(growth.contacts(found.time, loaded)),
        cost.get("cpu_s", cost["wall_s"]),
        int(cost.get("elements", 0)),
        int(cost.get("modes", 0)),
    )
