"""Types of the quantities of a scene: a float in SI with its bounds, read as ``tipoff.units`` does."""

import math
from typing import Annotated, Any, TypedDict, Unpack

from pydantic import BeforeValidator, Field, ValidationInfo

from tipoff.mechanics.run_limits import LONGEST
from tipoff.scenes.rounding import on
from tipoff.units import named, parse

# Magnitudes (SI) beyond these are typing errors. Products of quantities would overflow, and the
# place of a rail would be lost in rounding.
_LARGEST, _LARGEST_LENGTH = 1e200, 1e9


def sized(value: float, unit: str, is_positive: bool = False) -> float:
    """``value``, if a scene may have its magnitude in ``unit``. Raises ValueError."""
    largest = _LARGEST_LENGTH if unit == "m" else _LARGEST
    if abs(value) > largest:
        raise ValueError(f"{named(unit)}, {largest:g} at most")
    if is_positive and 0.0 < value < 1.0 / largest:
        raise ValueError(f"{named(unit)}, at least {1.0 / largest:g}")
    return value


class Bounds(TypedDict, total=False):
    """Limits of a quantity in its unit, named as in ``pydantic.Field``."""

    gt: float
    ge: float
    lt: float
    le: float


def quantity(unit: str, **bounds: Unpack[Bounds]) -> Any:
    """Pydantic type of a quantity in ``unit``, with bounds as in ``pydantic.Field`` (gt, ge, lt,
    le) in that unit. A value that equals a bound up to rounding becomes the bound."""

    limits = tuple(limit for limit in bounds.values() if isinstance(limit, float) and limit)

    def convert(value: Any, info: ValidationInfo) -> float:
        bare = bool(info.context and info.context.get("bare_numbers_are_si"))
        return sized(on(parse(value, unit, bare), limits), unit, bounds.get("gt") == 0.0)

    return Annotated[
        float, BeforeValidator(convert), Field(**bounds, json_schema_extra={"unit": unit})
    ]


Number = quantity("dimensionless")
NonNegativeNumber = quantity("dimensionless", ge=0.0)
PositiveNumber = quantity("dimensionless", gt=0.0)
ContactExponent = quantity("dimensionless", ge=0.5, le=10.0)  # 1.5 of Hertz, 1 of a plane
Length = quantity("m")
NonNegativeLength = quantity("m", ge=0.0)
PositiveLength = quantity("m", gt=0.0)
SMALLEST_DIMENSION = 1e-6  # m, of a rail: above the rounding of its place, below any real one
Dimension = quantity("m", ge=SMALLEST_DIMENSION)
Angle = quantity("rad")
Inclination = quantity("rad", ge=-0.5 * math.pi, le=0.5 * math.pi)
Time = quantity("s")
NonNegativeMass = quantity("kg", ge=0.0)
NonNegativeTime = quantity("s", ge=0.0)
PositiveTime = quantity("s", gt=0.0)
FINEST_ELEMENTS, COARSEST_ELEMENTS = 5e-5, 0.1  # m
ElementSize = quantity("m", ge=FINEST_ELEMENTS, le=COARSEST_ELEMENTS)
Duration = quantity("s", gt=0.0, le=LONGEST)  # an ejection takes milliseconds, a slow one minutes
Mass = quantity("kg", gt=0.0)
Density = quantity("kg/m**3", gt=0.0)
Pressure = quantity("Pa", gt=0.0)
Force = quantity("N")
PositiveForce = quantity("N", gt=0.0)
NonNegativeForce = quantity("N", ge=0.0)
PushFriction = quantity("N", ge=0.0)
SpringRate = quantity("N/m", ge=0.0)
Impulse = quantity("N*s", gt=0.0)
Velocity = quantity("m/s")
PositiveVelocity = quantity("m/s", gt=0.0)
Rate = quantity("rad/s")
PositiveRate = quantity("rad/s", gt=0.0)
PointingLimit = quantity("rad", gt=0.0, lt=math.pi)
# lower speeds are rounding in a launch, and no face would ever be at rest
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
