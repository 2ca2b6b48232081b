"""The random errors of the cases: those of a file, or a reading of the paper's Table 3."""

from typing import Any

from tipoff.lowfi.ensemble.derived import Derived
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import halving, uncertainty
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.populations import random_factors
from validation.montecarlo.options import Cases


def source(scene: Scene, asked: Cases, cases: int) -> Derived | Drawn:
    """The first ``cases`` of a study, which do not depend on their number. Raises SceneError with every
    fault."""
    if asked.vary is None:
        return random_factors.source(scene, asked.reading, cases, asked.seed)
    return Drawn(_errors(asked, asked.vary, scene, cases))


def words(scene: Scene, asked: Cases) -> str:
    """The random errors of a ``scene`` as text, those of a file with their sizes."""
    if asked.vary is None:
        return asked.reading.words
    sizes = halving.sizes(_errors(asked, asked.vary, scene, asked.cases))
    return f"distributions of {halving.with_sizes(asked.vary, sizes)}"


def inputs(scene: Scene, asked: Cases) -> dict[str, Any]:
    """What the result depends on beside the options."""
    if asked.vary is None:
        return {}
    return {"errors": _errors(asked, asked.vary, scene, asked.cases).resolved()}


def _errors(asked: Cases, vary: str, scene: Scene, cases: int) -> Uncertainty:
    return uncertainty.load(vary, scene, cases=cases, seed=asked.seed, sampling="random")
