"""Cases of an ensemble whose overrides are computed from draws, where one draw may set several
inputs."""

from collections.abc import Callable

import numpy as np

from tipoff.files import content_hash
from tipoff.lowfi.ensemble.sampling import Points
from tipoff.scenes.distributions import BY_NAME, Distribution
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty

Numbers = dict[str, np.ndarray]
_SAMPLE = 16  # cases whose overrides represent ``derive`` in the identity


class Derived:
    """Rows of cases for ``lowfi.ensemble``. ``derive`` computes columns (n,) of overrides by dotted
    key, SI, from columns (n,) of the draws of ``uncertainty`` by the names of its ``vary``, which
    need not be keys of a scene. ``derive`` treats each case independently, so that a case has the
    same bits in every chunk."""

    def __init__(self, uncertainty: Uncertainty, derive: Callable[[Numbers], Numbers]):
        self._points, self._vary, self._derive = Points(uncertainty), uncertainty.vary, derive
        self.asked = uncertainty.cases
        sample = self.rows(0, min(_SAMPLE, self.asked))
        self.keys, self.identity = (
            list(sample[0]),
            uncertainty.resolved() | {"derived": content_hash(sample)},
        )

    def rows(self, begin: int, end: int) -> list[dict[str, float]]:
        """Overrides of the cases ``begin`` to ``end`` - 1, SI."""
        points = self._points.draw(begin, end)
        columns = self._derive(
            {name: law.ppf(column) for (name, law), column in zip(self._vary.items(), points.T)}
        )
        return [
            dict(zip(columns, values))
            for values in zip(*(column.tolist() for column in columns.values()))
        ]


def friction(scene: Scene, dynamic: np.ndarray) -> Numbers:
    """Overrides of friction in ``scene``, which has friction, for coefficients ``dynamic`` (n,).
    The static coefficient keeps its ratio to the dynamic one, so it is never smaller."""
    assert scene.friction is not None
    return {
        "friction.dynamic": dynamic,
        "friction.static": dynamic * (scene.friction.static / scene.friction.dynamic),
    }


def law(distribution: str, **values) -> Distribution:
    """A distribution with its values in SI."""
    return BY_NAME[distribution].model_validate(
        {"distribution": distribution, **values}, context={"unit": "", "bare_numbers_are_si": True}
    )


def around_zero(half_range: float, rule: str) -> Distribution:
    """A normal distribution about zero with three sigma equal to ``half_range``, truncated there by
    a ``rule``: redraw, clip or none."""
    sd = half_range / 3.0
    if rule == "none":
        return law("normal", mean=0.0, sd=sd)
    return law("truncated-normal", mean=0.0, sd=sd, low=-half_range, high=half_range, rule=rule)
