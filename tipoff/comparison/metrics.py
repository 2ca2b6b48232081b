"""Differences between the trajectories of a surrogate and of the reference.

    rate L2 = sqrt( sum_axes int |w - w_ref|^2 dt / sum_axes int |w_ref|^2 dt )       v_x L2 likewise
    settled error = max_axes |w_settled - w_ref,settled|
    Sprague and Geers:  M = sqrt(I_cc / I_rr) - 1,   P = acos(I_rc / sqrt(I_rr I_cc)) / pi,   I_ab = sum_axes int a b dt

Integrals run from ignition to the end of the reference's settled window, at the same times, without
a shift. Source of the last metric: Sprague and Geers, Commun. Numer. Meth. Eng. 20 (2004) 467.
"""

import math
from dataclasses import asdict, dataclass
from typing import NamedTuple

import numpy as np

from tipoff.cards import Carded
from tipoff.comparison import iso18571
from tipoff.comparison.curves import Curves
from tipoff.mechanics.run_limits import SETTLE_WINDOW
from tipoff.results.trajectory import Trajectory

AXES = ("x", "y", "z")
CHANNELS = ("velocity_x", "rate_x", "rate_y", "rate_z")


@dataclass(frozen=True)
class Difference(Carded):
    """Every metric between two runs of one condition; None if a run has no settled values or the
    reference is zero.

    ``iso18571`` is the mean rating of the three rates, ``iso18571_channels`` and
    ``sprague_geers_channels`` (M, P) list v_x and each rate; rates in deg/s, velocities in m/s,
    angles in deg. Differences are surrogate minus reference.

    Example:
        >>> scene = tipoff.load("tiny")
        >>> found = tipoff.compare(tipoff.run(scene, modes=0), tipoff.run(scene, "springs"))
        >>> sorted(found.iso18571_channels)
        ['rate_x', 'rate_y', 'rate_z', 'velocity_x']
    """

    velocity_relative_l2: float | None
    rate_relative_l2: float | None
    settled_rate_error_deg_s: float | None
    settled_rate_error_xyz_deg_s: list[float] | None
    iso18571: float
    iso18571_channels: dict[str, float]
    sprague_geers_magnitude: float | None
    sprague_geers_phase: float | None
    sprague_geers_channels: dict[str, list[float] | None]
    lateral_velocity_difference_m_s: float | None
    direction_error_difference_deg: float | None

    def __repr__(self) -> str:
        return (
            f"Difference({', '.join(f'{name} {words}' for name, words in self._facts().items())})"
        )

    def _facts(self) -> dict[str, str]:
        shown = {
            "rates L2": (self.rate_relative_l2, 100.0, "%"),
            "v_x L2": (self.velocity_relative_l2, 100.0, "%"),
            "settled": (self.settled_rate_error_deg_s, 1.0, "deg/s"),
            "across": (self.lateral_velocity_difference_m_s, 1e3, "mm/s"),
            "direction": (self.direction_error_difference_deg, 1.0, "deg"),
            "ISO 18571": (self.iso18571, 1.0, "(1 is equal)"),
        }
        return {
            name: "none" if value is None else f"{factor * value:.3g} {unit}"
            for name, (value, factor, unit) in shown.items()
        }

    def as_dict(self) -> dict:
        """Plain values for a result file.

        Returns:
            dict: the metrics by name, which ends with the unit.

        Example:
            >>> run = tipoff.run(tipoff.load("tiny"), "springs")
            >>> tipoff.compare(run, run).as_dict()["settled_rate_error_deg_s"]
            0.0
        """
        return asdict(self)


class _Sampled(NamedTuple):
    """What is compared of a run or of curves; ``speed`` is (n,1) m/s, or (n,0) if not known."""

    time: np.ndarray  # (n,) s
    speed: np.ndarray
    rate: np.ndarray  # (n,3) rad/s
    settled: np.ndarray | None  # (3,) rad/s


def _sampled(run: Trajectory | Curves) -> _Sampled:
    if isinstance(run, Curves):
        known = run.velocity[:, None] if np.isfinite(run.velocity).all() else run.rate[:, :0]
        return _Sampled(run.time, known, run.rate, run.settled)
    settled = None if run.outcome.rate is None else np.array(run.outcome.rate)
    return _Sampled(run.time, run.velocity[:, :1], run.rate, settled)


