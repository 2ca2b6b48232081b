"""Quantities with units: text such as ``"0.05 mm"`` becomes an SI float, or a fault with the
expected value.

Inside the program everything is in SI and radians. Files must write units; a bare number is taken
as SI only if the caller allows it (overrides from a program, resolved scenes).
"""

import math
import re
import threading
from collections.abc import Iterable
from functools import cache, lru_cache
from numbers import Real
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

# The number is read by float, so that pint never evaluates arithmetic such as "9**9**9 m".
_QUANTITY = re.compile(
    r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)\b)\s*(.*?)\s*", re.I
)
# Text that pint may read: names, each to a small power, and 1, multiplied and divided. pint
# evaluates arithmetic, and "kg*9**9**9" would take hours and all memory.
_LONGEST = 100  # characters of a unit
_NUMBER = r"[+-]?\d{1,2}(?:[./]\d{1,12})?"
_POWER = rf"(?:\*\*|\^)\s*(?:{_NUMBER}(?![\w.])|\(\s*{_NUMBER}\s*\))"
_UNIT = re.compile(rf"(?:{_POWER}(?!\s*(?:\*\*|\^))|[^\W\d]\w*+|1(?![\w.])|[%°()/·⁻]|\*(?!\*)|\s)*")
# Factors of units that scenes often have, by the unit of the field. pint has the same factors, but it
# takes longer to load than a stored run.
COMMON_FACTORS = {
    "m": {"mm": 1e-3, "um": 1e-6, "km": 1e3},
    "s": {"ms": 1e-3},
    "rad": {"deg": math.pi / 180.0},
    "m/s": {"mm/s": 1e-3},
    "rad/s": {"deg/s": math.pi / 180.0},
    "N": {"kN": 1e3},
    "Pa": {"MPa": 1e6, "GPa": 1e9},
    "N*s/m": {"N*s/mm": 1e3},
    "N/m**1.5": {"N/mm**1.5": 1e3**1.5},
}

# Units of lengths, in metres, that a scene states for a file of another program.
LENGTHS_OF_FILES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048}

_LOADING = threading.Lock()


def registry() -> "pint.UnitRegistry":
    """All units of pint. It loads when the first unit is read, because this takes 0.3 s, and the
    scenes of worker processes are in SI."""
    with _LOADING:  # threads share one registry
        return _registry()


@cache
def _registry() -> "pint.UnitRegistry":
    import pint

    return pint.UnitRegistry()


def named(unit: str) -> str:
    """Text of the expected value of a field in ``unit``."""
    return (
        "a number" if unit == "dimensionless" else f'a quantity in {unit}, for example "1 {unit}"'
    )


@lru_cache(maxsize=4096)
def to_si(text: str, unit: str, absolute: bool = False) -> float:
    """Value of ``text`` in ``unit`` (an SI unit). Raises ValueError for a wrong dimension, bad
    text, NaN and inf, and, unless it is ``absolute``, for a unit with an offset zero."""
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise ValueError(named(unit))
    number, given_unit = float(match[1]), match[2] or "dimensionless"
    if not math.isfinite(number):
        raise ValueError(f"{named(unit)}, neither NaN nor infinite")
    factor = 1.0 if given_unit == unit else COMMON_FACTORS.get(unit, {}).get(given_unit)
    if factor is not None:
        return _finite(number * factor, unit)
    if len(given_unit) > _LONGEST or not _UNIT.fullmatch(given_unit):
        raise ValueError(f"{named(unit)} ({given_unit[:_LONGEST]!r} is no unit)")
    import pint

    units = registry()
    try:
        quantity = units.Quantity(number, units.parse_units(given_unit))
    except Exception as error:  # pint raises many classes on malformed text
        raise ValueError(f"{named(unit)} ({given_unit!r} is no unit)") from error
    if not quantity.is_compatible_with(unit):
        raise ValueError(f"{named(unit)} (given dimension {quantity.dimensionality})")
    try:
        return _finite(_converted(quantity, unit, absolute, given_unit), unit)
    except (ArithmeticError, pint.PintError) as error:  # powers of powers, or of offset units
        raise ValueError(f"{named(unit)} ({given_unit!r} is no such unit)") from error


def _converted(quantity: "pint.Quantity", unit: str, absolute: bool, given: str) -> float:
    """Magnitude in ``unit``. Raises ValueError for another power of the radian, and, unless it is
    ``absolute``, for a unit with an offset zero."""
    if not absolute and registry().Quantity(0.0, quantity.units).to(unit).magnitude != 0.0:
        raise ValueError(
            f"{named(unit)} ({given!r} is not a difference: give it in K or delta_degC)"
        )
    # An angle has no dimension, so "0.1" would be taken as 0.1 rad and "5 Hz" as 5 rad/s: the unit
    # itself is compared.
    if _radians(quantity) != _radians(registry().Quantity(1.0, unit)):
        raise ValueError(f"{named(unit)} (given unit {quantity.units})")
    return float(quantity.to(unit).magnitude)


def _finite(value: float, unit: str) -> float:
    if not math.isfinite(value):
        raise ValueError(f"{named(unit)}, neither NaN nor infinite")
    return value


def _radians(quantity: "pint.Quantity") -> object:
    """Power of the radian in the unit of ``quantity``, of the type that pint uses."""
    return dict(quantity.to_root_units().unit_items()).get("radian", 0)


def are_units(cells: Iterable[str]) -> bool:
    """Whether a line of a table has units: no cell is a value, and not all are empty."""
    texts = [text.strip() for text in cells if text.strip()]
    return bool(texts) and not any(text[0] in "+-.0123456789" or text == "absent" for text in texts)


def parse(value: Any, unit: str, bare_numbers_are_si: bool) -> float:
    """SI value of a field with ``unit``; ``value`` is text with a unit, or a number if that is
    allowed.

    Raises ValueError with the expected value.
    """
    if isinstance(value, str):
        return to_si(value, unit)
    if hasattr(value, "magnitude") and hasattr(value, "units"):  # of pint, of any registry
        return to_si(f"{single(value.magnitude)!r} {value.units}", unit)
    value = single(value)
    # checks of abstract types are slow
    if type(value) is not float and (isinstance(value, bool) or not isinstance(value, Real)):
        raise ValueError(named(unit))
    try:
        number = _finite(float(value), unit)
    except OverflowError:  # an integer beyond all floating-point numbers
        number = _finite(math.inf, unit)
    if unit != "dimensionless" and not bare_numbers_are_si:
        raise ValueError(f'text with a unit of dimension {unit}, for example "{value} {unit}"')
    return number


def duration(time: float, digits: int = 6) -> str:
    """A time (s) as text with its unit: in milliseconds up to a second, then in seconds."""
    text = f"{1e3 * time:.{digits}g}"
    return f"{text} ms" if abs(float(text)) < 1e3 else f"{time:.{digits}g} s"


def is_number(value: Any) -> bool:
    """Whether a value is a real number of Python or numpy; text and True are not."""
    return isinstance(value, Real) and not isinstance(value, bool)


def single(value: Any) -> Any:
    """The number in an array without dimensions, as a Python value; anything else unchanged."""
    return value.item() if getattr(value, "shape", None) == () else value
