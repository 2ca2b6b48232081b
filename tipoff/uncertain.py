"""Numbers as text, rounded to their uncertainty. Digits below the uncertainty, or below the smallest
useful step of the unit, are left out."""

import math
from dataclasses import dataclass
from typing import Any

NOTHING = "–"
SHARE = 0.02  # share of a range to which its ends are rounded
LEAST = 1e-3  # the smallest step that is shown of other units
_POWERS = 1e7  # larger numbers are written with a power of ten
# The smallest useful step (in the unit). The best gyroscope of a payload resolves 0.001 deg/s; all
# gates of agreement are at least 0.1 %.
STEPS = {
    "deg/s": LEAST,
    "deg/s per µm": LEAST,
    "deg": LEAST,
    "%": LEAST,
    "margins": LEAST,
    "m/s": 1e-4,
    "mm/s": LEAST,
    "MPa": LEAST,
}


@dataclass(frozen=True)
class Measured:
    """A ``value``, or a sequence of values, with the ``uncertainty`` to which it is rounded (same
    unit, None if not known). With ``apart``, the uncertainty has a cell of its own."""

    value: Any
    uncertainty: float | None
    apart: bool = False
    unit: str = ""  # if its column has none
    magnitude: bool = False  # the size of an error, which is not shown as zero


def number(value: float | None, form: str = ".3g", least: float = 0.0) -> str:
    """``value`` in a format of Python, without a power of ten below a million and without digits
    below ``least``; "<0.001" for a smaller one. None is a dash."""
    if value is None:
        return NOTHING
    if value == 0.0:
        return format(0.0, form.removeprefix("+"))
    if not math.isfinite(value):
        return format(value, form)
    if least and 0.0 < value < 0.5 * least and not form.startswith("+"):
        return f"<{least:g}"
    shown = format(value, form)
    if least and form.endswith("g") and _shown_decimals(shown) > _decimals(least):
        return _fixed(value, _decimals(least), "+" if form.startswith("+") else "")
    if form.endswith("g") and "e+" in shown and abs(value) < 1e6:
        return format(value, form.partition(".")[0] + ".0f")
    if not any(digit in shown for digit in "123456789"):  # rounded to zero, which has no sign
        return format(0.0, form.removeprefix("+"))
    return shown


def uncertain(value: float | None, uncertainty: float | None = None, least: float = LEAST) -> str:
    """``value ± uncertainty``, both rounded to the first digit of the uncertainty, or to the second
    if the first is a one. Digits below ``least`` are left out. Without an uncertainty the value is
    rounded to ``least``. None is a dash."""
    if value is None:
        return NOTHING
    shown = rounded(value, uncertainty, least)
    if uncertainty is None:
        return shown
    if uncertainty == 0.0:
        return f"{shown} ± <{least:g}"
    return f"{shown} ± {rounded(uncertainty, uncertainty, least)}"


def rounded(
    value: float | None, uncertainty: float | None, least: float = LEAST, sign: str = ""
) -> str:
    """``value`` alone, with the digits that ``uncertain`` gives it; "<0.001" for a smaller one.
    ``sign`` "+" also marks a positive one. None is a dash."""
    if value is None:
        return NOTHING
    if uncertainty is None or uncertainty < 0.5 * least:
        if 0.0 < value < 0.5 * least and not sign:
            return f"<{least:g}"
        return _fixed(value, _decimals(least), sign)
    return _fixed(value, min(_decimals(uncertainty), _decimals(least)), sign)


def below(value: float, uncertainty: float, least: float = LEAST) -> str:
    """``rounded``, but "<0.1" in place of "0.0" for a magnitude above zero."""
    shown = rounded(value, uncertainty, least)
    if value <= 0.0 or any(digit in shown for digit in "<123456789"):
        return shown
    return f"<{10.0 ** -_decimals(max(uncertainty, least)):g}"


def range_of(low: float, high: float, least: float = LEAST) -> str:
    """``low to high``, both rounded to a part of the width of the range, without digits below ``least``; one
    number if they agree."""
    ends = [rounded(end, SHARE * (high - low), least) for end in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def _decimals(uncertainty: float) -> int:
    """Decimals of the last digit that counts; negative for tens and hundreds."""
    exponent = math.floor(math.log10(uncertainty))
    leading = round(uncertainty / 10.0**exponent, 9)
    return (1 if 1.0 < leading < 1.95 else 0) - exponent


def _shown_decimals(shown: str) -> int:
    mantissa, _, exponent = shown.partition("e")
    return len(mantissa.partition(".")[2]) - int(exponent or 0)


def _fixed(value: float, decimals: int, sign: str = "") -> str:
    shown = round(value, decimals) + 0.0  # avoids minus zero
    if abs(shown) >= _POWERS:
        digits = math.floor(math.log10(abs(shown))) + decimals + 1
        return f"{shown:{sign}.{min(max(digits, 1), 6)}g}"
    return f"{shown:{sign if shown else ''},.{max(decimals, 0)}f}"
