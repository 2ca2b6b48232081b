"""Numerical parameters of the finite-element reference: mesh, contact cells and step."""

import math
from dataclasses import asdict, dataclass

from tipoff.scenes.units import COARSEST_ELEMENTS, FINEST_ELEMENTS
from tipoff.units import is_number, single

LEAST_CELLS = 16  # along each edge of a pad face, by default
_MOST_CELLS = 1000


@dataclass(frozen=True)
class Numerics:
    """Mesh, contact cells and step of one run. Raises ValueError outside their ranges."""

    #: Length of an edge of an element (m).
    element_size: float = 0.004
    #: Contact cells along each edge of a pad face. None means at least ``LEAST_CELLS``, with no
    #: cell longer than half a facet.
    cells: int | None = None
    #: Fraction of the critical step.
    safety: float = 0.9
    #: Requested step (s), refused above the limit. None means the critical step times ``safety``.
    step: float | None = None
    #: Whether rails at rest (``dynamics.resting``) are stepped too; there are then no long steps.
    step_everything: bool = False

    def __post_init__(self):
        for name, value in vars(self).items():  # scalars of numpy, as Python has them
            object.__setattr__(self, name, single(value))
        faults = []
        if not (
            is_number(self.element_size)
            and FINEST_ELEMENTS <= self.element_size <= COARSEST_ELEMENTS
        ):
            faults.append(
                f"element_size: given {self.element_size!r}, expected {FINEST_ELEMENTS:g} to "
                f"{COARSEST_ELEMENTS:g} (m)"
            )
        if self.cells is not None and not (
            type(self.cells) is int and 1 <= self.cells <= _MOST_CELLS
        ):
            faults.append(
                f"cells: given {self.cells!r}, expected 1 to {_MOST_CELLS} along each edge of a pad"
            )
        if not (is_number(self.safety) and 0.0 < self.safety <= 1.0):
            faults.append(
                f"safety: given {self.safety!r}, expected a fraction above 0 and at most 1"
            )
        if self.step is not None and not (is_number(self.step) and 0.0 < self.step < math.inf):
            faults.append(f"step: given {self.step!r}, expected a time above zero (s)")
        if type(self.step_everything) is not bool:
            faults.append(
                f"step_everything: given {self.step_everything!r}, expected True or False"
            )
        if faults:
            raise ValueError("; ".join(faults))

    def as_dict(self) -> dict:
        """Plain values, as written into results."""
        return asdict(self)
