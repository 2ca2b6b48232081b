"""The probability that a rate is above a limit, with its bounds.

If k of n independent cases are above a limit, the bounds of Clopper and Pearson (Biometrika 26,
1934) for that probability are quantiles of beta distributions: beta(k, n - k + 1) for the lower and
beta(k + 1, n - k) for the upper bound. They hold for any distribution of the rate. A case that did
not settle counts as above every limit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from tipoff.faults import Fault, SceneError
from tipoff.units import to_si

TOTAL = "total"
_AXES = ("x", "y", "z", TOTAL)


@dataclass(frozen=True)
class Limit:
    """A limit (deg/s) of the rate about the axis x, y or z, or of its magnitude, ``TOTAL``."""

    axis: str
    deg_s: float

    @property
    def words(self) -> str:
        """The rate and its limit as text."""
        return (
            f"{'total rate' if self.axis == TOTAL else f'rate about {self.axis}'} "
            f"{self.deg_s:g} deg/s"
        )

    @property
    def asked(self) -> str:
        """The text that ``limits`` reads."""
        return f"{'' if self.axis == TOTAL else f'{self.axis}='}{self.deg_s!r} deg/s"


def limits(texts: Sequence[str], option: str = "--limit") -> list[Limit]:
    """Limits from texts such as ``x=2 deg/s``, or ``5 deg/s`` for the total rate. Raises SceneError
    listing every fault."""
    found, faults = [], []
    for text in texts:
        axis, equals, value = text.rpartition("=")
        axis = axis.strip() if equals else TOTAL
        if axis not in _AXES:
            faults.append(
                Fault(
                    option,
                    axis or "axis",
                    text,
                    f"one of {', '.join(_AXES)} before the equals sign",
                )
            )
        try:
            rate = to_si(value, "deg/s")
            if rate <= 0.0:
                faults.append(Fault(option, "value", text, "more than zero"))
            found.append(Limit(axis, rate))
        except ValueError as fault:
            faults.append(Fault(option, "value", text, str(fault)))
    if faults:
        raise SceneError(faults)
    return found


def above(rates: np.ndarray, limit: Limit) -> np.ndarray:
    """Whether each of ``rates`` (n,3), deg/s, is above ``limit`` (n,); NaN counts as above."""
    value = (
        np.linalg.norm(rates, axis=1)
        if limit.axis == TOTAL
        else np.abs(rates[:, _AXES.index(limit.axis)])
    )
    return ~(value <= limit.deg_s)


def any_above(rates: np.ndarray, limits_: Sequence[Limit]) -> np.ndarray:
    """Whether each of ``rates`` (n,3), deg/s, is above at least one limit (n,)."""
    return np.logical_or.reduce([above(rates, limit) for limit in limits_])


def bounds(count: int, cases: int, confidence: float) -> tuple[float, float]:
    """Two-sided bounds of a probability from ``count`` of ``cases``."""
    tail = 0.5 * (1.0 - confidence)
    return _at_least(count, cases, 1.0 - tail), at_most(count, cases, 1.0 - tail)


def at_most(count: int, cases: int, confidence: float) -> float:
    """One-sided upper bound of a probability from ``count`` of ``cases``."""
    return 1.0 if count == cases else float(betaincinv(count + 1, cases - count, confidence))


def _at_least(count: int, cases: int, confidence: float) -> float:
    """One-sided lower bound."""
    return 0.0 if count == 0 else float(betaincinv(count, cases - count + 1, 1.0 - confidence))


def allowed(cases: int, probability: float, confidence: float) -> int | None:
    """The largest number of ``cases`` above a limit with an upper bound of at most
    1 - ``probability``; None where the bound of zero cases is larger."""
    if at_most(0, cases, confidence) > 1.0 - probability:
        return None
    # a share is below its upper bound, so the search can end at 1 - probability
    fine, many = 0, min(int((1.0 - probability) * cases) + 1, cases)
    while many - fine > 1:
        middle = (fine + many) // 2
        fine, many = (
            (middle, many)
            if at_most(middle, cases, confidence) <= 1.0 - probability
            else (fine, middle)
        )
    return fine
