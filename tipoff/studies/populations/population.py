"""Many cases of a scene on the surrogate of the tolerance studies, kept in a store beside the
results.

The surrogate is compliant unless springs are named. Springs have the calibrated constants as
overrides of the scene, so that a case may vary them like any other input. An incomplete store is
completed, and a complete one is only read.
"""

from typing import Any, NamedTuple

import numpy as np

from tipoff.lowfi.ensemble import columns, pilot
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
from tipoff.studies.core import kernel_marks, words
from tipoff.studies.core.models import require_accepted
from tipoff.studies.core.progress import Board
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study, StudyError

TOLERANCE = 1e-2  # relative error of a step: 95 % of reference cases within 0.2 % of their rate


class Surrogate(NamedTuple):
    """A scene and its contact: the ``compliance`` of its rails, or the ``calibration`` of its
    springs, with the ``compliance`` of displaced rigid walls where the rails are warm. Both are
    None without contact."""

    scene: Scene
    calibration: Calibration | None
    compliance: RailCompliance | None

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


class Population(NamedTuple):
    """``inputs`` (n,) by dotted key, SI; ``results`` as columns, NaN in cases that did not settle;
    the folder ``store``; ``counts`` from ``lowfi.ensemble.columns.counts``."""

    inputs: dict[str, np.ndarray]
    results: Columns
    store: str
    counts: dict[str, int]

    @property
    def settled(self) -> np.ndarray:
        """Whether a case left the rail and settled (n,)."""
        return np.isfinite(self.results.exit_time)


def surrogate(study: Study, model: str | None = None, condition: str | None = None) -> Surrogate:
    """The surrogate of a ``model`` (None: the default) on a ``condition`` of a study (None: the
    scene). Its rail compliance or its calibration is computed unless it is stored.

    Raises StudyError where no model is named and the agreement table rejects the default.
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
    """The ``model`` and its ``agreement`` with the reference, as text for a result file."""
    return {
        "model": model.words,
        "agreement": kept.words(study, model.name, condition, model.calibration is not None),
    }


def model_line(found: dict) -> str:
    """One line about the model of a result that has the items of ``answering``."""
    return f"model {found['model']}; agreement: {found['agreement']}"


def run(
    study: Study, name: str, model: Surrogate, source, tolerance: float = TOLERANCE
) -> Population:
    """Results of every case of ``source`` (``lowfi.ensemble.rows``), in a store named after
    ``name``. Raises StudyError when the store fails."""
    numerics = Numerics(relative_tolerance=tolerance)
    like = Run("lowfi", name, model.scene, numerics, None, model.compliance)
    with kernel_marks.first_use(like, many=True):
        ensemble, _ = pilot.settled(Ensemble(model.scene, source, None, numerics, model.compliance))
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
        by_key = dict(zip(store.names, inputs.T))
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    return Population(by_key, results, study.relative(path), columns.counts(results.status))
