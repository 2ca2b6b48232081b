"""Results of ``tipoff montecarlo``: the surrogate alone, and checked by the reference."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from tipoff.studies.populations.answers import Named
from tipoff.studies.populations.draws import Lost
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Histogram, Moments, Quantile
from tipoff.studies.render.column import Column
from validation.montecarlo.allocation import Allocation
from validation.montecarlo.control_variate import Estimate
from validation.montecarlo.options import Cases, MontecarloOptions

_MEDIAN, _MOST = Column("median error", "deg/s", ".2g"), Column("largest", "deg/s", ".2g")


@dataclass(frozen=True, kw_only=True)
class Spread(Moments):
    """Moments and quantiles of the settled cases, in the unit of the name."""

    name: str
    quantiles: tuple[Quantile, ...]


@dataclass(frozen=True, kw_only=True)
class Distribution(Named, Spread):
    """Spread of one of ``answers.ALL`` over all cases."""

    # of the paper's number of cases; None if none of these settled
    first: tuple[Quantile, ...] | None
    histogram: Histogram


@dataclass(frozen=True, kw_only=True)
class Tail(Limit):
    """Probability above a limit, with its bounds."""

    limit: Annotated[str, Column("limit")]  # in words
    above: int
    cases: int
    share: Annotated[float, Column("probability above")]
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Converging(Quantile):
    """A quantile of a rate from the first ``cases``."""

    name: str
    cases: int


@dataclass(frozen=True, kw_only=True)
class ReadingRow:
    """A reading of the paper's Table 3, compared with the reading of the study; None without enough
    settled cases."""

    reading: str
    same: bool  # whether this is the reading of the study
    cases: int
    settled: int
    distance: float | None  # of Kolmogorov and Smirnov, the largest over the rates
    chance: float | None  # probability of such a distance if both distributions are equal
    rates: tuple[Spread, ...] | None


@dataclass(frozen=True, kw_only=True)
class Difference(Named):
    """How much the surrogates differ in a quantity: quantiles of 50, 95 and 99 % of magnitudes."""

    root_mean_square: float  # in the unit of the quantity
    quantiles: tuple[Quantile, ...]  # of the difference
    most: float  # the largest difference
    springs: tuple[Quantile, ...]  # of the quantity itself
    compliant: tuple[Quantile, ...]  # of the quantity itself


@dataclass(frozen=True, kw_only=True)
class Compared:
    """Both surrogates on the same cases."""

    cases: int
    both_settled: int
    modes: int | str  # of each rail, of the surrogate that the study does not use
    modes_why: str
    quantities: tuple[Difference, ...]
    # settled rates (deg/s) by name of the rate and model
    pairs: dict[str, dict[str, tuple[float, ...]]]


@dataclass(frozen=True, kw_only=True)
class MonteCarlo(Answering):
    """The random errors on the surrogate."""

    asked: Cases
    reading: str
    store: str
    counts: dict[str, int]  # cases by status
    settled: int
    confidence: float
    paper_cases: int
    quantities: tuple[Distribution, ...]
    tails: tuple[Tail, ...]
    convergence: tuple[Converging, ...]
    readings: tuple[ReadingRow, ...]
    models: Compared | None  # None for the reason ``models_missing``
    models_missing: str


@dataclass(frozen=True, kw_only=True)
class Apart:
    """The difference of two series over draws that settled in both."""

    draws: int
    mean: float  # with its sign
    median: float  # of the magnitude
    most_95: Annotated[float, Field(alias="95")]  # 95 % quantile of the magnitude
    most: float  # the largest magnitude
    correlation: float | None  # of both series


@dataclass(frozen=True, kw_only=True)
class Errors(Named):
    """Differences from the reference; None without a draw that settled in both."""

    same_mesh: Apart | None  # the surrogate on the mesh of the reference
    population: Apart | None  # the surrogate as in the population
    mesh: Apart | None  # the reference on the coarser mesh, from the finer one
    finer: Apart | None  # the population from the reference on the finer mesh


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """Errors of draws that settled; None if none settled."""

    draws: Annotated[int, Column("draws")]
    settled: int
    median: Annotated[float | None, _MEDIAN]  # deg/s
    most: Annotated[float | None, _MOST]  # deg/s
    within_gate: float | None  # share of the settled draws; ``low`` and ``high`` are its bounds
    low: float | None
    high: float | None


@dataclass(frozen=True, kw_only=True)
class ByContacts(Agreement):
    """Agreement of draws with this number of contacts."""

    contacts: Annotated[str, Column("contacts")]


@dataclass(frozen=True, kw_only=True)
class ByRung(Agreement):
    """Agreement of single runs of the surrogate with one choice of its settings, and their cost."""

    most_95: Annotated[float | None, Column("95 % below", "deg/s", ".2g")]  # of the settled draws
    model: str
    modes: int | str  # of each rail
    degree: int | None  # of the patterns; None for that of the rail compliance
    cells: int  # along each edge of a pad
    cpu_s: Annotated[float, Column("single run", "ms", ".2g", 1e3)]
    # processor time; None if each draw chooses its modes, or a population has no such settings
    case_s: Annotated[float | None, Column("case of a population", "ms", ".2g", 1e3)]


@dataclass(frozen=True, kw_only=True)
class Ladder:
    """The draws by settings of the surrogate, and what the modes that each draw chooses change."""

    held: int  # modes of each rail in the rail compliance
    choosing: int  # how many draws choose some modes
    choosing_all: int  # how many draws choose all modes
    # largest change of a rate by the chosen modes; median over the draws that choose some
    moved_deg_s: float | None
    clearance_change_m: float
    moved_by_clearance_deg_s: float | None  # the same by ``clearance_change_m``
    more_by_clearance: int  # how many of these draws change more by the clearance
    rows: tuple[ByRung, ...]  # by modes, case by case, springs, finer settings


@dataclass(frozen=True, kw_only=True)
class Statistic(Named, Estimate):
    """A statistic of a quantity."""

    statistic: str  # in words
    share: float | None  # of a quantile
    equivalent_runs: float | None  # as in ``control_variate``


@dataclass(frozen=True, kw_only=True)
class CorrectedTail(Estimate, Limit):
    """Probability above a limit, corrected."""

    limit: Annotated[str, Column("limit")]
    above: int  # draws above the limit in the reference
    missed: Annotated[int, Column("missed")]  # of these, not above it in the surrogate
    false: Annotated[int, Column("false")]  # draws above it in the surrogate only
    equivalent_runs: float | None  # as in ``control_variate``


@dataclass(frozen=True, kw_only=True)
class Optimal(Allocation):
    """The optimal allocation of runs for the mean of a rate."""

    name: str
    correlation: float | None


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Cost of a run of each model."""

    reference_cpu_s: float  # processor time, as of the two below
    fine_cpu_s: float
    surrogate_cpu_s: float
    ratio: float  # reference to surrogate
    optimal: tuple[Optimal, ...]


@dataclass(frozen=True, kw_only=True)
class DrawnPairs:
    """The draws that settled in both models."""

    contacts: tuple[int, ...]  # number, of each draw
    rates: dict[str, dict[str, tuple[float, ...]]]  # deg/s, by name of the rate and model


@dataclass(frozen=True, kw_only=True)
class Tails(Answering):
    """The population, checked by draws of the reference."""

    asked: MontecarloOptions
    reading: str
    store: str
    cases: int
    settled: int
    draws: int
    counts: dict[str, int]
    paired: int  # draws that settled in both models
    lost: tuple[Lost, ...]
    confidence: float
    element_size_m: float
    elements: int
    fine: int  # draws on the finer mesh
    fine_element_size_m: float
    fine_elements: int
    gate_deg_s: float  # limit of the error of a settled rate
    has_contact: bool
    cost: Cost
    errors: tuple[Errors, ...]
    contacts: tuple[ByContacts, ...]
    ladder: Ladder | None  # None if the rails have no modes
    statistics: tuple[Statistic, ...]
    tails: tuple[CorrectedTail, ...]
    pairs: DrawnPairs
