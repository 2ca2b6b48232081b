"""Recovery of hidden values from the surrogate's own curves with noise: whether a fit on
compliant contact finds them, and how often its intervals contain them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff import calibration, lowfi
from tipoff.calibration import alignment, choice, parameters
from tipoff.calibration.run import shares_in
from tipoff.calibration.search import Plan
from tipoff.comparison.curves import Curves
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import changes as added
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene

NAMES = (
    "contact.clearance",
    "friction.dynamic",
    "contact.interface_stiffness",
    "thrust_offset.eccentricity.y",
)
# Least squares from the scene's values; the global search is as small as possible.
LOCAL = Plan(points=2, starts=1, evaluations=4, polish=8)
_NEAR = 0.03  # largest distance of hidden values from the scene's, as a share of the bounds


class Draw(NamedTuple):
    """Hidden values (p,) SI, the overrides of a condition that set them, and the fit."""

    hidden: list[float]
    found: Calibration
    constants: dict[str, float]
    changes: dict[str, float]

    def truth(self, scene: Scene) -> Scene:
        """The scene of a condition with the hidden values."""
        return scene.replace(self.constants | added.overrides(scene, self.changes))

    def inside(self, intervals: Sequence[Sequence[float]]) -> np.ndarray:
        """Whether each hidden value is inside its interval (p,). A parameter that the curves do not
        determine has no interval: False."""
        return np.array(
            [
                -np.inf < low <= value <= high < np.inf
                for (low, high), value in zip(intervals, self.hidden)
            ]
        )


def drawn_and_fitted(
    scene: Scene,
    conditions: Sequence[str],
    compliance: RailCompliance | None,
    noise: float,
    generator: np.random.Generator,
    fit: Sequence[str] = NAMES,
) -> Draw:
    """Values of the parameters ``fit`` drawn within 3 % of their bounds from the scene's, and the fit
    to curves of ``conditions`` with ``noise`` relative to the largest value of each curve."""
    items = choice.named(scene, conditions, fit)
    shares = shares_in(scene, items) + generator.uniform(-_NEAR, _NEAR, len(items))
    values = {item.name: item.value(float(share)) for item, share in zip(items, shares)}
    constants, changes = parameters.overrides(scene, values), alignment.changes(values)
    references = {}
    for name in conditions:
        own = scene.condition(name)
        hidden = own.replace(constants | added.overrides(own, changes))
        exact = Curves.from_trajectory(lowfi.run(hidden, compliance=compliance))
        references[name] = noisy(exact, noise, generator)
    found = calibration.run(scene, references, plan=LOCAL, compliance=compliance, fit=list(fit))
    return Draw(list(values.values()), found, constants, changes)


def noisy(exact: Curves, noise: float, generator: np.random.Generator) -> Curves:
    """Curves with white noise, ``noise`` relative to the largest value of each."""
    velocity = exact.velocity + noise * np.abs(exact.velocity).max() * generator.standard_normal(
        exact.time.size
    )
    rate = exact.rate + noise * np.abs(exact.rate).max(axis=0) * generator.standard_normal(
        exact.rate.shape
    )
    settled = rate[exact.time >= exact.window_start].mean(axis=0)
    source = f"{exact.source}, noise of {noise:g}"
    return exact._replace(velocity=velocity, rate=rate, settled=settled, source=source)
