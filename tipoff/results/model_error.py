"""The error of the rates of one run by its model."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Range:
    """Lowest and highest values of a run and its neighbours, which have up to 1 um more or less of every
    clearance, or a tighter tolerance."""

    #: Rates about x, y, z.
    low_deg_s: tuple[float, ...]
    high_deg_s: tuple[float, ...]
    #: Velocity along x, y, z.
    low_m_s: tuple[float, ...]
    high_m_s: tuple[float, ...]
    #: Lowest and highest angle of the velocity to the x axis, and lateral velocity.
    off_axis_deg: tuple[float, float]
    across_m_s: tuple[float, float]
    #: Number of runs that have rates, and of those that have none.
    runs: int
    lost: int
    #: Rates about x, y, z of each run that has some; empty in files of version 1.0.0.
    rates_deg_s: tuple[tuple[float, ...], ...] = ()

    def within(self, measure: Callable[[Sequence[float]], float]) -> tuple[float, float]:
        """The smallest and the largest ``measure`` of the rates of a run."""
        found = [measure(rates) for rates in self.rates_deg_s]
        return min(found), max(found)


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """Estimated error of the rates of a run, at the instant that counts for it.

    It covers the model, and not the inputs: clearance, misalignment and the other values of the scene
    are taken as exact. A run that is sensitive has a range of rates instead.

    Example:
        >>> error = tipoff.run(tipoff.load("tiny").condition("phi15")).error
        >>> error.largest, round(error.rate_deg_s, 1)  # deg/s
        ('rail mesh', 0.2)
    """

    #: deg/s, largest change of the rate about any axis by each cause, by its name.
    parts_deg_s: dict[str, float] = field(default_factory=dict)
    #: Why no error is known; empty if it is.
    not_known: str = ""
    #: Rates of a sensitive run and its neighbours; None for other runs.
    range: Range | None = None

    @property
    def rate_deg_s(self) -> float | None:
        """Error (deg/s) of the rate about each axis: the root of the sum of the squares of the parts,
        whose causes are independent. None if it is not known."""
        return None if self.not_known else math.hypot(*self.parts_deg_s.values())

    @property
    def largest(self) -> str:
        """Name of the largest part; empty without parts."""
        return max(self.parts_deg_s, key=self.parts_deg_s.__getitem__, default="")

    @property
    def words(self) -> str:
        """The error, or whose range stands in its place, as text."""
        if self.range is not None:
            return (
                f"sensitive: the range is that of {self.range.runs} runs within 1 µm of clearance"
            )
        if self.rate_deg_s is None:
            return f"not known: {self.not_known}"
        return f"{self.rate_deg_s:.2g} deg/s about each axis, mostly by the {self.largest}"

    def plain(self) -> dict:
        """As in results, for JSON: the fields, ``rate_deg_s`` and ``largest``."""
        return asdict(self) | {"rate_deg_s": self.rate_deg_s, "largest": self.largest}

    @classmethod
    def of(cls, found: Mapping) -> "ModelError":
        """The error that ``plain`` wrote."""
        own: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in (found["range"] or {}).items()
        }
        own |= {"rates_deg_s": tuple(map(tuple, own.get("rates_deg_s", ())))} if own else {}
        return cls(
            parts_deg_s=found["parts_deg_s"],
            not_known=found["not_known"],
            range=Range(**own) if own else None,
        )

    def written(self) -> str:
        """JSON of ``plain``."""
        return json.dumps(self.plain(), allow_nan=False)

    @classmethod
    def read(cls, text: str | None) -> "ModelError | None":
        """The error that ``written`` returned as ``text``; None without one."""
        return None if text is None else cls.of(json.loads(text))
