"""A comparison with another code: one case, solved here and by the peer from the same inputs."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np


class PeerMissing(RuntimeError):
    """The peer is not installed here; the message says how to install it."""


class Unfinished(RuntimeError):
    """A run that did not do what was asked, of a peer or of ours; the message says what."""


def require_finished(code: str, time: float, asked: float, *numbers: Any) -> None:
    """Raise Unfinished unless the ``code`` reached the ``time`` (s) that was ``asked`` and all its
    ``numbers`` (arrays) are finite."""
    if not abs(time - asked) <= _ROUNDED * abs(asked):
        raise Unfinished(f"{code} ended at {time:.9g} s, asked was {asked:.9g} s")
    if not all(np.isfinite(each).all() for each in numbers):
        raise Unfinished(f"{code} has values that are not finite")


def require_count(code: str, what: str, found: int, asked: int) -> None:
    """Raise Unfinished unless a ``code`` has as many of ``what`` as were asked."""
    if found != asked:
        raise Unfinished(f"{code} has {found:,} {what}, asked were {asked:,}")


def require_ours(run: Any, status: str, until: float | None = None) -> None:
    """Raise Unfinished unless a ``run`` of ours has the ``status``, no message, and the end ``until``
    (s)."""
    if run.status != status or run.message:
        raise Unfinished(f"{OURS}: {run.status}, asked was {status}; {run.message}")
    if until is not None:
        require_finished(OURS, float(run.time[-1]), until)


class Point(NamedTuple):
    """Error (%) and processor time (s) of a ``code`` with a ``setting``."""

    code: str
    setting: str
    error: float
    cpu_s: float


OURS = "tipoff"
_LONG = 2.0  # s
_ROUNDED = 1e-6  # relative, of an end time: seven digits are printed


@dataclass(frozen=True)
class Case:
    """One case.

    ``name`` is unique; ``title`` is for the page. ``inputs``: plain values, kept with the result.
    ``matched``: properties that are equal on both sides; ``unmatched``: properties that the peer
    lacks. ``settings``: meshes or conditions. ``units``: the unit of each quantity. ``ours`` and
    ``theirs`` map a setting to quantities in these units, and to ``cpu_s``, the processor time, if
    they measure it themselves. ``within`` maps a setting and a quantity to the largest difference,
    relative to the largest value of this quantity. ``slow``: settings that take more than a few
    seconds here. ``work``: points of the diagram of work and precision, with the quantity of their
    error.
    """

    name: str
    title: str
    inputs: Callable[[], Mapping[str, Any]]
    matched: str
    unmatched: str
    settings: tuple[str, ...]
    units: Mapping[str, str]
    ours: Callable[[str], Mapping[str, float]]
    theirs: Callable[[str], Mapping[str, float]]
    within: Callable[[str, str], float]
    slow: tuple[str, ...] = ()
    work: Callable[[], list[Point]] | None = None
    error_of: str = ""


@dataclass(frozen=True)
class Peer:
    """Another code. ``version`` raises PeerMissing if it is not installed."""

    name: str
    what: str
    version: Callable[[], str]
    cases: Callable[[], tuple[Case, ...]]


def timed(solve: Callable[[], Mapping[str, float]]) -> tuple[dict[str, float], float]:
    """The result of ``solve``, and its processor time (s): as measured by ``solve`` itself, or else
    of the call. A short call is repeated for the time, because compilation may be most of it."""
    began = time.process_time()
    found = dict(solve())
    spent = time.process_time() - began
    if "cpu_s" in found:
        return found, found.pop("cpu_s")
    if spent < _LONG:
        began = time.process_time()
        solve()
        spent = time.process_time() - began
    return found, spent


def extrapolated(coarse: Mapping[str, float], fine: Mapping[str, float]) -> dict[str, float]:
    """Quantities without discretisation error, from elements of some size and of half of it, if the
    error falls with its second power."""
    return {name: value + (value - coarse[name]) / 3.0 for name, value in fine.items()}


def percent(value: float, exact: float) -> float:
    """Relative error in per cent."""
    return 100.0 * abs(value / exact - 1.0)
