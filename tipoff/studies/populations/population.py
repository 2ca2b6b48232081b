"""Many cases of a scene on the surrogate of the tolerance studies, kept in a store beside the
results.

The surrogate is compliant contact unless springs are named. Springs have the calibrated constants as
overrides of the scene, so a case can vary them like any other input. An incomplete store is completed, a
complete one is only read.

All cases have one number of rail modes. The pilot cases of the first population of a study choose it
(``lowfi.ensemble.pilot``), and its store keeps it. All other runs of the study use the model of this
population, so two results never differ by modes.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tipoff import lowfi
from tipoff.files import content_hash
from tipoff.lowfi.ensemble import columns, pilot
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.store import StoreError
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics import instant
from tipoff.mechanics.instant import Instant
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results import unfinished
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import implausible
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.rail_compliance import model_of
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import kept
from tipoff.studies.agreement.kept import require_accepted
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace import kernel_marks, words
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted

_DOUBTFUL: dict[str, list[str]] = {}  # of this process: examined once, said and stored
TOLERANCE = 1e-2  # relative error of a step: 95 % of reference cases within 0.2 % of their rate


class Surrogate(NamedTuple):
    """A scene and its contact: the ``compliance`` of its rails, or the ``calibration`` of its
    springs, with the ``compliance`` of displaced rigid walls where the rails are warm. Both are
    None without contact. ``modes`` of each rail that vibrate, with the reason ``modes_why``;
    ``"auto"`` until the pilot cases of a population have chosen. ``instant`` of its results."""

    scene: Scene
    calibration: Calibration | None
    compliance: RailCompliance | None
    modes: int | str = AUTO
    modes_why: str = ""
    instant: Instant = Instant()

    @property
    def words(self) -> str:
        """The name of the model and the source of its constants."""
        return words.model(self.scene, self.calibration is not None, self.compliance)

    @property
    def name(self) -> str:
        """Name of the model."""
        return model_of(self.scene, self.compliance)

    def at(self, overrides: dict[str, Any]) -> "Surrogate":
        """The same on a changed scene."""
        return self._replace(scene=self.scene.replace(overrides))

    def watched(self, asked: str | None) -> "Surrogate":
        """The same at the instant ``asked``, or at that by the rule of ``instant``, from one run of
        the scene."""
        share = None if asked else _trial_run(self).outcome.impulse_after_exit
        return self._replace(instant=instant.chosen(asked, share))

    def with_modes_of(self, ensemble: Ensemble) -> "Surrogate":
        """The same with the modes of an ``ensemble``, and their reason."""
        return self._replace(modes=ensemble.numerics.modes, modes_why=ensemble.modes_why)

    def ensemble(self, source, tolerance: float = TOLERANCE) -> Ensemble:
        """The cases of ``source`` (``lowfi.ensemble.rows``) on this model."""
        numerics = Numerics.of_many(tolerance, self.modes, self.name)
        return Ensemble(
            self.scene,
            source,
            calibration=None,
            numerics=numerics,
            compliance=self.compliance,
            modes_why=self.modes_why,
        )

    @property
    def mode_count(self) -> int:
        """The number of modes. Raises ValueError before pilot cases have chosen it."""
        if not isinstance(self.modes, int):
            raise ValueError("modes: the population of the study chooses them first")
        return self.modes

    def numerics(self, tolerance: float) -> Numerics:
        """Numerics of a run that is compared with a population; ValueError as for ``mode_count``."""
        return Numerics.of_many(tolerance, self.mode_count, self.name)


class Population(NamedTuple):
    """``inputs`` (n,) by dotted key, SI; ``results`` as columns, with the velocity and rate of the
    model's instant, NaN in cases without it; the folder ``store``; ``counts`` from
    ``lowfi.ensemble.columns.counts``; the ``model`` with the modes of its cases."""

    inputs: dict[str, np.ndarray]
    results: Columns
    store: str
    counts: dict[str, int]
    model: Surrogate

    @property
    def settled(self) -> np.ndarray:
        """Whether a case left the rail and has values at the instant (n,)."""
        found = self.results
        return np.isfinite(found.rate[:, 0]) & np.isfinite(found.exit_attitude[:, 0])


def surrogate(study: Study, model: str | None = None, condition: str | None = None) -> Surrogate:
    """The surrogate of a ``model`` (None: the default) on a ``condition`` of a study (None: the
    scene). Its rail compliance or its calibration is computed unless it is stored.

    Raises StudyError if no model is named and the agreement table rejects the default.
    """
    scene = study.condition(condition) if condition else study.scene
    if scene.contact is None:
        return Surrogate(scene, None, None)
    if model == SPRINGS:
        fitted = calibrate.load(study)
        return Surrogate(fitted.apply(scene), fitted, study.rigid_rails(scene))
    require_accepted(study, model, condition)
    degree = Numerics.of_many(TOLERANCE).known_degree
    return Surrogate(scene, None, study.rail_compliance(scene, run_degree=degree))


def require_settling(*models: Surrogate) -> None:
    """Run each of ``models`` once, until one settles. Raises StudyError with the ends of the runs
    if none settles: thousands of similar cases would end in the same way."""
    ended = []
    for model in models:
        found = _trial_run(model)
        if found.outcome.rate is not None:
            return
        ended.append(
            ": ".join(
                filter(None, [found.status, found.message, unfinished.advice(model.scene, found)])
            )
        )
    raise StudyError(
        f"the scene itself does not leave the rail and settle ({'; '.join(dict.fromkeys(ended))}), so "
        "cases like it tell nothing"
    )


def _trial_run(model: Surrogate) -> Trajectory:
    """One quick run of the scene, without modes."""
    vibrates = model.compliance is not None and model.name == COMPLIANT
    numerics = Numerics.of_many(TOLERANCE, 0 if vibrates else AUTO, model.name)
    return lowfi.run(model.scene, model.name, numerics=numerics, compliance=model.compliance)


@dataclass(frozen=True, kw_only=True)
class Answering:
    """The first fields of a result of many cases: the ``model``, the number of its ``modes`` and
    why (empty if it can have none), and its ``agreement`` with the reference as text; ``at``: the
    instant of velocity and rates, and why; ``failed``: a line for each figure that could not be drawn.
    """

    model: str
    modes: int | str
    modes_why: str
    agreement: str
    at: str
    at_why: str
    failed: tuple[str, ...] = ()


def answering(study: Study, model: Surrogate, condition: str | None = None) -> dict[str, Any]:
    """The fields of ``Answering``."""
    return {
        "model": model.words,
        "modes": model.modes,
        "modes_why": model.modes_why,
        "agreement": kept.words(study, model.name, condition, model.calibration),
        "at": model.instant.at,
        "at_why": model.instant.why,
    }


def model_words(found: Answering) -> str:
    """The model of a result, with its modes and why."""
    return with_modes(found.model, found.modes, found.modes_why)


def with_modes(model: str, modes: int | str, why: str) -> str:
    """The words of a ``model``, with the number of its ``modes`` and why."""
    if not why:
        return model
    number = counted(int(modes), "mode") if modes else "no modes"
    return f"{model} with {number} of each rail ({why.partition(': ')[2]})"


def model_line(found: Answering) -> str:
    """One line about the model of a result, and the instant of its rates."""
    at = Instant(found.at, found.at_why).words
    return f"model {model_words(found)}; agreement: {found.agreement}; rates {at}"


def chosen_modes(name: str, ensemble: Ensemble, store: Path | None = None) -> Ensemble:
    """``lowfi.ensemble.pilot.settled`` with progress under the ``name`` of a study. Says what is
    implausible in the cases."""
    for warning in doubtful(ensemble):
        say(f"implausible: {warning}")
    with Board(name, 1) as board:
        return pilot.settled(ensemble, store, board.callback("pilot cases"))


def doubtful(ensemble: Ensemble) -> list[str]:
    """Messages on values of the cases that are implausible, though those of the scene are not."""
    source = ensemble.source
    key = content_hash([ensemble.scene.hash, source.identity])
    if key not in _DOUBTFUL:
        _DOUBTFUL[key] = implausible.of_cases(ensemble.scene, source.asked, source.rows)
    return _DOUBTFUL[key]


def run(
    study: Study, name: str, model: Surrogate, source, tolerance: float = TOLERANCE
) -> Population:
    """Results of every case of ``source`` (``lowfi.ensemble.rows``), in a store with ``name``. If
    ``model`` has no number of modes yet, it is that of the store, or pilot cases choose it. Raises
    StudyError when the store fails."""
    asked = model.ensemble(source, tolerance)
    path = study.path(f"{name}-{asked.key[:8]}")
    like = Run(
        "lowfi",
        name,
        scene=model.scene,
        numerics=asked.numerics,
        calibration=None,
        compliance=model.compliance,
    )
    with kernel_marks.first_use(like):
        ensemble = chosen_modes(name, asked, path)
    try:
        store = ensemble.store(path)
        label = f"{name}, {store.asked:,} cases"
        with Board(name, 1) as board:
            report = board.callback(label)
            fill(
                ensemble,
                store,
                study.settings.workers,
                progress=lambda stored: report(stored / store.asked),
            )
        results, inputs = store.read(0, store.asked)
        by_key = dict(zip(store.names, inputs.T))
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    return Population(
        by_key,
        columns.seen(results, model.instant.at),
        study.relative(path),
        columns.counts(results.status),
        model.with_modes_of(ensemble),
    )
