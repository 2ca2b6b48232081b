"""Misfit of curves from the model: v_x, and rates under other units, signs and axes
(``judgement``)."""

import itertools
import math
from typing import NamedTuple

import numpy as np

from tipoff.calibration.discrepancy import LEAST, RATE
from tipoff.calibration.objective import Target, sampled
from tipoff.results.trajectory import Trajectory
from tipoff.units import duration

VELOCITY = 0.05  # largest relative error of v_x: thrust and mass of a test are known better
_SIGNAL = 5.0  # standard deviations of the noise's power; a weaker segment is not judged
NEAR = 1.5  # misfits within this factor count as equal: the simplest transformation is taken
_FEWEST = 8  # samples of a segment; a shorter one is not judged

_TURN = 180.0 / math.pi
# data over model: unit of the values, unit in the header
_RATES = (
    (_TURN, "values in deg/s with the unit rad/s"),
    (1.0 / _TURN, "values in rad/s with the unit deg/s"),
    (30.0 / math.pi, "values in rpm with the unit rad/s"),
    (math.pi / 30.0, "values in rad/s with the unit rpm"),
    (6.0, "values in deg/s with the unit rpm"),
    (1.0 / 6.0, "values in rpm with the unit deg/s"),
    (1.0 / (2.0 * math.pi), "values in revolutions/s with the unit rad/s"),
    (1.0 / 360.0, "values in revolutions/s with the unit deg/s"),
    (1000.0, "values in mrad/s or mdeg/s with the unit rad/s or deg/s"),
    (0.001, "values a thousand times too small"),
)
_SPEEDS = (
    (1000.0, "values in mm/s with the unit m/s, or m/s with the unit km/s"),
    (0.001, "values in km/s with the unit m/s, or m/s with the unit mm/s"),
    (100.0, "values in cm/s with the unit m/s"),
    (0.01, "values in m/s with the unit cm/s"),
    (3.6, "values in km/h with the unit m/s"),
    (1.0 / 3.6, "values in m/s with the unit km/h"),
    (1.0 / 0.3048, "values in ft/s with the unit m/s"),
    (0.3048, "values in m/s with the unit ft/s"),
    (9.80665, "values in units of g = 9.81 m/s2"),
    (1.0 / 9.80665, "values divided by g = 9.81 m/s2"),
)
_NAMES = ("rate_x", "rate_y", "rate_z")


class Kind(NamedTuple):
    """A transformation T y = turn y."""

    turn: np.ndarray  # (3,3)
    changes: int  # number of changes that it makes
    words: str  # description


def _kinds() -> list[Kind]:
    found = [Kind(np.eye(3), 0, "")]
    found += [Kind(np.eye(3) / factor, 1, words) for factor, words in _RATES]
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            turn = np.diag(signs) @ np.eye(3)[list(order)]
            if (turn != np.eye(3)).any():
                found.append(Kind(turn, _changes(order, signs), _axes(order, signs)))
    return found


def _changes(order: tuple[int, ...], signs: tuple[float, ...]) -> int:
    return sum(place != axis for axis, place in enumerate(order)) + signs.count(-1.0)


def _axes(order: tuple[int, ...], signs: tuple[float, ...]) -> str:
    moved = [axis for axis in range(3) if order[axis] != axis]
    if not moved:
        turned = [_NAMES[axis] for axis in range(3) if signs[axis] < 0.0]
        return f"the sign of {' and '.join(turned)}"
    if len(moved) == 2 and min(signs) > 0.0:
        return f"{_NAMES[moved[0]]} and {_NAMES[moved[1]]} are exchanged"
    found = [
        f"{_NAMES[axis]} is {'minus ' if signs[axis] < 0.0 else ''}the column {_NAMES[order[axis]]}"
        for axis in range(3)
        if order[axis] != axis or signs[axis] < 0.0
    ]
    return f"axes: {', '.join(found)}"


KINDS = _kinds()
_TURNS = np.array([kind.turn for kind in KINDS])


class Misfits(NamedTuple):
    """Misfits (k,) of all ``KINDS``; None for a segment without a signal above its noise, and for a
    run that did not exit."""

    whole: np.ndarray | None  # of the whole curve
    flight: np.ndarray | None  # of the free flight


def first_touch(run: Trajectory) -> float:
    """Time (s) of the last sample before a pad is pressed."""
    pressed = np.flatnonzero(np.abs(run.pad_force).reshape(run.time.size, -1).max(axis=1) > 0.0)
    return float(run.time[max(pressed[0] - 1, 0)] if pressed.size else run.time[-1])


