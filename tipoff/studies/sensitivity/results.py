"""Result of ``tipoff sensitivity``."""

from dataclasses import dataclass
from typing import Annotated, Any

from tipoff.studies.populations.answers import Named
from tipoff.studies.populations.population import Answering
from tipoff.studies.render.column import Column
from tipoff.studies.sensitivity.contact_table import Deviations, PerturbedRun
from tipoff.studies.sensitivity.indices import Indices
from tipoff.studies.sensitivity.options import SensitivityOptions


@dataclass(frozen=True, kw_only=True)
class Constants:
    """The table of the contact ``law`` with its constants (SI); the largest deviations by a constant and
    by the clearance; the largest change of each of ``answers.ALL`` by a constant."""

    title: str
    law: str
    constants_si: dict[str, Any]
    rows: tuple[PerturbedRun, ...]
    largest: Deviations
    largest_clearance: Deviations
    most_moved: dict[str, float]
    store: str


@dataclass(frozen=True, kw_only=True)
class Varied:
    """An input of the indices: 95 % of its values are between ``low`` and ``high``; ``factor``:
    whether the distribution is of a factor of the ``nominal`` value, None if the scene has no such
    value."""

    key: Annotated[str, Column("input")]
    unit: str
    nominal: float | None
    low: float  # SI, or a factor
    high: float
    factor: bool
    distribution: str
    provenance: Annotated[str | None, Column("provenance", detail=True)]


@dataclass(frozen=True, kw_only=True)
class Step:
    """Indices of the first ``base_points``; None if the quantity does not vary there."""

    base_points: int
    first: tuple[float, ...] | None = None  # first-order indices, by input
    first_half_width: tuple[float, ...] | None = None
    total: tuple[float, ...] | None = None  # total indices, by input
    total_half_width: tuple[float, ...] | None = None
    points: int | None = None


@dataclass(frozen=True, kw_only=True)
class Shares(Named):
    """Spread of a quantity and its indices, with the half width of the 95 % interval of the sum of those
    of first order; None if it does not vary."""

    mean: float
    sd: float
    indices: Indices | None
    first_sum_half_width: float | None
    convergence: tuple[Step, ...]


@dataclass(frozen=True, kw_only=True)
class Sobol:
    """``left_out``: the reasons by key; ``used``: base points all of whose cases settled; ``cases`` by
    status."""

    inputs: tuple[Varied, ...]
    left_out: dict[str, str]
    base_points: int
    used: int
    cases: dict[str, int]
    not_settled: int
    store: str
    quantities: tuple[Shares, ...]


@dataclass(frozen=True, kw_only=True)
class Sensitivity(Answering):
    """``tables`` of the constants of the surrogate, and of the constants of the scene if a
    calibration changed them; none without contact."""

    asked: SensitivityOptions
    tables: tuple[Constants, ...]
    sobol: Sobol
