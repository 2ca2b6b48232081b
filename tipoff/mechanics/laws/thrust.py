"""The law of the thrust: kernel records, F(t), and data for an integrator.

F(t) = sum_i P_i exp(-(t - t_i)^2 / (2 s_i^2))   begin <= t <= end,   or a piecewise linear curve
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from tipoff.kernels.jit import njit
from tipoff.kernels.reference import by_reference

ROOT_TWO_PI = math.sqrt(2.0 * math.pi)
# Widths around a pulse in which the thrust is evaluated: for one pulse, and for one of several.
_COARSE, _FINE = np.linspace(-8.0, 8.0, 17), np.linspace(-8.0, 8.0, 801)
_BISECTIONS = 60  # of the usual interval
_REACH = 8.0  # widths of a Gaussian beyond which it is below 2e-14 of its peak
_POINTS = 4001  # of ``forces``
_FEW = 500  # terms that Python sums; to load the first compiled function of a process takes 0.2 s


@by_reference
class Pulses(NamedTuple):
    """Gaussians, zero outside begin..end."""

    peaks: np.ndarray  # (n,) N
    centres: np.ndarray  # (n,) s
    widths: np.ndarray  # (n,) s
    begin: float  # s
    end: float  # s


@by_reference
class Curve(NamedTuple):
    """Piecewise linear curve."""

    times: np.ndarray  # (n,) s, not decreasing; a repeated time is a jump
    forces: np.ndarray  # (n,) N


@by_reference
class Thrust(NamedTuple):
    """Kernel record: one of the two is not None, or none of them for a force over travel
    (``mechanics.laws.pushers``)."""

    pulses: Pulses | None
    curve: Curve | None


def complete(thrust: Thrust) -> Thrust:
    """The same thrust with both records, of which one or both are empty: kernels have one type for
    all of them."""
    none = np.zeros(0)
    return Thrust(thrust.pulses or Pulses(none, none, none, np.inf, -np.inf), _curve(thrust))


def _curve(thrust: Thrust) -> Curve:
    """The curve of a thrust without pulses, empty for a force over travel."""
    return thrust.curve if thrust.curve is not None else Curve(np.zeros(0), np.zeros(0))


@njit
def _pulsed(pulses, time):
    if not pulses.begin <= time <= pulses.end:
        return 0.0
    total = 0.0
    for i in range(len(pulses.peaks)):
        x = (time - pulses.centres[i]) / pulses.widths[i]
        total += pulses.peaks[i] * math.exp(-0.5 * x * x)
    return total


@njit
def _interpolated(curve, time):
    last = curve.times.size - 1
    if last < 0 or time < curve.times[0] or time >= curve.times[last]:
        return 0.0
    after = np.searchsorted(curve.times, time, side="right")
    t0, t1 = curve.times[after - 1], curve.times[after]
    f0, f1 = curve.forces[after - 1], curve.forces[after]
    return f0 + (f1 - f0) * (time - t0) / (t1 - t0)


@njit
def magnitude(pulses, curve, time):
    """Thrust (N) at ``time`` (s). At a jump of a curve it is the value after the jump."""
    force = 0.0
    if pulses is not None:
        force = _pulsed(pulses, time)
    if curve is not None:
        force += _interpolated(curve, time)
    return force


@njit
def _sampled(pulses, curve, times):
    forces = np.empty(times.size)
    for i in range(times.size):
        forces[i] = magnitude(pulses, curve, times[i])
    return forces


def sample(thrust: Thrust, time: np.ndarray) -> np.ndarray:
    """Thrust (N) at each of ``time`` (n,) s."""
    if (force := _by_python(thrust, time.size)) is not None:
        return np.array([force(at) for at in time.tolist()])
    return _sampled(thrust.pulses, thrust.curve, np.ascontiguousarray(time, dtype=float))


def estimated(thrust: Thrust, time: np.ndarray) -> np.ndarray:
    """As ``sample``, to the last few bits, but pulses without compiled code."""
    pulses = thrust.pulses
    if pulses is None:
        return sample(thrust, time)
    x = (time[:, None] - pulses.centres) / pulses.widths
    burns = (time >= pulses.begin) & (time <= pulses.end)
    return np.where(burns, (pulses.peaks * np.exp(-0.5 * x * x)).sum(axis=1), 0.0)


def _by_python(thrust: Thrust, values: int) -> Callable[[float], float] | None:
    """The thrust (N) over the time (s) as a function of Python, with the bits of the compiled one; None
    for a curve, and if ``values`` of it have many terms."""
    pulses = thrust.pulses
    if pulses is None or values * pulses.peaks.size > _FEW:
        return None
    # lists of Python's numbers, which it reads faster than those of an array
    listed: Any = pulses._replace(
        peaks=pulses.peaks.tolist(), centres=pulses.centres.tolist(), widths=pulses.widths.tolist()
    )
    return partial(_pulsed.py_func, listed)


def corners(thrust: Thrust, duration: float) -> np.ndarray:
    """Sorted times (s) inside (0, duration) where F or its slope jumps: a step must end there."""
    times = (
        np.array([thrust.pulses.begin, thrust.pulses.end])
        if thrust.pulses is not None
        else _curve(thrust).times
    )
    return np.unique(times[(times > 0.0) & (times < duration)])


def shortest_feature(thrust: Thrust) -> float:
    """Time scale (s) that steps must resolve: the narrowest pulse width, or the shortest segment of a
    curve; infinite without both."""
    if thrust.pulses is not None:
        return float(thrust.pulses.widths.min())
    return float(np.diff(np.unique(_curve(thrust).times)).min(initial=math.inf))


def _crossed(thrust: Thrust, level: float, above: float, below: float) -> tuple[float, float]:
    """Two neighbouring times (s), between a time ``above`` and a time ``below`` in either order:
    the magnitude of the thrust is at least ``level`` (N) at the first, and smaller at the second."""
    force = _by_python(thrust, _BISECTIONS) or partial(magnitude, thrust.pulses, thrust.curve)
    above, below = float(above), float(below)
    while (middle := 0.5 * (above + below)) not in (above, below):
        if abs(force(middle)) >= level:
            above = middle
        else:
            below = middle
    return above, below


def _grid(thrust: Thrust, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Times (s) in 0..duration that include every pulse and every point of a curve, and the
    magnitude of the thrust (N) there."""
    if thrust.pulses is None:
        times = _curve(thrust).times
        near = np.append(times, np.nextafter(times, -np.inf))  # both sides of a jump
    else:
        # a single pulse rises once and falls once
        widths = _COARSE if thrust.pulses.centres.size == 1 else _FINE
        around = thrust.pulses.centres[:, None] + widths * thrust.pulses.widths[:, None]
        near = np.append(around, (thrust.pulses.begin, thrust.pulses.end))
    time = np.unique(np.append(near[(near > 0.0) & (near < duration)], (0.0, duration)))
    return time, np.abs(sample(thrust, time))


