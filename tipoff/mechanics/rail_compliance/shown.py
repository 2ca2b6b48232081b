"""A rail compliance as text and pictures: one line, a summary, a card, a plot, a table."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tipoff.cards import Carded
from tipoff.files import write_csv
from tipoff.mechanics.rail_compliance.elements_stated import Elements

if TYPE_CHECKING:
    from tipoff.plots import Figure


class Shown(Elements, Carded):
    """Base of ``mechanics.rail_compliance.RailCompliance``, whose fields it shows."""

    travel: np.ndarray
    flexibility: np.ndarray | None
    rail: np.ndarray
    frequency: np.ndarray

    def compliance(self) -> np.ndarray:
        """Mean displacement (s,f,f) m/N of each face under a unit force on each."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"RailCompliance({', '.join(self._facts().values())})"

    def _facts(self) -> dict[str, str]:
        modes = f"{self.frequency.shape[-1]} modes"
        if self.frequency.size:
            modes += f" of each rail from {self.frequency.min() / (2.0 * np.pi):.4g} Hz"
        rigid = self.flexibility is None
        return {
            "compliance": "rigid" if rigid else f"up to {1e9 * self.compliance().max():.3g} nm/N",
            "stations": f"{self.travel.size} stations over {1e3 * np.ptp(self.travel):.4g} mm",
            "faces": f"{self.rail.size} faces",
            "modes": modes,
        } | ({"elements": size} if (size := self._elements()) else {})

    def _elements(self) -> str:
        if self.element_size is None:
            return ""
        size = f"{1e3 * self.element_size:.3g} mm elements"
        if self.uncertainty is None:
            return size
        return f"{size}, uncertain by {100.0 * self.uncertainty.max():.2g} %"

    def plot(self, axes: Any = None) -> "Figure":
        """Draw the compliance (nm/N) of each pad face over the travel of the payload (mm).

        It is the mean displacement of the wall under a face for a force of 1 N spread evenly over
        this face.

        Args:
            axes: matplotlib axes to draw in; a new figure by default.

        Returns:
            Figure: the figure. pyplot does not know a new one; a notebook shows it.

        Raises:
            ValueError: for rigid walls.

        Example:
            >>> figure = tipoff.compliance(tipoff.load("tiny"), 8e-3).plot()
            >>> figure.axes[0].get_ylabel()
            'compliance (nm/N)'
        """
        from tipoff import plots  # slow to load

        curves = [(f"face {face}", 1e9 * own) for face, own in enumerate(self._own().T)]
        across = ("travel of the payload (mm)", 1e3 * self.travel)
        return plots.lines(across, "compliance (nm/N)", curves, axes=axes)

    def to_csv(self, path: str | Path) -> None:
        """Write the table that ``plot`` draws, atomically: the travel (m), and the compliance (m/N)
        of each face.

        Args:
            path: file to write.

        Raises:
            ValueError: for rigid walls.

        Example:
            >>> tipoff.compliance(tipoff.load("tiny"), 8e-3).to_csv("compliance.csv")
            >>> open("compliance.csv").readline()[:31]
            'travel [m],compliance_0 [m/N],c'
        """
        columns = {"travel [m]": self.travel}
        columns |= {f"compliance_{face} [m/N]": own for face, own in enumerate(self._own().T)}
        write_csv(path, columns)

    def _own(self) -> np.ndarray:
        """Compliance (s,f) m/N of each face under its own force. Raises ValueError for rigid
        walls."""
        if self.flexibility is None:
            raise ValueError("flexibility: rigid walls have none")
        return np.einsum("sff->sf", self.compliance())
