"""Many cases of a scene on the surrogate that its studies use, kept in a store beside the results: what every study of tolerances
asks.

The surrogate is the calibrated one, with its constants laid over the scene, so that a case may vary them like any other number; or
the one on compliant walls, to which nothing is fitted. A store that was left half filled is gone on with, and one that is whole
is only read; which of its cases are outside the calibration is judged, and kept in it, every time.
"""

from typing import Any, NamedTuple

import numpy as np

from lowfi import columns
from lowfi.columns import Columns
from lowfi.fill import fill
from lowfi.numerics import Numerics
from lowfi.request import Ensemble
from lowfi.store import StoreError
from scenes.calibration import Calibration
from scenes.scene import Scene
from scenes.walls import Walls
from studies import words
from studies.populations import marks, regime
from studies.progress import Board
from studies.stages import calibrate
from studies.stages import walls as wall_stage
from studies.study import Study, StudyError

TOLERANCE = 1e-2  # relative error of a step: 95 % of reference cases within 0.2 % of their rate


class Surrogate(NamedTuple):
    """A scene whose contact constants are the calibrated ones, the calibration they come from, and compliant walls, rigid ones
    under a law where the rails are warm, or none.

    A scene without contact has none of them.
    """

    scene: Scene
    calibration: Calibration | None
    walls: Walls | None

    @property
    def words(self) -> str:
        """What pads touch, in words."""
        return words.touched(self.scene, self.calibration, self.walls)

    def at(self, overrides: dict[str, Any]) -> "Surrogate":
        """The same on a changed scene."""
        return self._replace(scene=self.scene.replace(overrides))


class Population(NamedTuple):
    """``inputs`` (n,) by dotted key, SI; results as columns, NaN in cases that did not settle; whether a case is ``outside`` (n,)
    what the calibration was made for; the folder of the store, and counts as ``lowfi.columns.counts`` gives them."""

    inputs: dict[str, np.ndarray]
    results: Columns
    outside: np.ndarray
    store: str
    counts: dict[str, int]

    @property
    def settled(self) -> np.ndarray:
        """Whether a case left the rail and settled (n,)."""
        return np.isfinite(self.results.exit_time)


def surrogate(study: Study, walls: bool = False, condition: str | None = None) -> Surrogate:
    """The surrogate of a study on one of its conditions, or on the scene itself; calibrated, or found, where that was not done
    yet."""
    scene = study.condition(condition) if condition else study.scene
    if scene.contact is None:
        return Surrogate(scene, None, None)
    if walls:
        return Surrogate(scene, None, wall_stage.load(study, scene))
    fitted = calibrate.load(study)
    return Surrogate(fitted.apply(on_springs(scene)), fitted, wall_stage.of_law(study, scene))


def on_springs(scene: Scene) -> Scene:
    """The scene without rails that swing: only compliant walls know their modes."""
    return scene if scene.flexibility is None else scene.replace({"flexibility": None})


def run(study: Study, name: str, model: Surrogate, source, tolerance: float = TOLERANCE) -> Population:
    """Every case of ``source`` (``lowfi.rows``), in a store called after ``name``, with marks on those outside the calibration.
    Raises StudyError when it cannot go on."""
    ensemble = Ensemble(model.scene, source, None, Numerics(relative_tolerance=tolerance), model.walls)
    path = study.path(f"{name}-{ensemble.key[:8]}")
    try:
        store = ensemble.store(path)
        label = f"{name}, {store.asked:,} cases"
        with Board(name, 1) as board:
            report = board.callback(label)
            fill(ensemble, store, study.settings.workers, progress=lambda stored: report(stored / store.asked))
        results, inputs = store.read(0, store.asked)
        named = dict(zip(store.names, inputs.T))
        outside = regime.outside(model, named, store.asked)
        marks.keep(path, outside, model.calibration)
    except StoreError as fault:
        raise StudyError(str(fault)) from fault
    return Population(named, results, outside, study.relative(path), columns.counts(results.status))
