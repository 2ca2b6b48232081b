"""Keys and results of every thrust over time."""

from typing import TYPE_CHECKING, Literal

from tipoff.mechanics.laws.thrust import Thrust, impulse, peak
from tipoff.scenes.table import Table
from tipoff.scenes.units import PositiveLength


class TimedTable(Table):
    """Keys of every kind: ``arm`` (m), distance of the point of application behind the nominal mass
    centre; ``reaction``."""

    #: Distance of the point of application behind the nominal mass centre.
    arm: PositiveLength = 0.1
    #: "platform": the reaction acts on the platform; "exhaust": it leaves with the gas.
    reaction: Literal["platform", "exhaust"] = "platform"
    if TYPE_CHECKING:
        kind: str  # a literal in each kind, at the place of its key

    def record(self) -> Thrust:
        """Kernel record."""
        raise NotImplementedError

    def contents(self) -> tuple[dict, list[list[float]]]:
        """The table without paths, and the points of its file, for the hash of a scene."""
        return self.model_dump(mode="json"), []

    def middle(self) -> tuple[float, float]:
        """Place (m) of the line of action along Y and Z, without errors."""
        return (0.0, 0.0)

    def requested(self) -> float:
        """Impulse (N s) of the table."""
        raise NotImplementedError

    def describe(self, duration: float) -> dict[str, float | str]:
        """The thrust for results and report: numbers in SI by name, and a sentence, ``text``.

        ``impulse_requested_Ns`` is the impulse of the table, ``impulse_delivered_Ns`` the one within
        0..``duration`` (s).
        """
        record = self.record()
        requested, delivered = self.requested(), impulse(record, duration)
        text = (
            f"{self.kind}, {self.usage()}; impulse requested {requested:.7g} N s, delivered in the "
            f"scene {delivered:.7g} N s"
        )
        return {
            "kind": self.kind,
            "peak_N": peak(record, duration),
            "impulse_requested_Ns": requested,
            "impulse_delivered_Ns": delivered,
            **self.details(),
            "text": text,
        }

    def usage(self) -> str:
        """Text on how the table becomes F(t)."""
        return "used as given"

    def details(self) -> dict[str, float | str]:
        """Additions of this kind to ``describe``."""
        return {}
