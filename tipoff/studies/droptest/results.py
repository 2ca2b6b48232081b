"""Result of drop tests: each test, its place among the simulated cases, and the power of that comparison.
Rates are in deg/s, in payload body axes."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.scenes.uncertainty import Varied
from tipoff.studies.droptest.options import Options
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
class Row(Standing, Measured):
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
class Cases:
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
    """Drop tests compared with cases."""

    simulated_logs: bool
    tests: tuple[Row, ...]
    together: Together
    regions: tuple[Region, ...]
    power: tuple[Power, ...]
    cases: Cases


@dataclass(frozen=True, kw_only=True)
class Droptest(Compared, Answering):
    """The result of the study of a ``scene``; ``errors``: the file of distributions of the cases, or its
    name in the catalogue; ``data``: the file of all signals."""

    scene: str
    request: Options
    errors: str
    varied: Varied
    data: str
