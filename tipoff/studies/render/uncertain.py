"""Numbers rounded to their uncertainty: no digit stands that the uncertainty makes meaningless."""

import math

_NOTHING = "–"
LEAST = 1e-3  # the smallest step that is shown, in the unit of the value


def uncertain(value: float | None, uncertainty: float | None = None, least: float = LEAST) -> str:
    """``value ± uncertainty``, both rounded to the first digit of the uncertainty, to the second
    where the first is a one. Digits below ``least`` are left out; without an uncertainty they are
    the only ones. None is a dash."""
    if value is None:
        return _NOTHING
    if uncertainty is None:
        return _fixed(value, _decimals(least))
    if uncertainty < 0.5 * least:
        return f"{_fixed(value, _decimals(least))} ± <{least:g}"
    decimals = min(_decimals(uncertainty), _decimals(least))
    return f"{_fixed(value, decimals)} ± {_fixed(uncertainty, decimals)}"


def _decimals(uncertainty: float) -> int:
    """Decimals of the last digit that counts; negative for tens and hundreds."""
    exponent = math.floor(math.log10(uncertainty))
    leading = round(uncertainty / 10.0**exponent, 9)
    return (1 if 1.0 < leading < 1.95 else 0) - exponent


def _fixed(value: float, decimals: int) -> str:
    rounded = round(value, decimals) + 0.0  # no minus zero
    return f"{rounded:,.{max(decimals, 0)}f}"