def misfits(wanted: Target, run: Trajectory, offset: float, touch: float) -> Misfits:
    """The misfits of the curves ``wanted``, late by ``offset`` (s), from a ``run``; free flight
    lasts until ``touch`` (s)."""
    if run.status != "exited":
        return Misfits(None, None)
    model = sampled(run, wanted.time - offset)[:, 1:]
    return Misfits(*(of_rates(wanted, model, keep) for keep in segments(wanted, offset, touch)))


def segments(wanted: Target, offset: float, touch: float) -> tuple[np.ndarray, np.ndarray]:
    """Samples (n,) of the whole curve, and of its free flight."""
    return wanted.weights > 0.0, wanted.time - offset <= touch


def of_rates(wanted: Target, model: np.ndarray, keep: np.ndarray) -> np.ndarray | None:
    """Misfits (k,) of the samples ``keep`` (n,) from rates ``model`` (n,3); None without a signal
    above the noise."""
    if keep.sum() < _FEWEST:
        return None
    weights, rate, model = wanted.weights[keep], wanted.rate[keep], model[keep]
    noise = np.mean(np.diff(wanted.rate, 2, axis=0) ** 2, axis=0) / 6.0  # (3,)
    own = (rate.T * weights) @ rate
    cross = (rate.T * weights) @ model
    power = float(np.trace((model.T * weights) @ model))
    floor = weights.sum() * noise.sum()
    scatter = np.sqrt(2.0 * (weights**2).sum() * (noise**2).sum())
    if not np.trace(own) - floor > _SIGNAL * scatter:
        return None
    turned = np.einsum("kij,jl,kil->k", _TURNS, own, _TURNS)
    loud = weights.sum() * (_TURNS**2 @ noise).sum(axis=1)
    left = turned - 2.0 * np.einsum("kij,ji->k", _TURNS, cross) + power
    whole = np.maximum(turned - loud, power)
    # due to noise and the least model error
    least = np.maximum(scatter * loud / max(floor, 1e-300), LEAST[RATE] ** 2 * whole)
    return np.sqrt(np.maximum(left - loud, least) / whole)


def velocity_faults(name: str, wanted: Target, run: Trajectory) -> list[str]:
    """Sentences on a v_x that differs from the model after the thrust."""
    if run.status != "exited" or run.outcome.velocity is None:
        return []
    late = wanted.time >= wanted.window_start
    mean, model = float(wanted.velocity[late].mean()), float(run.outcome.velocity[0])
    noise = float(np.mean(np.diff(wanted.velocity, 2) ** 2) / 6.0)
    if model == 0.0:
        return []
    ratio, error = mean / model, np.sqrt(noise / late.sum()) / abs(model)
    if abs(ratio - 1.0) - 2.0 * error <= VELOCITY:
        return []
    size = abs(ratio)
    words = "thrust, mass or unit is not that of the scene"
    for factor, unit in _SPEEDS:
        if abs(size / factor - 1.0) - 2.0 * error / factor <= VELOCITY:
            words = unit
    if ratio < 0.0:
        words = "the sign" if abs(size - 1.0) <= VELOCITY else f"the sign, and {words}"
    return [
        f"velocity_x of {name} settles at {mean:.4g} m/s, and the model at {model:.4g} m/s, which is "
        f"impulse over mass minus the loss by friction: ratio {ratio:.4g}, expected 1 within "
        f"{100.0 * VELOCITY:g} %. Likely cause: {words}"
    ]


def shape_faults(name: str, wanted: Target, run: Trajectory, offset: float) -> list[str]:
    """Sentences on a v_x whose shape differs from the model, at the best ``offset``."""
    if run.status != "exited":
        return []
    left = wanted.velocity - sampled(run, wanted.time - offset)[:, 0]
    noise = float(np.mean(np.diff(wanted.velocity, 2) ** 2) / 6.0)
    square = float(wanted.weights @ left**2) - wanted.weights.sum() * noise
    misfit = math.sqrt(max(square, 0.0)) / wanted.amplitudes[0]
    if misfit <= VELOCITY:
        return []
    return [
        f"velocity_x of {name} differs from the model by {100.0 * misfit:.3g} % of its root mean "
        f"square at the best offset in time, {duration(offset, 4)}, expected {100.0 * VELOCITY:g} % at "
        "most. Likely cause: time (unit or start), thrust curve, or another column"
    ]
