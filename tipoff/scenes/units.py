"""Quantities with units: text such as ``"0.05 mm"`` becomes an SI float, or a fault that names what
was expected.

Inside the program everything is SI and radians. Files must write units; a bare number is taken as
SI only where the caller says so (overrides made by a program, resolved scenes read back).
"""

import math
import re
from collections.abc import Iterable
from functools import lru_cache
from numbers import Real
from typing import Annotated, Any, TypedDict, Unpack

import pint
from pydantic import BeforeValidator, Field, ValidationInfo

registry: pint.UnitRegistry = pint.UnitRegistry()

# The number is read by float, so that pint never evaluates arithmetic such as "9**9**9 m".
_QUANTITY = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)\b)\s*(.*?)\s*", re.I
)


def named(unit: str) -> str:
    """Text of what a field in ``unit`` should hold."""
    return (
        "a number" if unit == "dimensionless" else f'a quantity in {unit}, for example "1 {unit}"'
    )


@lru_cache(maxsize=4096)
def to_si(text: str, unit: str, absolute: bool = False) -> float:
    """Value of ``text`` in ``unit`` (an SI unit). Raises ValueError for a wrong dimension, bad
    text, NaN and inf, and, unless it is ``absolute``, for a unit whose zero is elsewhere."""
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise ValueError(named(unit))
    number, given_unit = float(match[1]), match[2] or "dimensionless"
    if not math.isfinite(number):
        raise ValueError(f"{named(unit)}, neither NaN nor infinite")
    try:
        quantity = registry.Quantity(number, registry.parse_units(given_unit))
    except Exception as error:  # pint raises a wide family of exceptions on malformed text
        raise ValueError(f"{named(unit)} ({given_unit!r} is no unit)") from error
    if not quantity.is_compatible_with(unit):
        raise ValueError(f"{named(unit)} (given dimension {quantity.dimensionality})")
    if not absolute and registry.Quantity(0.0, quantity.units).to(unit).magnitude != 0.0:
        raise ValueError(
            f"{named(unit)} ({given_unit!r} has its zero elsewhere: a difference is in K or "
            f"delta_degC)"
        )
    # An angle has no dimension, so "0.1" would pass for 0.1 rad and "5 Hz" for 5 rad/s: ask for the
    # unit itself.
    if _radians(quantity) != _radians(registry.Quantity(1.0, unit)):
        raise ValueError(f"{named(unit)} (given unit {quantity.units})")
    value = float(quantity.to(unit).magnitude)
    if not math.isfinite(value):
        raise ValueError(f"{named(unit)}, neither NaN nor infinite")
    return value


def _radians(quantity: pint.Quantity) -> object:
    """Power of the radian in the unit of ``quantity``, of whatever type pint has it in."""
    return dict(quantity.to_root_units().unit_items()).get("radian", 0)


def are_units(cells: Iterable[str]) -> bool:
    """Whether a line of a table names units: no cell is a value, and not all are empty."""
    texts = [text.strip() for text in cells if text.strip()]
    return bool(texts) and not any(text[0] in "+-.0123456789" or text == "absent" for text in texts)


def parse(value: Any, unit: str, bare_numbers_are_si: bool) -> float:
    """SI value of a field that should carry ``unit``; ``value`` is text with a unit, or a number
    where that is allowed.

    Raises ValueError that says what was expected.
    """
    if isinstance(value, str):
        return to_si(value, unit)
    # checks of abstract types are slow
    if type(value) is not float and (isinstance(value, bool) or not isinstance(value, Real)):
        raise ValueError(named(unit))
    if not math.isfinite(value):
        raise ValueError(f"{named(unit)}, neither NaN nor infinite")
    if unit != "dimensionless" and not bare_numbers_are_si:
        raise ValueError(f'text with a unit of dimension {unit}, for example "{value} {unit}"')
    return float(value)


class Bounds(TypedDict, total=False):
    """Limits of a quantity in its unit, named as in ``pydantic.Field``."""

    gt: float
    ge: float
    lt: float
    le: float


def quantity(unit: str, **bounds: Unpack[Bounds]) -> Any:
    """Pydantic type of a quantity held in ``unit``, with bounds as in ``pydantic.Field`` (gt, ge,
    lt, le) in that unit."""

    def convert(value: Any, info: ValidationInfo) -> float:
        bare = bool(info.context and info.context.get("bare_numbers_are_si"))
        return parse(value, unit, bare)

    return Annotated[
        float, BeforeValidator(convert), Field(**bounds, json_schema_extra={"unit": unit})
    ]


Number = quantity("dimensionless")
NonNegativeNumber = quantity("dimensionless", ge=0.0)
PositiveNumber = quantity("dimensionless", gt=0.0)
Length = quantity("m")
NonNegativeLength = quantity("m", ge=0.0)
PositiveLength = quantity("m", gt=0.0)
Angle = quantity("rad")
Time = quantity("s")
NonNegativeTime = quantity("s", ge=0.0)
PositiveTime = quantity("s", gt=0.0)
Duration = quantity("s", gt=0.0, le=3600.0)  # an ejection takes milliseconds, a slow one minutes
Mass = quantity("kg", gt=0.0)
Density = quantity("kg/m**3", gt=0.0)
Pressure = quantity("Pa", gt=0.0)
Force = quantity("N")
Impulse = quantity("N*s", gt=0.0)
Velocity = quantity("m/s")
PositiveVelocity = quantity("m/s", gt=0.0)
Rate = quantity("rad/s")
PositiveRate = quantity("rad/s", gt=0.0)
PointingLimit = quantity("rad", gt=0.0, lt=math.pi)
# at lower speeds, which in a launch are rounding, no face would ever be found at rest
CaptureSpeed = quantity("m/s", ge=1e-9)
Acceleration = quantity("m/s**2")
Inertia = quantity("kg*m**2")
PositiveInertia = quantity("kg*m**2", gt=0.0)
Frequency = quantity("Hz", gt=0.0)
PoissonRatio = quantity("dimensionless", gt=-1.0, lt=0.5)
DampingRatio = quantity("dimensionless", ge=0.0, lt=1.0)
Stiffness = quantity("N/m", gt=0.0)
Dissipation = quantity("s/m", ge=0.0)
ContactDamping = quantity("N*s/m", ge=0.0)
TemperatureChange = quantity("K")
TemperatureGradient = quantity("K/m")
Expansion = quantity("1/K")
InterfaceStiffness = quantity("N/m**3", gt=0.0)
