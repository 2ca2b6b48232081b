"""Many cases of a scene on the surrogate that its studies use, kept in a store beside the results:
what every study of tolerances asks.

The surrogate is compliant unless springs are asked for by name: those are the calibrated ones, with
their constants laid over the scene, so that a case may vary them like any other number. A store
that was left half filled is gone on with, and one that is whole is only read.
"""

from typing import Any, NamedTuple

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.store import StoreError
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.models import SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance, model_of
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import kept
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.core import words
from tipoff.studies.core.models import require_accepted
from tipoff.studies.core.progress import Board
from tipoff.studies.core.study import Study, StudyError

TOLERANCE = 1e-2  # relative error of a step: 95 % of reference cases within 0.2 % of their rate


class Surrogate(NamedTuple):
    """A scene, and either its rail compliance as ``walls``, or the ``calibration`` whose constants
    it has, on rigid walls where the rails are warm. A scene without contact has none of them."""

    scene: Scene
    calibration: Calibration | None
    compliance: RailCompliance | None

    @property
    def words(self) -> str:
        """The model in words."""
        return words.model(self.scene, self.calibration, self.compliance)

    @property
    def name(self) -> str:
        """Name of the model."""
        return model_of(self.scene, self.compliance)

    def at(self, overrides: dict[str, Any]) -> "Surrogate":
        """The same on a changed scene."""
        return self._replace(scene=self.scene.replace(overrides))


class Population(NamedTuple):
    """``inputs`` (n,) by dotted key, SI; results as columns, NaN in cases that did not settle; the
    folder of the store, and counts as ``lowfi.ensemble.columns.counts`` gives them."""

    inputs: dict[str, np.ndarray]
    results: Columns
    store: str
    counts: dict[str, int]

    @property
    def settled(self) -> np.ndarray:
        """Whether a case left the rail and settled (n,)."""
        return np.isfinite(self.results.exit_time)


def surrogate(study: Study, model: str | None = None, condition: str | None = None) -> Surrogate:
    """The surrogate by the name of its ``model``, None for the default, on one condition of a study
    or on the scene itself; its rail compliance or its constants are found where that was not done
    yet.

    Raises StudyError where none is named and the agreement table rejects the default.
    """
    scene = study.condition(condition) if condition else study.scene
    if scene.contact is None:
        return Surrogate(scene, None, None)
    if model == SPRINGS:
        fitted = calibrate.load(study)
        return Surrogate(fitted.apply(scene), fitted, study.rigid_rails(scene))
    require_accepted(study, model, condition)
    return Surrogate(scene, None, study.rail_compliance(scene, judged=False))


def answering(study: Study, model: Surrogate, condition: str | None = None) -> dict[str, str]:
    """Which ``model`` answers, and its ``agreement`` with the reference, in words, as result files
    hold both."""
    return {
        "model": model.words,
        "agreement": kept.words(study, model.name, condition, model.calibration is not None),
    }


def model_line(found: dict) -> str:
    """A line on the model behind a result that holds what ``answering`` gives."""
    return f"model {found['model']}; agreement: {found['agreement']}"


def run(
    study: Study, name: str, model: Surrogate, source, tolerance: float = TOLERANCE
) -> Population:
    """Every case of ``source`` (``lowfi.ensemble.rows``), in a store called after ``name``.
    Raises StudyError when it cannot go on."""
    ensemble = Ensemble(
        model.scene, source, None, Numerics(relative_tolerance=tolerance), model.compliance
    )
    path = study.path(f"{name}-{ensemble.key[:8]}")
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
        named = dict(zip(store.names, inputs.T))
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    return Population(named, results, study.relative(path), columns.counts(results.status))
