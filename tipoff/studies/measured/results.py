"""Result of measured logs. Drop tests: each test, its place among the simulated cases, and the power of that
comparison. Launches: each quantity beside its predicted range. Rates are in deg/s, in payload body axes."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.scenes.uncertainty import Varied
from tipoff.studies.measured.options import MeasuredOptions
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Quantile
from tipoff.studies.render.column import Column

Vector = tuple[float, float, float]  # about x, y, z
Span = tuple[float, float]  # first and last instant, s of the log


@dataclass(frozen=True, kw_only=True)
class Magnitude:
    """The rank of a magnitude, which does not depend on the angle about X; ``p`` is two-sided."""

    value_deg_s: float
    percentile: float
    p: float


@dataclass(frozen=True, kw_only=True)
class Standing:
    """A test among the cases: by component, by the ``distance`` of all three, and by roll, transverse
    and total magnitude."""

    percentile: Vector
    p: Vector  # two-sided
    p_distance: float
    magnitudes: dict[str, Magnitude]


@dataclass(frozen=True)
class Curve:
    """Filtered rates over the time after ignition, thinned."""

    time_s: tuple[float, ...]
    rate_deg_s: tuple[Vector, ...]


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A drop test. ``windows_s`` by name; ``instant_s`` of the settled rate; ``rest_deg_s``:
    largest rate in the window at rest, and whether it is within its limit; ``budget_deg_s``:
    standard uncertainties by name; noise of one sample, and its correlation time in samples;
    ``notes``: what was repaired, assumed or left out."""

    test: str
    simulated: bool
    description: str
    notes: tuple[str, ...]
    channel_class: Annotated[int | None, Column("CFC", "Hz", "g")]
    interval_s: float
    release_s: Annotated[float, Column("release", "s", ".4f")]
    ignition_s: Annotated[float, Column("ignition", "s", ".4f")]
    events_given: bool
    windows_s: dict[str, Span]
    instant_s: float
    rest_deg_s: float
    rest_limit_deg_s: float
    rest_kept: bool
    before_deg_s: Vector
    after_deg_s: Vector
    change_deg_s: Vector
    standard_uncertainty_deg_s: Vector
    coverage_factor: Vector
    expanded_uncertainty_deg_s: Vector
    coverage: float  # probability of the expanded uncertainty
    budget_deg_s: dict[str, Vector]
    noise_deg_s: Vector
    correlation_samples: float
    curve: Curve


@dataclass(frozen=True, kw_only=True)
class JudgedTest(Standing, Measured):
    """A drop test and its place; whether each component is inside the range of the cases."""

    inside_range: tuple[bool, bool, bool]


@dataclass(frozen=True, kw_only=True)
class Together:
    """p of all tests by distance and by spread, and twice the smaller."""

    p_distance: float  # Fisher's combined p
    p_spread: float
    p: float
    smallest_p: float  # smallest possible with this number of cases
    inside_range: bool


@dataclass(frozen=True, kw_only=True)
class Region:
    """Ellipse that contains the next case with the probability ``share``: squared Mahalanobis radius,
    None where there are too few cases for one."""

    components: tuple[str, str]
    share: float  # probability that the next case is inside
    centre_deg_s: tuple[float, float]
    covariance: tuple[tuple[float, float], tuple[float, float]]  # (deg/s)^2
    squared_radius: float | None


_SHARE = {"unit": "%", "form": ".2f", "scale": 100.0}


@dataclass(frozen=True, kw_only=True)
class Power:
    """How often a model that is ``factor`` times as wide as the truth passes."""

    factor: Annotated[float, Column("spread of the model over the truth")]
    passes_one_axis: Annotated[float, Column("inside the range, one axis", **_SHARE)]
    passes_three_axes: Annotated[float, Column("inside the range, three axes", **_SHARE)]
    passes_in_cloud: Annotated[float | None, Column("inside the range, this cloud", **_SHARE)]
    flagged_by_spread: Annotated[float, Column("rejected by the spread", **_SHARE)]
    flagged_in_cloud: Annotated[float, Column("rejected by the spread, this cloud", **_SHARE)]


@dataclass(frozen=True, kw_only=True)
class SimulatedCases:
    """The simulated cases: their numbers, quantiles of ``answers.ALL`` by name, the first rates."""

    asked: int
    ok: int
    refused: int
    failed: int
    settled: int
    quantiles: dict[str, tuple[Quantile, ...]]
    store: str
    shown_deg_s: tuple[Vector, ...]


@dataclass(frozen=True, kw_only=True)
class Compared:
    """Drop tests compared with cases; empty without a drop test."""

    simulated_logs: bool
    tests: tuple[JudgedTest, ...] = ()
    together: Together | None = None
    regions: tuple[Region, ...] = ()
    power: tuple[Power, ...] = ()
    cases: SimulatedCases | None = None


@dataclass(frozen=True)
class Band:
    """Rates over the time after the start: measured, and the 95 % range of the cases without noise, thinned."""

    time_s: tuple[float, ...]
    rate_deg_s: tuple[Vector, ...]
    low_deg_s: tuple[Vector, ...]
    high_deg_s: tuple[Vector, ...]


@dataclass(frozen=True, kw_only=True)
class Launch:
    """A launch. ``start_s`` of the log; ``exit_s``: from the start, with its standard uncertainty in the log;
    specific force at rest along the rail, and that of the scene; budgets: standard uncertainties by name, of the
    instant, the time and the speed of the exit, and of the rates; the numbers of cases, and of those without
    an exit; ``thrust``: file of the thrust less friction of this log."""

    test: str
    simulated: bool
    description: str
    notes: tuple[str, ...]
    interval_s: float
    start_s: Annotated[float, Column("start in the log", "s", ".4f")]
    exit_by: Annotated[str, Column("exit by")]
    exit_s: Annotated[float, Column("exit after the start", "s", ".4f")]
    exit_uncertainty_s: float
    at_rest_m_s2: Annotated[float, Column("force at rest along the rail", "m/s2", ".3f")]
    gravity_m_s2: Annotated[float, Column("gravity of the scene", "m/s2", ".3f")]
    exit_budget: dict[str, tuple[float, float, float]]
    rate_budget_deg_s: dict[str, Vector]
    cases: int
    lost: int
    thrust: str
    band: Band


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """A quantity of a launch beside the predicted range of 95 %, errors of measurement included, and the share of
    cases below it; ``expanded``: half width that contains the true value with 95 % probability, None where
    the noise is in the predictions."""

    test: str
    quantity: str
    unit: str
    measured: float
    expanded: float | None
    low: float
    median: float
    high: float
    share_below: Annotated[float, Column("share below", form=".3f")]
    inside: bool


@dataclass(frozen=True, kw_only=True)
class Measurements(Compared, Answering):
    """The result of the study of a ``scene``; ``errors``: the file of distributions of the cases, or its
    name in the catalogue; ``sizes``: 95 % of the values of each tolerance (``scenes.halving``); ``data``: the
    file of all signals of drop tests, None without any."""

    scene: str
    request: MeasuredOptions
    errors: str
    sizes: dict[str, str]
    varied: Varied
    data: str | None
    launches: tuple[Launch, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
