"""Ranges of the settled rates over neighbours of a condition, for the first screen of the page.

Where a condition is judged as a distribution, its reference is not converged or 1 um moves it. A value
with an uncertainty larger than itself says nothing there; the range over the neighbours that the
agreement study ran does (``agreement.neighbours``).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

NOTE = (
    "A range in place of a value: from the smallest to the largest settled rate of the same launch with "
    "payload and walls moved by less than 1 µm, by finite elements on the coarse mesh."
)


class Spread(NamedTuple):
    """Settled rates (n,3) deg/s of the neighbours of one condition."""

    rates_deg_s: list[list[float]]

    @property
    def settled(self) -> int:
        """How many neighbours settled."""
        return len(self.rates_deg_s)

    def within(self, measure: Callable[[Sequence[float]], float]) -> tuple[float, float]:
        """The smallest and the largest ``measure`` of the rates."""
        found = [measure(rates) for rates in self.rates_deg_s]
        return min(found), max(found)


def of(agreement: dict | None) -> dict[str, Spread]:
    """The spreads by condition that an ``agreement`` result has; none without two settled
    neighbours."""
    items = (agreement or {}).get("distributions", [])
    found = {item["condition"]: Spread(item["reference_deg_s"]) for item in items}
    return {name: spread for name, spread in found.items() if spread.settled > 1}
