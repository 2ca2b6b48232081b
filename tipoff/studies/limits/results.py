"""Result of ``tipoff limits``."""

from dataclasses import dataclass

from tipoff.studies.limits.certificate import Certificate
from tipoff.studies.limits.constants import Margin
from tipoff.studies.limits.options import Options
from tipoff.studies.limits.search import Found
from tipoff.studies.populations.answers import Named
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Quantile


@dataclass(frozen=True, kw_only=True)
class Advised:
    """Cases above a limit at the ``tolerance`` that the paper advises, with bounds of their share."""

    tolerance: float  # in the unit of the row
    above: int
    share: float
    low: float
    high: float
    certified: bool


@dataclass(frozen=True, kw_only=True)
class Magnitude(Named, Quantile):
    """The magnitude that a quantity of ``answers.ALL`` stays below."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A factor with tolerances in its ``unit``, searched up to ``most``: ``nominal``, with nominal
    constants; with each draw of the ``constants``; with limits less the error of the ``model``; with
    ``both``, the worst draw and these limits. ``beside``: quantities at the certified tolerance. None
    where there is nothing to search, and without advice."""

    name: str
    words: str
    unit: str
    most: float
    nominal: Found
    advised: Advised | None
    constants: tuple[Found, ...] | None = None
    model: Found | None = None
    both: Found | None = None
    beside: tuple[Magnitude, ...] | None = None


@dataclass(frozen=True)
class Pair:
    """Certified tolerances of both factors of a map, on one ray."""

    tolerances: tuple[float, float]
    state: str


@dataclass(frozen=True, kw_only=True)
class Map:
    """Certified pairs of two factors, in their ``units``, and the pair that the paper advises."""

    names: tuple[str, str]
    words: tuple[str, str]
    units: tuple[str, str]
    advised: tuple[float, float]
    points: tuple[Pair, ...]


@dataclass(frozen=True)
class Drawn:
    """Number of ``draws`` of the constants, and the names of those ``drawn``."""

    draws: int
    drawn: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Limits(Answering):
    """``allowed``: how many of the ``cases`` may be above a limit; ``rows``: of each factor, and of all
    together; ``map``: None without a certified pair; ``certificate``: None where it was not asked for, or
    no tolerance of the whole set is certified."""

    asked: Options
    limits: tuple[Limit, ...]
    probability: float
    confidence: float
    cases: int
    allowed: int
    constants: Drawn
    margin: Margin
    rows: tuple[Row, ...]
    map: Map | None
    certificate: Certificate | None
    evaluations: int
