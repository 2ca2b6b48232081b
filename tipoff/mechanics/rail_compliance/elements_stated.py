"""Statements of a rail compliance on its elements: their size, and the resulting uncertainty."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

_FINDING = threading.Lock()
COARSE = 0.1  # uncertainty by the elements above which finer ones are advised


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Elements:
    """Elements of the statics (``highfi.discretisation``). They change no run."""

    element_size: float | None = None  # m, None if unknown
    # (f,) relative uncertainty of the compliance under each face, None for the reason not_known
    uncertainty: np.ndarray | None = None
    frequency_uncertainty: float | None = None  # relative, of the lowest mode; None likewise
    not_known: str = ""
    # Computes these three, for a compliance without them.
    find_uncertainty: Callable[[], dict[str, Any]] | None = None

    def known(self) -> Self:
        """The same with its uncertainty, which the first call computes if it has ``find_uncertainty``: a run
        needs none, and its error does."""
        with _FINDING:  # threads share a compliance
            return self._known

    def finding_uncertainty(self, find: Callable[[], dict[str, Any]]) -> None:
        """From now on ``known`` calls ``find``."""
        object.__setattr__(self, "find_uncertainty", find)

    @cached_property
    def _known(self) -> Self:
        if self.find_uncertainty is None:
            return self
        return replace(self, **self.find_uncertainty(), find_uncertainty=None)

    @property
    def is_coarse(self) -> bool:
        """Whether the uncertainty of any face is above ``COARSE``."""
        return self.uncertainty is not None and bool(self.uncertainty.max() > COARSE)

    def stated(self) -> dict | None:
        """As in results, with its uncertainty: ``element_size_m``; the largest ``uncertainty`` of any face and
        ``frequency_uncertainty``, None for the reason ``not_known``; ``words``. None if the
        elements are unknown."""
        if self.element_size is None:
            return None
        own = self.known()
        return {
            "element_size_m": own.element_size,
            "uncertainty": None if own.uncertainty is None else float(own.uncertainty.max()),
            "frequency_uncertainty": own.frequency_uncertainty,
            "not_known": own.not_known,
            "words": own.accuracy(),
        }

    def accuracy(self) -> str:
        """Text on the elements and their uncertainty; empty if they are unknown."""
        if self.element_size is None:
            return ""
        size = 1e3 * self.element_size
        words = f"rail compliance at {size:.3g} mm elements: uncertainty "
        if self.uncertainty is None or self.frequency_uncertainty is None:
            return f"{words}not known: {self.not_known}"
        words += (
            f"{100.0 * self.uncertainty.max():.2g} % (from {size:.3g} and {0.5 * size:.3g} mm), that "
            f"of the lowest frequency {100.0 * self.frequency_uncertainty:.2g} %"
        )
        if not self.is_coarse:
            return words
        return f"{words}; above {100.0 * COARSE:g} %: tipoff convergence shows what finer elements change"
