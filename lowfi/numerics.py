"""Numerical parameters of the rigid surrogate: they can be refined without a change of the
scene."""

import math
from dataclasses import dataclass, replace

from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.promises import RIGID, Promises
from tipoff.mechanics.rail_compliance import (
    DEGREE,
    LEAST_DEGREE,
    LOW_DEGREE,
    MODES,
    MOST_DEGREE,
)
from tipoff.units import is_number, single

AUTO = "auto"
_LEAST_CELLS, MOST_CELLS = 4, 100
_FEW_CELLS = 10
_TOLERANCE = 2e-7
# A relative error of 0.1 % per step gives no solution; below 1e-13 there is only rounding.
_COARSEST, _FINEST = 1e-2, 1e-13
OF_MANY = 1e-2  # tolerance of each of many cases, by default


@dataclass(frozen=True)
class Numerics:
    """Error control of one run.

    A run whose energy ledgers do not close as promised is repeated at a tenth of the tolerance. The
    promises hold at the default tolerance; at a looser, faster one they are looser in proportion
    (``promises_of``). Raises ValueError for values out of range.
    """

    #: Local error of a step, relative to the speeds of the body.
    relative_tolerance: float = _TOLERANCE
    #: Lower speeds (m/s) count as this value, the absolute tolerance over the relative one.
    speed_floor: float = 1e-3
    #: A run that needs more steps fails.
    maximum_steps: int = 500_000
    #: Number of the lowest modes of each rail that vibrate on compliant contact. 0 means rails
    #: without inertia, ``"auto"`` as many modes as matter to the run (``lowfi.modes``).
    modes: int | str = AUTO
    #: Degree of the patterns of pressure and displacement on a pad face. None means that of the rail
    #: compliance, which may have a higher one: ``tipoff.compliance(scene, degree=5)``. ``"auto"`` means
    #: the least one whose next would hardly change the run (``lowfi.degrees``).
    degree: int | str | None = None
    #: Contact cells along each edge of a pad face on compliant contact; 16, as in the reference.
    cells: int = 16

    def __post_init__(self):
        for name, value in vars(self).items():  # scalars of numpy, as Python has them
            object.__setattr__(self, name, single(value))
        faults = []
        if not (
            is_number(self.relative_tolerance) and _FINEST <= self.relative_tolerance <= _COARSEST
        ):
            faults.append(
                f"relative_tolerance: given {self.relative_tolerance!r}, expected {_FINEST:g} to "
                f"{_COARSEST:g}"
            )
        if not (is_number(self.speed_floor) and 0.0 < self.speed_floor < math.inf):
            faults.append(
                f"speed_floor: given {self.speed_floor!r}, expected a speed above zero (m/s)"
            )
        if not (type(self.maximum_steps) is int and 0 < self.maximum_steps < 2**63):
            faults.append(
                f"maximum_steps: given {self.maximum_steps!r}, expected a whole number above zero"
            )
        is_auto = isinstance(self.modes, str) and self.modes == AUTO
        if not is_auto and not (type(self.modes) is int and 0 <= self.modes <= MODES):
            faults.append(
                f"modes: given {self.modes!r}, expected a whole number from 0 to {MODES}, or "
                f"{AUTO!r}"
            )
        is_degree = type(self.degree) is int and LEAST_DEGREE <= self.degree <= MOST_DEGREE
        if self.degree not in (None, AUTO) and not is_degree:
            faults.append(
                f"degree: given {self.degree!r}, expected a whole number from {LEAST_DEGREE} to "
                f"{MOST_DEGREE}, or {AUTO!r}"
            )
        if not (type(self.cells) is int and _LEAST_CELLS <= self.cells <= MOST_CELLS):
            faults.append(
                f"cells: given {self.cells!r}, expected {_LEAST_CELLS} to {MOST_CELLS} along each "
                f"edge of a pad"
            )
        if faults:
            raise ValueError("; ".join(faults))

    @property
    def needed_degree(self) -> int:
        """Degree of the rail compliance that a run computes for itself."""
        if isinstance(self.degree, str):
            return MOST_DEGREE
        return max(self.degree or DEGREE, DEGREE)

    @property
    def known_degree(self) -> int | None:
        """The ``degree`` if it is a number."""
        return self.degree if isinstance(self.degree, int) else None

    @property
    def count(self) -> int:
        """The number of ``modes``; 0 if they are not chosen yet."""
        return self.modes if isinstance(self.modes, int) else 0

    @classmethod
    def of_many(
        cls, relative_tolerance: float = OF_MANY, modes: int | str = AUTO, model: str = COMPLIANT
    ) -> "Numerics":
        """Numerics of each of many cases of a ``model``: at a tolerance above the default, compliant
        contact has fewer cells and patterns, whose errors are in docs/howto/ensembles.md. Raises
        ValueError for values out of range."""
        made = cls(relative_tolerance=relative_tolerance, modes=modes)
        if relative_tolerance <= _TOLERANCE or model != COMPLIANT:
            return made
        return replace(made, cells=_FEW_CELLS, degree=LOW_DEGREE)

    def tightened(self) -> "Numerics":
        """These numerics with a tenth of the tolerance, or with the finest tolerance."""
        return replace(self, relative_tolerance=max(0.1 * self.relative_tolerance, _FINEST))

    def accurate(self) -> "Numerics":
        """These numerics at the default tolerance, or at their own if that is tighter."""
        tolerance = min(self.relative_tolerance, _TOLERANCE)
        return replace(self, relative_tolerance=tolerance)

    def as_dict(self) -> dict:
        """Plain values, as written into results."""
        return dict(vars(self))


def promises_of(numerics: Numerics) -> Promises:
    """Promises of a run with these ``numerics``."""
    return RIGID.loosened(numerics.relative_tolerance / _TOLERANCE)
