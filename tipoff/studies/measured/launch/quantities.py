"""Quantities of a launch, from a record and from runs in the same way, and the place of the measured among the
predicted ones.

A run is sampled at the instants of the record and gets its noise. So every quantity has the noise of the
measurement on both sides.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tipoff.studies.measured.launch.record import Record

PARTS = 3  # of the way
_SETTLED = 0.02  # s after the start, from which the rattling is taken
SHARES = (0.025, 0.5, 0.975)
TIME, SPEED = "time at the end of the rail, s", "speed at the end of the rail, m/s"


def rate_name(axis: str) -> str:
    """The name of the rate about ``axis`` at the exit."""
    return f"rate {axis} at the exit, deg/s"


LATERAL = "lateral rate at the exit, deg/s"
# kinds of rattling: names of the rates, and their axes
BY_AXIS: dict[str, Sequence[int]] = {"rate x": (0,), "rate y": (1,), "rate z": (2,)}
BY_SIZE: dict[str, Sequence[int]] = {"roll rate": (0,), "lateral rate": (1, 2)}


class Stated(NamedTuple):
    """A measured value, its standard uncertainty, None where the noise is in the predictions, and the half
    width that contains the true value with 95 % probability."""

    value: float
    uncertainty: float | None = None
    expanded: float | None = None


@dataclass(frozen=True)
class ComparedValue:
    """One comparison: the ``measured`` value with its uncertainties as ``Stated``, the predicted range (2.5, 50,
    97.5 %) of each model, the share of values of the first model below the measured one, and whether the
    measured one is inside the 95 % range of each model."""

    quantity: str
    unit: str
    measured: float
    uncertainty: float | None
    expanded: float | None
    ranges: dict[str, list[float]]
    rank: float
    inside: dict[str, bool]


def over_way(own: Record, rate: np.ndarray, kinds: Mapping[str, Sequence[int]]) -> dict[str, float]:
    """Root mean square (deg/s) of each kind of ``rate`` (n,3) rad/s at the instants of the record, in equal
    parts of the way on the rail."""
    degrees, found = np.degrees(rate), {}
    ends = np.linspace(0.0, float(np.interp(own.exit[0], own.time, own.way)), PARTS + 1)
    on = on_rail(own)
    for kind, axes in kinds.items():
        for low, high in itertools.pairwise(ends):
            part = on & (own.way >= low) & (own.way <= high)
            found[f"rms of {kind}, {low:.1f} to {high:.1f} m, deg/s"] = _rms(degrees[part][:, axes])
    return found


def on_rail(own: Record) -> np.ndarray:
    """Whether a sample (n,) is on the rail, and not of the first jolt."""
    return (own.time >= min(_SETTLED, 0.25 * own.exit[0])) & (own.time <= own.exit[0])


def over_frequency(
    own: Record,
    rate: np.ndarray,
    kinds: Mapping[str, Sequence[int]],
    edges: Sequence[float],
) -> dict[str, float]:
    """The same on the whole rail, in bands of frequency between ``edges`` (Hz)."""
    found = {}
    grid = np.arange(_SETTLED, own.exit[0], own.interval)
    for kind, axes in kinds.items():
        even = np.column_stack(
            [np.interp(grid, own.time, np.degrees(rate[:, axis])) for axis in axes]
        )
        power = np.abs(np.fft.rfft(even - even.mean(axis=0), axis=0)) ** 2
        frequency = np.fft.rfftfreq(grid.size, grid[1] - grid[0])
        for low, high in itertools.pairwise(edges):
            band = (frequency >= low) & (frequency < high)
            value = math.sqrt(2.0 * float(power[band].sum())) / grid.size
            found[f"rms of {kind}, {low:g} to {high:g} Hz, deg/s"] = value
    return found


def impacts(own: Record, rate: np.ndarray, jump: float) -> dict[str, float]:
    """Changes of a rate between two samples on the rail by more than ``jump`` (deg/s): their number, the first
    and the last. Without any, both instants are that of the exit."""
    on = on_rail(own)
    jumps = np.abs(np.diff(np.degrees(rate)[on], axis=0)).max(axis=1) > jump
    instants = own.time[on][1:][jumps]
    return {
        "impacts: jumps of a rate, number": float(jumps.sum()),
        "impacts: first, s": float(instants[0]) if instants.size else own.exit[0],
        "impacts: last, s": float(instants[-1]) if instants.size else own.exit[0],
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).sum(axis=1).mean())) if len(values) else 0.0


def blurred(
    stated: Mapping[str, Stated],
    left: tuple[float, float],
    rate: np.ndarray,
    generator: np.random.Generator,
) -> dict[str, float]:
    """Time (s) and speed (m/s) at the end of the rail, ``left``, and ``rate`` (3,) rad/s at the exit of a run,
    with errors of the ``stated`` uncertainties of the measurement."""
    values = [*left, *np.degrees(rate)]
    found = {
        name: value + (stated[name].uncertainty or 0.0) * generator.standard_normal()
        for name, value in zip(stated, values)
    }
    found[LATERAL] = math.hypot(*(found[rate_name(axis)] for axis in "yz"))
    return found


def table(
    stated: Mapping[str, Stated],
    found: Mapping[str, Sequence[Mapping[str, float]]],
) -> list[ComparedValue]:
    """Every comparison of the ``stated`` measured values with those ``found`` by each model."""
    rows = []
    for name, (value, uncertainty, expanded) in stated.items():
        values = {model: [one[name] for one in draws] for model, draws in found.items() if draws}
        ranges = {model: np.quantile(one, SHARES).tolist() for model, one in values.items()}
        inside = {model: ends[0] <= value <= ends[2] for model, ends in ranges.items()}
        quantity, _, unit = name.rpartition(", ")
        rank = share_below(next(iter(values.values())), value)
        rows.append(
            ComparedValue(quantity, unit, value, uncertainty, expanded, ranges, rank, inside)
        )
    return rows


def share_below(values: Sequence[float], value: float) -> float:
    """The share of ``values`` below ``value``; equal ones count half."""
    every = np.array(values)
    return float(((every < value).sum() + 0.5 * (every == value).sum()) / every.size)
