"""Promises: limits of the errors of a run's balances, and the limits that a run exceeds.

An error is a residual over a scale. A sum of large terms has their rounding error, even if the sum
is small. For example, without transverse motion the transverse scale is only rounding. So the scale
is at least

    rounding * (size of the terms) / promise

On a smaller scale, double precision cannot distinguish kept from broken promises.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

# A sum of a million terms with rounding errors of random sign.
ROUNDING = 1e3 * float(np.finfo(float).eps)
_WORDS = {
    "energy_error": "total energy",
    "transverse_energy_error": "transverse energy",
    "linear_momentum_error": "linear momentum",
    "angular_momentum_error": "angular momentum",
    "quaternion_error": "norm of the quaternions",
}
_LOOSEST = 0.1  # with a larger loss of energy, a run has no result at any tolerance


class Promises(NamedTuple):
    """Largest relative errors, named as in ``Trajectory.checks``."""

    energy_error: float
    transverse_energy_error: float
    linear_momentum_error: float
    angular_momentum_error: float
    quaternion_error: float
    rounding: float  # relative, of the energies

    def loosened(self, factor: float) -> "Promises":
        """The promises of both ledgers at ``factor`` times the default tolerance: ``factor`` times
        as large, at most a tenth. A smaller tolerance does not change them."""
        factor = max(factor, 1.0)
        return self._replace(
            energy_error=min(self.energy_error * factor, _LOOSEST),
            transverse_energy_error=min(self.transverse_energy_error * factor, _LOOSEST),
        )


RIGID = Promises(
    energy_error=1e-6,
    transverse_energy_error=1e-4,
    linear_momentum_error=1e-12,
    angular_momentum_error=1e-11,
    quaternion_error=1e-12,
    rounding=ROUNDING,
)
# Each of some 100,000 steps sums the energies of some 100,000 nodes.
FINITE_ELEMENTS = Promises(
    energy_error=1e-5,
    transverse_energy_error=1e-2,
    linear_momentum_error=1e-12,
    angular_momentum_error=1e-8,
    quaternion_error=1e-12,
    rounding=1e-11,
)
OF = {"lowfi": RIGID, "highfi": FINITE_ELEMENTS}
CHECKS = tuple(_WORDS)


def scale(largest: float, terms: float, promise: float, rounding: float = ROUNDING) -> float:
    """Scale of a residual: the ``largest`` value of the quantity, but at least the bound of the
    module docstring; all in one unit."""
    return max(largest, rounding * terms / promise)


def relative(residual: float, over: float) -> float:
    """``residual`` over a scale; the residual itself if the scale is zero, when nothing moves."""
    return float(residual / over) if over > 0.0 else float(residual)


def broken(checks: Mapping[str, float], promised: Promises) -> str:
    """Text that lists the promises that ``checks`` do not keep; empty if all are kept."""
    return "; ".join(
        f"{words} is off by {checks[name]:.3g} of its scale, promised is "
        f"{getattr(promised, name):.3g}"
        for name, words in _WORDS.items()
        if name in checks and not checks[name] <= getattr(promised, name)
    )
