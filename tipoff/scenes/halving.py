"""Tolerances of a file of errors, and the file with one of them halved, or scaled.

A tolerance is the scatter of one input, or of an offset (misalignment, eccentricity), whose keys are one
vector. An offset in any direction has half the size for the same draw; all other inputs move halfway to
the middle of their distribution. So a halved tolerance changes no draw of any input. Another scale than a half
does the same.
"""

import math
from collections.abc import Mapping

import numpy as np

from tipoff.scenes import polar
from tipoff.scenes.distributions import Distribution, Fixed, Uniform, narrowed
from tipoff.scenes.rounding import at_most
from tipoff.scenes.uncertainty import Uncertainty, unit_of
from tipoff.units import COMMON_FACTORS

_HALF = 0.5
_SPAN = 0.95  # share of the values between the ends of a range in words
_SHOWN = {"rad": "deg", "m": "mm", "rad/s": "deg/s", "s": "ms"}


def tolerances(errors: Uncertainty) -> dict[str, tuple[str, ...]]:
    """The varied keys of each tolerance of ``errors``, by its dotted name. An input that has one value has
    no tolerance, unless it is the size of an offset in any direction."""
    found: dict[str, tuple[str, ...]] = {}
    for key in errors.vary:
        table = key.rpartition(".")[0]
        name = table if table.endswith(polar.OFFSETS) else key
        found[name] = (*found.get(name, ()), key)
    return {
        name: own
        for name, own in found.items()
        if _any_direction(errors, name)
        or not all(isinstance(errors.vary[key], Fixed) for key in own)
    }


def halved(errors: Uncertainty, name: str) -> Uncertainty:
    """``errors`` with the tolerance ``name`` of ``tolerances`` halved."""
    return scaled(errors, {name: _HALF})


def scaled(errors: Uncertainty, scales: Mapping[str, float]) -> Uncertainty:
    """``errors`` with each tolerance of ``tolerances`` times its scale, by name; of a scale of zero, the inputs
    have one value."""
    every = tolerances(errors)
    changed = {
        key: _scaled(errors, name, key, scale)
        for name, scale in scales.items()
        for key in every[name]
    }
    return errors._replace(vary=errors.vary | changed)


def _scaled(errors: Uncertainty, name: str, key: str, scale: float) -> Distribution:
    item = errors.vary[key]
    if _whole_turn(item):
        return item
    from_zero = key.endswith(".axial") and (
        _any_direction(errors, name) or (isinstance(item, Uniform) and item.low == 0.0)
    )
    return narrowed(item, scale, 0.0 if from_zero else None)


def _any_direction(errors: Uncertainty, name: str) -> bool:
    """Whether ``name`` is an offset of a size in any direction."""
    direction = errors.vary.get(f"{name}.radial")
    return direction is not None and _whole_turn(direction) and f"{name}.axial" in errors.vary


def _whole_turn(item: Distribution) -> bool:
    return isinstance(item, Uniform) and at_most(2.0 * math.pi, item.high - item.low)


def sizes(errors: Uncertainty) -> dict[str, str]:
    """``words`` of each tolerance by its name."""
    return {name: words(errors, name) for name in tolerances(errors)}


def listed(sizes: Mapping[str, str]) -> str:
    """The ``sizes`` of tolerances by their names as one line."""
    return ", ".join(f"{name} {size}" for name, size in sizes.items())


def with_sizes(file: str, sizes: Mapping[str, str]) -> str:
    """The ``file`` of errors or its name, with the ``sizes`` of its tolerances in brackets."""
    return f"{file} ({listed(sizes)})" if sizes else file


def words(errors: Uncertainty, name: str) -> str:
    """The ranges that have 95 % of the values of a tolerance, with their units."""
    own = [key for key in tolerances(errors)[name] if not _whole_turn(errors.vary[key])]
    ranges = [range_of(errors, key) for key in own]
    if len(own) == 1 or len(set(ranges)) == 1:
        return ranges[0]
    return ", ".join(f"{key.rpartition('.')[2]} {text}" for key, text in zip(own, ranges))


def range_of(errors: Uncertainty, key: str) -> str:
    """The range that has 95 % of the values of a varied ``key``, with its unit. Of a size from zero on, it
    begins at zero."""
    item, unit = errors.vary[key], unit_of(key) or ""
    if key.endswith(".radial") and _whole_turn(item):
        return "any direction"
    from_zero = key.endswith(".axial") and float(item.ppf(np.array(0.0))) == 0.0
    ends = (0.0, _SPAN) if from_zero else (0.5 - 0.5 * _SPAN, 0.5 + 0.5 * _SPAN)
    low, high = (float(item.ppf(np.array(share))) for share in ends)
    return f"{shown(low, high, '')} times" if key in errors.factors else shown(low, high, unit)


def shown(low: float, high: float, unit: str) -> str:
    """The range from ``low`` to ``high``, in the SI ``unit``, as text in a unit that is usual for errors."""
    name = _SHOWN.get(unit, unit)
    factor = COMMON_FACTORS[unit][name] if name != unit else 1.0
    text = f"{low / factor:.3g}"
    if high - low > 1e-12 * abs(high):
        text += f" to {high / factor:.3g}"
    return text if unit in ("", "dimensionless") else f"{text} {name}"
