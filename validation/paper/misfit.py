"""Misfit of a set of inputs: its errors from the paper's printed rates, and its rates on conditions
where the paper calls them negligible.

    nine rates       e = w - w_printed, conditions 2 to 4 at the baseline           weight 1 / s
    54 deviations    e = (w_changed - w) - (w_changed - w)_printed                  weight 1 / s
    conditions 1, 5  e = max(|w| - 0.3 deg/s, 0)                                    weight ``stress`` / s

s is per axis the root mean square of the printed deviations themselves (0.034, 0.013, 0.0075 deg/s). They
are not monotone in k, c or d (the roll rate of condition 2 falls for a softer and for a stiffer contact),
so s is scatter of the printed solution, which no smooth model reproduces. The misfit of a residual is
sqrt(1 + (e/L)^2) - 1 with L = 0.3 deg/s, which the paper calls negligible. So one large error does not
hide eight small ones.
"""

import math

import numpy as np

from tipoff.faults import SceneError
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.numerics import Numerics
from tipoff.scenes.scene import Scene
from validation import published
from validation.paper import inputs

NEGLIGIBLE = 0.3  # deg/s
SCATTER = np.sqrt((published.sensitivity().deviations() ** 2).mean(axis=(0, 1)))  # deg/s, per axis
_UNSETTLED = 1e3  # deg/s, for a body that never leaves the rail
_RADIAL = "thrust_offset.misalignment.radial"
_SCALE = {
    "k": ("contact.stiffness", None),
    "c": ("contact.damping", 1e3),
    "d": ("contact.damping_depth", 1e-3),
}  # printed unit in SI


class Launcher:
    """The surrogate of ``base`` with the inputs of a point of the unit cube; ``tolerance`` is the
    relative error of a step."""

    def __init__(self, base: Scene, tolerance: float = 1e-3):
        self.base, self.numerics = base, Numerics(relative_tolerance=tolerance)

    def scene(self, shares: np.ndarray) -> Scene:
        """The scene at ``shares`` (p,). Raises SceneError for an impossible body or rail."""
        return self.base.replace(inputs.overrides(self.base, inputs.values(shares)))

    def rates(self, shares: np.ndarray) -> np.ndarray:
        """Settled rates (5,3) deg/s of the paper's conditions."""
        return self._run(
            shares, [{_RADIAL: math.radians(radial)} for _, radial in published.angles().values()]
        )

    def changed(self, shares: np.ndarray) -> np.ndarray:
        """Settled rates (3,6,3) deg/s on conditions 2 to 4 with each contact constant changed as in
        Table 2."""
        exponent = inputs.values(shares)["exponent"]
        rows = [
            {
                _RADIAL: math.radians(published.angles()[condition][1]),
                **_constant(name, value, exponent),
            }
            for condition in published.SENSITIVE
            for name, value in published.CHANGES
        ]
        return self._run(shares, rows).reshape(len(published.SENSITIVE), len(published.CHANGES), 3)

    def _run(self, shares: np.ndarray, rows: list[dict]) -> np.ndarray:
        found = np.full((len(rows), 3), np.radians(_UNSETTLED))
        try:
            family = Family(self.scene(shares), None, self.numerics)
        except SceneError:
            return np.degrees(found)
        for job in family.jobs(rows):
            for number, case in job():
                if case.outcome.rate is not None:
                    found[number] = case.outcome.rate
        return np.degrees(found)


def _constant(name: str, value: float, exponent: float) -> dict[str, float]:
    key, unit = _SCALE[name]
    return {key: inputs.stiffness(value, exponent) if unit is None else value * unit}


def nine(rates: np.ndarray) -> np.ndarray:
    """Errors (3,3) deg/s of the nine printed rates, of the rates (5,3) of all conditions."""
    return (
        rates[[condition - 1 for condition in published.SENSITIVE]]
        - published.sensitivity().baseline
    )


def excess(rates: np.ndarray) -> np.ndarray:
    """Excess (2,3) deg/s of the rates of conditions 1 and 5 over the negligible rate."""
    return np.maximum(
        np.abs(rates[[condition - 1 for condition in published.NEGLIGIBLE]]) - NEGLIGIBLE, 0.0
    )


def deviations(rates: np.ndarray, changed: np.ndarray) -> np.ndarray:
    """Errors (3,6,3) deg/s of the 54 deviations, from the rates (5,3) and the ``changed`` rates
    (3,6,3)."""
    nominal = rates[[condition - 1 for condition in published.SENSITIVE]]
    return changed - nominal[:, None, :] - published.sensitivity().deviations()


def rough(rates: np.ndarray, stress: float) -> float:
    """Misfit of the rates alone."""
    return _soft(nine(rates)) + stress * _soft(excess(rates))


def whole(rates: np.ndarray, changed: np.ndarray, stress: float) -> float:
    """Misfit of rates and deviations; the nine rates weigh as much as the 54 deviations."""
    return rough(rates, stress) + nine(rates).size / changed.size * _soft(
        deviations(rates, changed)
    )


def _soft(errors: np.ndarray) -> float:
    return float((np.sqrt(1.0 + (errors / NEGLIGIBLE) ** 2) - 1.0).sum())


def residuals(rates: np.ndarray, changed: np.ndarray, stress: float) -> np.ndarray:
    """All weighted errors (69,): nine rates, six excesses, 54 deviations; ``changed`` as
    ``Launcher.changed`` gives it."""
    errors = (nine(rates), stress * excess(rates), deviations(rates, changed))
    return np.concatenate([(each / SCATTER).ravel() for each in errors])