def reached(thrust: Thrust, level: float) -> float:
    """Earliest time (s) from 0 on at which the magnitude of the thrust is at least ``level`` (N);
    infinite if it never is."""
    time, force = _grid(thrust, math.inf)
    high = np.flatnonzero(force >= level)
    if not high.size:
        return math.inf
    first = int(high[0])
    before = time[max(first - 1, 0)]
    return float(_crossed(thrust, level, time[first], before)[0])


def peak(thrust: Thrust, duration: float) -> float:
    """Largest magnitude of the thrust (N) in 0..duration: exact for one pulse and for a curve, else
    within a relative error of 1e-4."""
    return float(_grid(thrust, duration)[1].max())


def burnouts(thrust: Thrust, fractions: tuple[float, ...], duration: float) -> tuple[float, ...]:
    """For each fraction, the earliest time (s) after which thrust stays below this share of its
    peak; ``duration`` if that is later.

    The last grid point above is found first, then the crossing after it, by bisection to the last
    bit.
    """
    return _burnouts(_Equal(_content(thrust), thrust), fractions, duration)


@dataclass(frozen=True)
class _Equal:
    """A thrust; equal to others with the same ``content``."""

    content: tuple
    thrust: Thrust = field(compare=False)


def _content(record: Any) -> Any:
    """The bytes of nested records of arrays and numbers."""
    if isinstance(record, tuple):
        return tuple(_content(part) for part in record)
    return record if record is None else np.asarray(record).tobytes()


