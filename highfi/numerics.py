"""Numerical parameters of the finite-element reference: mesh, quadrature and step."""

import math
from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Numerics:
    """Mesh, quadrature and step of one run. Raises ValueError outside their ranges."""

    element_size: float = 0.004  # m
    # Gauss points per facet edge; None: points about 1 mm apart, between 2 and 8 per edge
    quadrature: int | None = None
    safety: float = 0.9  # fraction of the critical step
    step: float | None = None  # s, requested; refused above the limit

    def __post_init__(self):
        faults = []
        if not (math.isfinite(self.element_size) and self.element_size > 0.0):
            faults.append(
                f"element_size: given {self.element_size!r}, expected a length above zero (m)"
            )
        if self.quadrature is not None and not 1 <= self.quadrature <= 12:
            faults.append(
                f"quadrature: given {self.quadrature!r}, expected 1 to 12 points per edge"
            )
        if not 0.0 < self.safety <= 1.0:
            faults.append(
                f"safety: given {self.safety!r}, expected a fraction above 0 and at most 1"
            )
        if self.step is not None and not (math.isfinite(self.step) and self.step > 0.0):
            faults.append(f"step: given {self.step!r}, expected a time above zero (s)")
        if faults:
            raise ValueError("; ".join(faults))

    def points_per_edge(self) -> int:
        """Gauss points along one facet edge."""
        if self.quadrature is not None:
            return self.quadrature
        return min(max(round(self.element_size / 1e-3), 2), 8)

    def as_dict(self) -> dict:
        """Plain values, as written into results."""
        return asdict(self)
