"""Curves of a run, of another code or of a test: v_x and body rates over time, and the settled
values.

A file has no positions, and so no exit. Its settled window of 2 ms ends with the record, or starts
at a time given by the user. Settled values are means over the window (``mechanics.outcome``).
"""

from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.comparison.layout import OF_THE_FORMAT, RATES, Layout
from tipoff.comparison.quantities import read_quantities
from tipoff.faults import Fault, SceneError
from tipoff.mechanics.run_limits import SETTLE_WINDOW
from tipoff.results.trajectory import Trajectory
from tipoff.units import duration

# s; a pad contact lasts milliseconds, and the settled window needs several samples
LONGEST_STEP = 0.5 * SETTLE_WINDOW
_ROUNDING = 1e-9  # s; times are decimal numbers in a file, in any unit
_SECTION = "(file formats, Curves)"  # of the documentation, in every refusal


class Curves(NamedTuple):
    """Curves from ignition to the end of the settled window."""

    time: np.ndarray  # (n,) s
    velocity: np.ndarray  # (n,) m/s, inertial v_x in scene axes
    rate: np.ndarray  # (n,3) rad/s, inertial rates in body axes
    window_start: float  # s
    settled: np.ndarray  # (3,) rad/s, means of the rates over the window
    source: str  # text on the source of the curves

    @classmethod
    def from_trajectory(cls, run: Trajectory, settled_from: float | None = None) -> "Curves":
        """Curves of a run that exited and settled. Its window begins at ``settled_from`` (s) if the
        run has this window."""
        start, settled = run.outcome.window_start, np.array(run.outcome.rate)
        assert start is not None  # true for every settled run
        if settled_from is not None and settled_from <= run.time[-1] - SETTLE_WINDOW:
            start, settled = settled_from, _mean(run.time, run.rate, settled_from)
        keep = _until(run.time, start)
        return cls(
            run.time[keep],
            run.velocity[keep, 0],
            run.rate[keep],
            start,
            settled,
            f"{run.model} {run.numerics}",
        )

    @classmethod
    def read(
        cls,
        path: str | Path,
        settled_from: float | None = None,
        layout: Layout = OF_THE_FORMAT,
        optional: Collection[str] = (),
    ) -> "Curves":
        """Curves of a file of any format that ``formats.curves`` knows; the window begins at
        ``settled_from`` (s), or ends with the record. Without velocity_x, if that is ``optional``,
        the velocity is NaN.

        Raises SceneError with every fault: an unreadable file, columns or units that are missing or
        of another kind, cells without a finite number, times that do not increase from ignition or
        have a gap, a record too short for the window.
        """
        found, faults, digest = read_quantities(path, layout, optional)
        if "time" in found:
            faults = faults + _time_faults(str(path), found["time"], settled_from)
        if faults:
            raise SceneError(
                [item._replace(expected=f"{item.expected} {_SECTION}") for item in faults]
            )
        time = found["time"]
        velocity = found.get("velocity_x", np.full(time.size, np.nan))
        rate = np.column_stack([found[name] for name in RATES])
        start = max(time[0], time[-1] - SETTLE_WINDOW) if settled_from is None else settled_from
        keep = _until(time, start)
        return cls(
            time[keep],
            velocity[keep],
            rate[keep],
            float(start),
            _mean(time, rate, start),
            f"{path}, SHA-256 {digest}, settled from {duration(start)}"
            + (f"; {layout.words}" if layout.words else ""),
        )


def _until(time: np.ndarray, start: float) -> np.ndarray:
    return time <= (start + SETTLE_WINDOW) * (1.0 + 1e-12)


def _mean(time: np.ndarray, values: np.ndarray, start: float) -> np.ndarray:
    """Means (k,) of ``values`` (n,k) over the window, linear between samples: they may be noisy and
    unevenly spaced."""
    end = min(start + SETTLE_WINDOW, time[-1])
    inside = np.concatenate([[start], time[(time > start) & (time < end)], [end]])
    lines = np.column_stack([np.interp(inside, time, column) for column in values.T])
    return np.trapezoid(lines, inside, axis=0) / (end - start)


def _time_faults(source: str, time: np.ndarray, settled_from: float | None) -> list[Fault]:
    if time.size < 2:
        return [Fault(source, "time", f"{time.size} samples", "a record")]
    steps, latest = np.diff(time), time[-1] - SETTLE_WINDOW
    back, gap = int(np.argmin(steps)), int(np.argmax(steps))
    found = []
    if steps[back] <= 0.0:
        found.append(
            (
                f"{duration(time[back + 1])} after {duration(time[back])}",
                "times that rise from line to line",
            )
        )
    if not -_ROUNDING <= time[0] <= LONGEST_STEP + _ROUNDING:
        found.append(
            (
                f"{duration(time[0])} first",
                f"time since ignition, from 0 to {duration(LONGEST_STEP)} on",
            )
        )
    if steps[gap] > LONGEST_STEP + _ROUNDING:
        found.append(
            (
                f"a gap from {duration(time[gap])} to {duration(time[gap + 1])}",
                f"steps of {duration(LONGEST_STEP)} at most{_likely_unit(steps[gap])}",
            )
        )
    if latest < time[0] - _ROUNDING:
        found.append(
            (
                f"a record of {duration(time[-1] - time[0])}",
                f"at least the settled window of {duration(SETTLE_WINDOW)}",
            )
        )
    elif settled_from is not None and not (
        time[0] - _ROUNDING <= settled_from <= latest + _ROUNDING
    ):
        found.append(
            (
                f"settled from {duration(settled_from)}",
                f"{duration(time[0])} to {duration(latest)}, to leave {duration(SETTLE_WINDOW)}",
            )
        )
    return [Fault(source, "time", *fault) for fault in found]


def _likely_unit(step: float) -> str:
    """Likely unit of the time column from the size of a ``step`` (s), as the end of a message."""
    for factor, words in ((1e-3, "ms with the unit s"), (1e-6, "us with the unit s")):
        if LONGEST_STEP < step and factor * step <= 0.5 * LONGEST_STEP and step >= 10e-3:
            return f" (likely cause: values in {words})"
    return ""