@lru_cache(maxsize=16)  # each run of the surrogate in a loop over scenes asks
def _burnouts(equal: _Equal, fractions: tuple[float, ...], duration: float) -> tuple[float, ...]:
    thrust = equal.thrust
    time, force = _grid(thrust, duration)
    return tuple(
        _last_above(thrust, time, force, fraction * force.max(), duration) for fraction in fractions
    )


def burnout(thrust: Thrust, fraction: float, duration: float) -> float:
    """``burnouts`` of one fraction."""
    return burnouts(thrust, (fraction,), duration)[0]


def _last_above(
    thrust: Thrust, time: np.ndarray, force: np.ndarray, level: float, duration: float
) -> float:
    if level == 0.0:
        return 0.0
    above = np.flatnonzero(force >= level)[-1]
    if above == time.size - 1:
        return float(duration)
    return float(_crossed(thrust, level, time[above], time[above + 1])[1])


def crossing(thrust: Thrust, level: float, above: float, below: float) -> float:
    """Time (s) between a time ``above`` and a time ``below`` at which the magnitude of the thrust passes
    the ``level`` (N), on the side above."""
    return _crossed(thrust, level, above, below)[0]


def last(thrust: Thrust) -> float:
    """Time (s) after which the thrust is zero, or 2e-14 of a pulse's peak."""
    if thrust.pulses is not None:
        end = float((thrust.pulses.centres + _REACH * thrust.pulses.widths).max())
        return max(0.0, min(end, thrust.pulses.end))
    return max(0.0, float(thrust.curve.times[-1])) if thrust.curve is not None else 0.0


def forces(thrust: Thrust) -> tuple[np.ndarray, np.ndarray]:
    """Times (s) from ignition to the end of the thrust, with both sides of its corners, and its values
    (N)."""
    end = last(thrust)
    at_corners = np.append(corners(thrust, end), end)
    both_sides = np.append(at_corners, np.nextafter(at_corners, -np.inf))  # of a jump
    time = np.unique(np.concatenate([np.linspace(0.0, end, _POINTS), both_sides]))
    return time, estimated(thrust, time)


def kept(begin: float, end: float, centre: float, width: float) -> float:
    """Share of a Gaussian's integral in begin..end (s)."""
    if end <= begin:
        return 0.0
    root = math.sqrt(2.0) * width
    return 0.5 * (math.erf((end - centre) / root) - math.erf((begin - centre) / root))


def impulse(thrust: Thrust, duration: float) -> float:
    """Impulse (N s) delivered in 0..duration: exact for both kinds."""
    if thrust.pulses is not None:
        peaks, centres, widths, begin, end = thrust.pulses
        window = max(0.0, begin), min(duration, end)
        return float(
            sum(
                p * s * ROOT_TWO_PI * kept(*window, t, s) for p, t, s in zip(peaks, centres, widths)
            )
        )
    times, forces = _curve(thrust)
    inside = times <= duration
    total = np.trapezoid(forces[inside], times[inside])
    if inside.any() and not inside.all():
        last = np.flatnonzero(inside)[-1]
        part = (duration - times[last]) / (times[last + 1] - times[last])
        cut = forces[last] + part * (forces[last + 1] - forces[last])
        total += 0.5 * (forces[last] + cut) * (duration - times[last])
    return float(total)
