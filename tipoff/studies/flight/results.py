"""Result of flights. ``summary`` has the names of the quantities of a flight,
``studies.populations.answers`` those of the state at the exit."""

from dataclasses import dataclass

from tipoff.scenes.uncertainty import Varied
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Quantile

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """The requested flight. ``no_clearance``: why no clearance is computed, empty if it is
    computed; ``rails_listed``: the rails count only if ``flight.envelope`` lists them."""

    mean_motion_rad_s: float
    period_s: float
    duration_s: float
    range_m: float
    launch_axis: Vector
    no_clearance: str
    rails_listed: bool
    pointing_limit_deg: float | None


@dataclass(frozen=True)
class Condition:
    """A condition and its quantities by name. None: a value that does not exist, an event that does
    not occur, or ``flown`` of a payload that did not settle."""

    condition: str
    status: str
    flown: dict[str, float | None] | None


@dataclass(frozen=True, kw_only=True)
class Curves:
    """Curves of one condition. ``axis_deg``: direction of the payload's x axis during one round
    about its angular momentum, as its angle from the launch axis along scene y and z; also at the
    target. Pointing error and path, in scene axes that rotate with the orbit, at ``time_s``; path
    in orbit axes relative to the platform; clearance, empty without boxes."""

    condition: str
    axis_deg: tuple[tuple[float, float], ...]
    axis_at_target_deg: tuple[float, float]
    time_s: tuple[float, ...]
    pointing_deg: tuple[float, ...]
    to_target_m: tuple[Vector, ...]
    orbit_m: tuple[Vector, ...]
    clearance_s: tuple[float, ...]
    clearance_m: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Share:
    """Number of cases with an event, and the bounds of their share (Clopper and Pearson); None if
    the cases are not independent."""

    count: int
    of: int
    share: float
    low: float | None
    high: float | None


@dataclass(frozen=True, kw_only=True)
class ManyFlights:
    """Many cases: numbers; quantiles by quantity and the method of their ``bounds``; cases that do
    not show whether the pointing limit is reached, that ``touch`` the platform again, and that
    never reach the target (None if not known for any case); points (y, z, and without errors) for
    the figure."""

    counts: dict[str, int]
    settled: int
    store: str
    confidence: float
    varied: Varied
    bounds: str
    quantiles: dict[str, tuple[Quantile, ...]]
    limit_open: int
    touch: Share | None
    not_reached: Share | None
    points_m: tuple[tuple[float, float, float, float], ...]


@dataclass(frozen=True, kw_only=True)
class Flight(Answering):
    """Flights of all conditions and of many cases of a ``scene``; ``errors``: the file of distributions of
    the cases, or its name in the catalogue; ``sizes``: 95 % of the values of each tolerance
    (``scenes.halving``); ``data``: the file of all values."""

    scene: str
    errors: str
    sizes: dict[str, str]
    flight: Orbit
    conditions: tuple[Condition, ...]
    curves: list[Curves]  # a list does not go to a CSV file
    cases: ManyFlights
    data: str
