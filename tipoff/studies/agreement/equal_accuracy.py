"""The mesh for the speed-up at equal accuracy: the coarsest one whose uncertainty is below the
error of the surrogate.

With settled rates r, over all axes, and U the uncertainty of the finest mesh from the three finest
(``studies.convergence``)::

    error of the surrogate           e    = max |r - r_finest|
    uncertainty of a mesh of size h  u(h) = max (U + |r_h - r_finest|)

A finer mesh makes the reference slower without need; a coarser one cannot resolve the error of the
surrogate. If even the finest mesh is not sufficient, its speed-up is a lower bound.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from tipoff.workspace.timing import Speedup


@dataclass(frozen=True, kw_only=True)
class EqualAccuracy(Speedup):
    """A speed-up over the chosen mesh. ``error_deg_s``: error of the surrogate. ``surer``: whether
    the uncertainty of the mesh is below this error."""

    error_deg_s: float
    element_size_m: float
    mesh_uncertainty_deg_s: float
    surer: bool

    def short(self) -> str:
        """The ratio with both times, without a full stop."""
        return (
            f"At equal accuracy on {self.condition} the ratio is {'' if self.surer else 'at least '}"
            f"{self.ratio:,.0f}: {self.highfi_wall_s:.3g} s with elements of "
            f"{1e3 * self.element_size_m:g} mm against {1e3 * self.lowfi_wall_s:.3g} ms"
        )

    def sentence(self) -> str:
        """The speed-up at equal accuracy, without a full stop."""
        size = f"{1e3 * self.element_size_m:g} mm"
        mesh = (
            f"{size} is the coarsest mesh with a smaller uncertainty"
            if self.surer
            else f"no mesh down to {size} has a smaller uncertainty"
        )
        return (
            f"speed-up at equal accuracy on {self.condition}: {'' if self.surer else 'at least '}"
            f"{self.ratio:,.0f} times ({self.low:,.0f} to {self.high:,.0f} over repeats): "
            f"{self.highfi_wall_s:.3g} s with the reference, {1e3 * self.lowfi_wall_s:.3g} ms with "
            f"compliant contact. The error of compliant contact is {self.error_deg_s:.2g} deg/s from "
            f"the finest mesh; {mesh} ({self.mesh_uncertainty_deg_s:.2g} deg/s, without "
            "interface stiffness and contact cells)"
        )


def uncertainties(
    rates: Sequence[tuple[Sequence[float | None], float | None]],
) -> list[float] | None:
    """u(h) in deg/s of every mesh, coarsest first; None if unknown. Each of ``rates`` is one axis:
    its values (deg/s) by mesh, and the uncertainty (deg/s) of the last value."""
    by_axis = []
    for values, uncertainty in rates:
        known = [value for value in values if value is not None]
        if uncertainty is None or len(known) < len(values):
            return None
        by_axis.append([uncertainty + abs(value - known[-1]) for value in known])
    return [max(found) for found in zip(*by_axis)]


def coarsest(
    sizes: Sequence[float], uncertainty: Sequence[float], error: float
) -> tuple[float, float]:
    """Size (m) and uncertainty (deg/s) of the first mesh with an ``uncertainty`` below ``error``
    (deg/s), or of the last mesh; ``sizes`` fall."""
    meshes = list(zip(sizes, uncertainty))
    return next((mesh for mesh in meshes if mesh[1] < error), meshes[-1])
