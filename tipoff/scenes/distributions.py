"""Distributions of uncertain numbers: one table each, with its quantile function ``ppf``::

    x = F^-1(u), u uniform in (0, 1):   normal  m + s z(u)     Rayleigh  s sqrt(-2 ln(1 - u))     z = Phi^-1
    truncated normal, a < x < b:        redraw  m + s z(A + u (B - A)), A = Phi((a - m)/s), B = Phi((b - m)/s)
                                        clip    min(max(m + s z(u), a), b)

A truncated normal names its rule. "redraw" is the law of a draw that is repeated until it is inside
the limits. "clip" moves values outside to the limit, which then has a finite probability. Each
value depends only on its own u, in every bit: ``scipy.special`` works element by element, while
NumPy's vector code may treat the end of an array differently from its middle.
"""

from typing import Annotated, Any, Literal

import numpy as np
import scipy  # its submodules load at their first use
from pydantic import BeforeValidator, ValidationInfo, field_validator

from tipoff.scenes.rounding import at_most
from tipoff.scenes.table import Table
from tipoff.units import parse


def _in_unit_of_key(value: Any, info: ValidationInfo[dict[str, Any]]) -> float:
    unit = info.context["unit"]
    # A number whose unit depends on other keys of the scene can only be given in SI.
    return parse(
        value,
        unit or "dimensionless",
        bare_numbers_are_si=not unit or info.context["bare_numbers_are_si"],
    )


def _positive(value: float) -> float:
    if value <= 0.0:
        raise ValueError("greater than 0")
    return value


Value = Annotated[float, BeforeValidator(_in_unit_of_key)]


class _Limits(Table):
    low: Value
    high: Value

    @field_validator("high")
    @classmethod
    def _above_low(cls, value: float, info: ValidationInfo) -> float:
        if "low" in info.data and at_most(value, info.data["low"]):
            raise ValueError("more than low")
        return value


class Fixed(Table):
    """The same ``value`` in every case."""

    distribution: Literal["fixed"]
    value: Value
    provenance: str = ""

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        return np.full_like(u, self.value)


class Uniform(_Limits):
    """Equal probability for every value from ``low`` to ``high``."""

    distribution: Literal["uniform"]
    provenance: str = ""

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        return self.low + u * (self.high - self.low)


class LogUniform(_Limits):
    """Equal probability for all values of the logarithm between ``low`` and ``high``, for a number
    that is known to an order of magnitude."""

    distribution: Literal["log-uniform"]
    provenance: str = ""

    _sized = field_validator("low")(_positive)

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        return self.low * scipy.special.exp2(u * np.log2(self.high / self.low))


class Normal(Table):
    """Gaussian with ``mean`` and standard deviation ``sd``."""

    distribution: Literal["normal"]
    mean: Value
    sd: Value
    provenance: str = ""

    _spread = field_validator("sd")(_positive)

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        return self.mean + self.sd * scipy.special.ndtri(u)


class TruncatedNormal(_Limits):
    """Gaussian (``mean`` and ``sd`` before truncation) between ``low`` and ``high`` by a
    ``rule``."""

    distribution: Literal["truncated-normal"]
    mean: Value
    sd: Value
    rule: Literal["redraw", "clip"]
    provenance: str = ""

    _spread = field_validator("sd")(_positive)

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        if self.rule == "redraw":
            a, b = (self.low - self.mean) / self.sd, (self.high - self.mean) / self.sd
            # Probabilities near one have no digits left, so limits above the mean are mirrored.
            z = -_between(-b, -a, 1.0 - u) if a > 0.0 else _between(a, b, u)
        else:
            z = scipy.special.ndtri(u)
        return np.clip(self.mean + self.sd * z, self.low, self.high)


class Rayleigh(Table):
    """Length of a plane vector with two normal components of standard deviation ``scale``."""

    distribution: Literal["rayleigh"]
    scale: Value
    provenance: str = ""

    _spread = field_validator("scale")(_positive)

    def ppf(self, u: np.ndarray) -> np.ndarray:
        """Quantiles (SI) of probabilities ``u``, any shape."""
        return self.scale * np.sqrt(-2.0 * scipy.special.log1p(-u))


def _between(a: float, b: float, u: np.ndarray) -> np.ndarray:
    below = scipy.special.ndtr(a)
    return scipy.special.ndtri(below + u * (scipy.special.ndtr(b) - below))


Distribution = Fixed | Uniform | LogUniform | Normal | TruncatedNormal | Rayleigh
BY_NAME: dict[str, type[Distribution]] = {
    "fixed": Fixed,
    "uniform": Uniform,
    "log-uniform": LogUniform,
    "normal": Normal,
    "truncated-normal": TruncatedNormal,
    "rayleigh": Rayleigh,
}


def narrowed(item: Distribution, share: float, about: float | None = None) -> Distribution:
    """The distribution of ``c + share (x - c)`` of a number x with the distribution ``item``; c is ``about``
    (SI), or the middle of ``item``: its mean, the middle between its limits (of their logarithms, if it is
    log-uniform), and zero of a Rayleigh distribution. The quantile at each probability moves in the same
    way, so both distributions have the same draws. It is fixed at c for a ``share`` of zero."""
    if about is None and isinstance(item, LogUniform):
        middle = float(np.sqrt(item.low * item.high))
        if share == 0.0:
            return fixed(middle)
        ends = {name: middle * (getattr(item, name) / middle) ** share for name in ("low", "high")}
        return item.model_copy(update=ends)
    centre = _middle(item) if about is None else about
    if share == 0.0:
        return fixed(centre)
    moved: dict[str, float] = {}
    for name in type(item).model_fields:
        if name in ("value", "mean", "low", "high"):
            moved[name] = centre + share * (getattr(item, name) - centre)
        elif name in ("sd", "scale"):
            moved[name] = share * getattr(item, name)
    return item.model_copy(update=moved)


def fixed(value: float) -> Fixed:
    """The distribution of one ``value`` (SI)."""
    return Fixed.model_construct(distribution="fixed", value=value, provenance="")


def _middle(item: Distribution) -> float:
    match item:
        case Fixed():
            return item.value
        case Normal() | TruncatedNormal():
            return item.mean
        case Rayleigh():
            return 0.0
        case _:
            return 0.5 * (item.low + item.high)
