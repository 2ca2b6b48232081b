"""Results of ``tipoff montecarlo``: of the surrogate alone, and checked by the reference."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from tipoff.studies.montecarlo.options import Cases, Options
from tipoff.studies.populations.allocation import Allocation
from tipoff.studies.populations.answers import Named
from tipoff.studies.populations.control_variate import Estimate
from tipoff.studies.populations.draws import Lost
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Histogram, Moments, Quantile
from tipoff.studies.render.column import Column

_MEDIAN, _MOST = Column("median error", "deg/s", ".2g"), Column("largest", "deg/s", ".2g")


@dataclass(frozen=True, kw_only=True)
class Spread(Moments):
    """Moments and quantiles of the settled cases, in the unit of the name."""

    name: str
    quantiles: tuple[Quantile, ...]


@dataclass(frozen=True, kw_only=True)
class Distribution(Named, Spread):
    """Those of one of ``answers.ALL``; ``first``: quantiles of the paper's number of cases, None where none
    of these settled."""

    first: tuple[Quantile, ...] | None
    histogram: Histogram


@dataclass(frozen=True, kw_only=True)
class Tail(Limit):
    """Probability above a limit, with bounds; ``limit``: the same in words."""

    limit: Annotated[str, Column("limit")]
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
    """A reading, compared with that of the study, which it may be the ``same`` as; None without enough
    settled cases."""

    reading: str
    same: bool
    cases: int
    settled: int
    distance: float | None
    chance: float | None
    rates: tuple[Spread, ...] | None


@dataclass(frozen=True, kw_only=True)
class Difference(Named):
    """The magnitude of the difference of both surrogates in a quantity, and that of each surrogate:
    quantiles of 50, 95 and 99 %."""

    root_mean_square: float
    quantiles: tuple[Quantile, ...]
    most: float
    springs: tuple[Quantile, ...]
    compliant: tuple[Quantile, ...]


@dataclass(frozen=True, kw_only=True)
class Compared:
    """Both surrogates on the same ``cases``; ``modes`` of the other one than that of the study; ``pairs`` of
    rates by name and model."""

    cases: int
    both_settled: int
    modes: int | str
    modes_why: str
    quantities: tuple[Difference, ...]
    pairs: dict[str, dict[str, tuple[float, ...]]]


@dataclass(frozen=True, kw_only=True)
class MonteCarlo(Answering):
    """``models``: None where ``models_missing`` says why."""

    asked: Cases
    reading: str
    store: str
    counts: dict[str, int]
    settled: int
    confidence: float
    paper_cases: int
    quantities: tuple[Distribution, ...]
    tails: tuple[Tail, ...]
    convergence: tuple[Converging, ...]
    readings: tuple[ReadingRow, ...]
    models: Compared | None
    models_missing: str


@dataclass(frozen=True, kw_only=True)
class Apart:
    """The difference of two series over draws that settled in both: its mean, and quantiles of its
    magnitude."""

    draws: int
    mean: float
    median: float
    most_95: Annotated[float, Field(alias="95")]
    most: float
    correlation: float | None


@dataclass(frozen=True, kw_only=True)
class Errors(Named):
    """Differences from the reference: of the surrogate on the ``same_mesh``, of the ``population``
    that is studied, of the reference on the finer mesh, ``mesh``, and of the population from that,
    ``finer``. None without a draw that settled in both."""

    same_mesh: Apart | None
    population: Apart | None
    mesh: Apart | None
    finer: Apart | None


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """Median and largest error (deg/s) of draws that settled, and their share within the gate with its
    bounds; None where none settled."""

    draws: Annotated[int, Column("draws")]
    settled: int
    median: Annotated[float | None, _MEDIAN]
    most: Annotated[float | None, _MOST]
    within_gate: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, kw_only=True)
class ByContacts(Agreement):
    """That of draws with this number of ``contacts``."""

    contacts: Annotated[str, Column("contacts")]


@dataclass(frozen=True, kw_only=True)
class ByModes(Agreement):
    """That with these ``modes`` of each rail; processor seconds of a single run, and of a case of a
    population, None where each draw chooses."""

    modes: int | str
    cpu_s: Annotated[float, Column("single run", "ms", ".2g", 1e3)]
    case_s: Annotated[float | None, Column("case of a population", "ms", ".2g", 1e3)]


@dataclass(frozen=True, kw_only=True)
class OwnModes:
    """The draws by rail modes, with one number in every draw and, last, with those that each draw chooses.
    ``choosing``: how many draws choose some modes, ``choosing_all`` those that the rails have, ``held``.
    ``moved_deg_s``: largest change of a rate by the chosen modes, median over the draws that choose
    some; ``moved_by_clearance_deg_s``: the same by ``clearance_change_m``; ``more_by_clearance``:
    how many of these draws the clearance moves more."""

    held: int
    choosing: int
    choosing_all: int
    moved_deg_s: float | None
    clearance_change_m: float
    moved_by_clearance_deg_s: float | None
    more_by_clearance: int
    rows: tuple[ByModes, ...]


@dataclass(frozen=True, kw_only=True)
class Statistic(Named, Estimate):
    """A ``statistic`` of a quantity, in words; ``share`` of a quantile; ``equivalent_runs`` as in
    ``control_variate``."""

    statistic: str
    share: float | None
    equivalent_runs: float | None


@dataclass(frozen=True, kw_only=True)
class CorrectedTail(Estimate, Limit):
    """Probability above a limit; draws above it in the reference, of which the surrogate ``missed`` some;
    ``false``: the other way round."""

    limit: Annotated[str, Column("limit")]
    above: int
    missed: Annotated[int, Column("missed")]
    false: Annotated[int, Column("false")]
    equivalent_runs: float | None


@dataclass(frozen=True, kw_only=True)
class Optimal(Allocation):
    """The optimal allocation of runs for the mean of a rate."""

    name: str
    correlation: float | None


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Processor seconds of a run of each model, and their ``ratio``."""

    reference_cpu_s: float
    fine_cpu_s: float
    surrogate_cpu_s: float
    ratio: float
    optimal: tuple[Optimal, ...]


@dataclass(frozen=True, kw_only=True)
class DrawnPairs:
    """``rates`` (deg/s) by name and model, and the contacts of every draw that settled in both."""

    contacts: tuple[int, ...]
    rates: dict[str, dict[str, tuple[float, ...]]]


@dataclass(frozen=True, kw_only=True)
class Tails(Answering):
    """The population checked by ``draws``; ``fine`` of them on the finer mesh; ``paired``: those that settled
    in both models; ``gate_deg_s``: limit of the error of a settled rate; ``own_modes``: None where the
    rails have none."""

    asked: Options
    reading: str
    store: str
    cases: int
    settled: int
    draws: int
    counts: dict[str, int]
    paired: int
    lost: tuple[Lost, ...]
    confidence: float
    element_size_m: float
    elements: int
    fine: int
    fine_element_size_m: float
    fine_elements: int
    gate_deg_s: float
    has_contact: bool
    cost: Cost
    errors: tuple[Errors, ...]
    contacts: tuple[ByContacts, ...]
    own_modes: OwnModes | None
    statistics: tuple[Statistic, ...]
    tails: tuple[CorrectedTail, ...]
    pairs: DrawnPairs
