"""Result of ``tipoff limits``."""

from dataclasses import dataclass

from tipoff.studies.limits.certificate import Certificate
from tipoff.studies.limits.constants import Margin
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.limits.search import Found
from tipoff.studies.populations.answers import Named
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Answering
from tipoff.studies.populations.spread import Quantile


@dataclass(frozen=True, kw_only=True)
class Advised:
    """Cases above a limit at the ``tolerance`` that the paper advises, or that a file of errors states,
    with bounds of their share."""

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
class CertifiedFactor:
    """A factor with its certified tolerances. None if there is nothing to search."""

    name: str
    words: str  # name for a reader
    unit: str  # of all tolerances of the row
    most: float  # the largest searched tolerance
    nominal: Found  # with nominal constants
    advised: (
        Advised | None
    )  # None if the paper advises no tolerance; that of a file, if one is given
    constants: tuple[Found, ...] | None = None  # with each draw of the constants
    model: Found | None = None  # with limits less the error of the model
    both: Found | None = None  # with the worst draw and these limits
    beside: tuple[Magnitude, ...] | None = None  # quantities at the certified tolerance
    # 95 % of the values with their unit, as a file of errors states them, and at the certified
    # tolerance; None without a file
    stated: str | None = None
    certified: str | None = None


@dataclass(frozen=True)
class Pair:
    """Certified tolerances of both factors of a map, on one ray."""

    tolerances: tuple[float, float]  # in the units of the map
    state: str  # as in ``search.Found``


@dataclass(frozen=True, kw_only=True)
class Map:
    """Certified pairs of two factors, in their ``units``, and the pair that the paper advises."""

    names: tuple[str, str]
    words: tuple[str, str]
    units: tuple[str, str]
    advised: tuple[float, float]  # in ``units``
    points: tuple[Pair, ...]


@dataclass(frozen=True)
class Drawn:
    """The draws of the constants."""

    draws: int  # number
    drawn: tuple[str, ...]  # names of the drawn constants


@dataclass(frozen=True, kw_only=True)
class Limits(Answering):
    """Certified tolerances of a scene."""

    asked: LimitsOptions
    limits: tuple[Limit, ...]
    probability: float
    confidence: float
    cases: int
    allowed: int  # how many of the cases may be above a limit
    constants: Drawn
    margin: Margin
    rows: tuple[CertifiedFactor, ...]  # of each factor, and of all together
    map: Map | None  # None without a certified pair
    # None if not requested, or if no tolerance of the whole set is certified
    certificate: Certificate | None
    evaluations: int  # sets of cases that were run
