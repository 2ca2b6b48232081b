"""Result of runs: one row for each condition of a model."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from tipoff.mechanics import instant
from tipoff.results.guides import Guide
from tipoff.results.model_error import Range
from tipoff.studies.render.column import Column

Vector = tuple[float, float, float]  # along or about x, y, z


@dataclass(frozen=True, kw_only=True)
class Settled:
    """Means over the settled window."""

    velocity_m_s: Vector
    rate_deg_s: Vector
    lateral_velocity_m_s: float
    direction_error_deg: float


@dataclass(frozen=True, kw_only=True)
class AtExit:
    """Means over the window at exit, under the thrust that there is then."""

    velocity_m_s: Vector
    rate_deg_s: Vector

    @property
    def lateral_velocity_m_s(self) -> float:
        """Speed across the rail."""
        return math.hypot(*self.velocity_m_s[1:])

    @property
    def direction_error_deg(self) -> float:
        """Angle of the velocity to the X axis."""
        return math.degrees(math.atan2(self.lateral_velocity_m_s, self.velocity_m_s[0]))


@dataclass(frozen=True)
class ByHand:
    """Rates of a rigid payload from moment impulses, and the impulses that are included."""

    rate_deg_s: Vector
    words: str


def roll(rate: Sequence[float]) -> float:
    """The part of a ``rate`` (3,) about the payload's axis, with its sign."""
    return rate[0]


def transverse(rate: Sequence[float]) -> float:
    """The part of a ``rate`` (3,) across the payload's axis."""
    return math.hypot(*rate[1:])


@dataclass(frozen=True, kw_only=True)
class ConditionRun:
    """One run. ``settled`` is None if it did not settle; ``at_exit`` is None for the reason
    ``no_exit_values``; ``impulse_after_exit`` is a share, None without exit or thrust; ``advice``
    is empty unless the run ended too early; ``by_hand`` is None for the reason ``no_by_hand``;
    ``by_hand_at_exit``: of a rocket on two buttons;
    ``guides``: its buttons, or pads; ``range``: over the neighbours of a sensitive run of the surrogate, whose
    answer it is; ``rail_compliance``: its statement about its elements;
    ``trajectory``: the file in the folder of the scene. Only the reference has the fields from
    ``elements`` on; stresses are None for a run without stresses."""

    condition: Annotated[str, Column("condition")]
    model: Annotated[str, Column("model")]
    status: Annotated[str, Column("status")]
    message: str
    exit_time_s: float | None
    wall_s: Annotated[float, Column("took", "s", ".2g")]
    compile_s: float
    steps: int
    dt_s: float
    energy_error: float | None
    transverse_energy_error: float | None
    linear_momentum_error: float | None
    angular_momentum_error: float | None
    settled: Settled | None
    trajectory: str
    checks: dict[str, Any]
    cost: dict[str, Any]
    numerics: dict[str, Any]
    at_exit: AtExit | None = None
    no_exit_values: str = ""
    impulse_after_exit: float | None = None
    advice: str = ""
    thrust: dict[str, Any] | None = None  # acting forces
    rail_compliance: dict[str, Any] | None = None
    by_hand: ByHand | None = None
    no_by_hand: str = ""
    by_hand_at_exit: ByHand | None = None
    guides: tuple[Guide, ...] = ()
    range: Range | None = None
    elements: int | None = None
    ns_per_element_step: float | None = None  # of all elements, those of rails at rest included
    ns_per_element_stepped: float | None = None  # None if all rails rest all the time
    peak_stress_pa: Annotated[float | None, Column("peak von Mises", "MPa", ".3g", 1e-6)] = None
    peak_stress_place_m: Vector | None = None
    peak_stress_rail: Annotated[str | None, Column("rail")] = None
    peak_stress_time_s: Annotated[float | None, Column("at", "ms", ".4g", 1e3)] = None
    yield_strength_pa: float | None = None
    largest_strain: Annotated[float | None, Column("largest strain", "%", ".2g", 100.0)] = None
    largest_rotation_rad: float | None = None
    warnings: tuple[str, ...] = ()

    @property
    def at(self) -> str:
        """The instant that counts, by ``mechanics.instant``."""
        return instant.chosen(None, self.impulse_after_exit).at

    @property
    def taken(self) -> Settled | AtExit | None:
        """Velocity and rates at that instant; None if there are none."""
        return self.at_exit if self.at == instant.EXIT else self.settled


@dataclass(frozen=True, kw_only=True)
class Runs:
    """``failed``: a line for each run that diverged, was refused, or reached the end of the scene too
    early."""

    conditions: tuple[ConditionRun, ...]
    failed: tuple[str, ...]
