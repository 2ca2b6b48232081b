"""Curves of the surrogate with hidden values and noise, and quick fits of them."""

import numpy as np

from tests.lowfi.compliance import reference_compliance
from tipoff import calibration, lowfi, scenes
from tipoff.calibration import Curves
from tipoff.scenes.calibration import Calibration
from validation.recovery.draws import LOCAL, noisy

CONDITIONS = ("phi15", "phi35", "phi60")
SCENE = scenes.load("clamped").replace({"agreement.fitted": list(CONDITIONS)})
CLEARANCE, STIFFNESS = "contact.clearance", "contact.interface_stiffness"
FRICTION, LINE = "friction.dynamic", "thrust_offset.eccentricity.y"


def curves(
    hidden: Calibration | dict, noise: float, seed: int, modes: int = 0
) -> dict[str, Curves]:
    """Curves of every condition with ``hidden`` values, and white noise of ``noise`` of each
    curve's largest value."""
    generator, found = np.random.default_rng(seed), {}
    for name in CONDITIONS:
        scene = SCENE.condition(name)
        scene = scene.replace(hidden) if isinstance(hidden, dict) else hidden.apply(scene)
        numerics = lowfi.Numerics(modes=modes)
        run = lowfi.run(scene, compliance=reference_compliance(), numerics=numerics)
        found[name] = noisy(Curves.from_trajectory(run), noise, generator)
    return found


def fitted(references: dict, fit: list[str] | None, scene: scenes.Scene = SCENE) -> Calibration:
    """A fit on compliant contact by least squares."""
    compliance = reference_compliance()
    return calibration.run(scene, references, plan=LOCAL, compliance=compliance, fit=fit)


def inside(intervals: list, truth: list[float]) -> np.ndarray:
    """Whether each value is inside its interval, which must have ends to contain anything."""
    return np.array(
        [-np.inf < low <= value <= high < np.inf for (low, high), value in zip(intervals, truth)]
    )