def compare(reference: Trajectory | Curves, surrogate: Trajectory | Curves) -> Difference:
    """Metrics of ``surrogate`` against ``reference``. Curves have no lateral velocity and no
    direction, and those of a file may lack v_x."""
    time = common_time(reference, surrogate)
    first, second = _sampled(reference), _sampled(surrogate)
    speed_r, speed_s = (_at(item.time, item.speed, time) for item in (first, second))
    rate_r, rate_s = (_at(item.time, item.rate, time) for item in (first, second))
    has_speed = speed_r.size > 0 and speed_s.size > 0
    curves_r, curves_s = (
        np.hstack([speed, rate]) if has_speed else rate
        for speed, rate in ((speed_r, rate_r), (speed_s, rate_s))
    )
    names = CHANNELS if has_speed else CHANNELS[1:]
    ratings = {
        name: iso18571.rate(curves_r[:, i], curves_s[:, i]).overall for i, name in enumerate(names)
    }
    together = sprague_geers(time, rate_r, rate_s) or (None, None)
    channels = {
        name: sprague_geers(time, curves_r[:, i : i + 1], curves_s[:, i : i + 1])
        for i, name in enumerate(names)
    }
    errors = settled_rate_errors(reference, surrogate)
    return Difference(
        velocity_relative_l2=relative_l2(time, speed_r, speed_s) if has_speed else None,
        rate_relative_l2=relative_l2(time, rate_r, rate_s),
        settled_rate_error_deg_s=None if errors is None else max(abs(error) for error in errors),
        settled_rate_error_xyz_deg_s=errors,
        iso18571=sum(ratings[f"rate_{axis}"] for axis in AXES) / 3.0,
        iso18571_channels=ratings,
        sprague_geers_magnitude=together[0],
        sprague_geers_phase=together[1],
        sprague_geers_channels={
            name: list(pair) if pair else None for name, pair in channels.items()
        },
        lateral_velocity_difference_m_s=_outcome_difference(
            reference, surrogate, "lateral_velocity"
        ),
        direction_error_difference_deg=_outcome_difference(
            reference, surrogate, "direction_error", 180.0 / math.pi
        ),
    )


def common_time(reference: Trajectory | Curves, surrogate: Trajectory | Curves) -> np.ndarray:
    """Equidistant times (s) from ignition to the end of the reference's settled window, or to the
    end of the shorter run."""
    own = reference if isinstance(reference, Curves) else reference.outcome
    start = own.window_start
    end = math.inf if start is None else start + SETTLE_WINDOW
    end = min(end, float(reference.time[-1]), float(surrogate.time[-1]))
    steps = np.diff(reference.time)
    steps = steps[steps > 0.0]  # none in a run of one sample
    count = round(end / float(np.median(steps))) + 1 if steps.size else 0
    return np.linspace(0.0, end, max(20, count))


def relative_l2(time: np.ndarray, reference: np.ndarray, other: np.ndarray) -> float | None:
    """Relative L2 difference of curves (n,c) over ``time`` (n,) s, summed over columns; None for a
    reference of zeros."""
    scale = _inner(time, reference, reference)
    return (
        math.sqrt(_inner(time, other - reference, other - reference) / scale)
        if scale > 0.0
        else None
    )


def sprague_geers(
    time: np.ndarray, reference: np.ndarray, other: np.ndarray
) -> tuple[float, float] | None:
    """Magnitude and phase error of curves (n,c), summed over columns; None if one of them is
    zero."""
    rr, cc, rc = (
        _inner(time, reference, reference),
        _inner(time, other, other),
        _inner(time, reference, other),
    )
    if not (rr > 0.0 and cc > 0.0):
        return None
    cosine = rc / math.sqrt(rr * cc)
    # The inequality of Cauchy and Schwarz holds only up to rounding.
    return math.sqrt(cc / rr) - 1.0, math.acos(min(1.0, max(-1.0, cosine))) / math.pi


def settled_rate_errors(
    reference: Trajectory | Curves, other: Trajectory | Curves
) -> list[float] | None:
    """Difference of the settled rates per axis (deg/s), or None if one run did not settle."""
    first, second = _sampled(reference).settled, _sampled(other).settled
    if first is None or second is None:
        return None
    return np.degrees(np.subtract(second, first)).tolist()


def _inner(time, a, b) -> float:
    return float(np.trapezoid((a * b).sum(axis=1), time))


def _at(time, values, at) -> np.ndarray:
    columns = [np.interp(at, time, column) for column in values.T]
    return np.column_stack(columns) if columns else np.empty((at.size, 0))


def _outcome_difference(reference, other, name: str, factor: float = 1.0) -> float | None:
    if isinstance(reference, Curves) or isinstance(other, Curves):
        return None
    first, second = getattr(reference.outcome, name), getattr(other.outcome, name)
    return None if first is None or second is None else factor * (second - first)
