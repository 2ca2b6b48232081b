"""What every run promises of its balances, one home for both fidelities and the report, and what of
it a run broke.

An error is a residual over a scale. Sums of large terms are wrong by their rounding, whatever the
scale is that remains of them: a scene in which nothing moves across the rail has a transverse scale
that is itself rounding. So the scale is at least

    rounding * (size of the terms) / promise

the smallest one on which numbers of sixteen digits can tell whether the promise is kept. It hides
nothing: below it a kept promise and a broken one look alike.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

# A sum of a million terms, rounded as a random walk.
ROUNDING = 1e3 * float(np.finfo(float).eps)
_WORDS = {
    "energy_error": "total energy",
    "transverse_energy_error": "transverse energy",
    "linear_momentum_error": "linear momentum",
    "angular_momentum_error": "angular momentum",
    "quaternion_error": "norm of the quaternions",
}
_LOOSEST = 0.1  # a run that loses so much energy is no result at any tolerance


class Promises(NamedTuple):
    """Largest errors, named as in ``Trajectory.checks`` (1), and the relative rounding of the
    energies."""

    energy_error: float
    transverse_energy_error: float
    linear_momentum_error: float
    angular_momentum_error: float
    quaternion_error: float
    rounding: float

    def loosened(self, factor: float) -> "Promises":
        """What remains of the promise of both ledgers at a tolerance ``factor`` times the one they
        are made for: as much more, a tenth at most; a tighter tolerance promises no more."""
        factor = max(factor, 1.0)
        return self._replace(
            energy_error=min(self.energy_error * factor, _LOOSEST),
            transverse_energy_error=min(self.transverse_energy_error * factor, _LOOSEST),
        )


RIGID = Promises(1e-6, 1e-4, 1e-12, 1e-11, 1e-12, ROUNDING)
# Each of some hundred thousand steps sums the energies of some hundred thousand nodes.
FINITE_ELEMENTS = Promises(1e-5, 1e-2, 1e-12, 1e-8, 1e-12, 1e-11)
OF = {"lowfi": RIGID, "highfi": FINITE_ELEMENTS}
CHECKS = tuple(_WORDS)


def scale(largest: float, terms: float, promise: float, rounding: float = ROUNDING) -> float:
    """What a residual is divided by: the ``largest`` value of the quantity, at least what its
    ``terms`` leave to be told of a ``promise``, all in one unit."""
    return max(largest, rounding * terms / promise)


def relative(residual: float, over: float) -> float:
    """``residual`` over a scale; where there is no scale nothing moves, and the residual is zero
    too."""
    return float(residual / over) if over > 0.0 else float(residual)


def broken(checks: Mapping[str, float], promised: Promises) -> str:
    """The promises that ``checks`` do not keep, in words; nothing where all are kept."""
    return "; ".join(
        f"{words} is off by {checks[name]:.3g} of its scale, promised is "
        f"{getattr(promised, name):.3g}"
        for name, words in _WORDS.items()
        if name in checks and not checks[name] <= getattr(promised, name)
    )
