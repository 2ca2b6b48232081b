"""A measured thrust curve: reading, checking, and its least-squares Gaussian fit."""

import math
import warnings
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.files import read_input
from tipoff.scenes import csv_file
from tipoff.scenes.faults import SceneError

_HEADER = ["time_s", "force_N"]
FIT_IMPULSE = 0.02  # of the impulse of a curve: largest error of its fit by default


class MeasuredCurve(NamedTuple):
    """A measured curve of n >= 2 points. A repeated time is a jump, from the first force to the
    second."""

    time: np.ndarray  # (n,) s, >= 0, increasing
    force: np.ndarray  # (n,) N


class GaussianFit(NamedTuple):
    """Least-squares Gaussian of a measured curve."""

    peak: float  # N
    centre: float  # s
    width: float  # s
    relative_residual: float  # L2
    impulse: float  # N s, of the fit
    curve_impulse: float  # N s

    @property
    def impulse_error(self) -> float:
        """Relative error of the effective impulse: of the Gaussian after ignition, where a scene
        begins."""
        before = 0.5 * math.erfc(self.centre / (math.sqrt(2.0) * self.width))
        return self.impulse * (1.0 - before) / self.curve_impulse - 1.0


def read_curve(path: str | Path) -> MeasuredCurve:
    """Read a CSV with header ``time_s,force_N``. A time in two rows is a jump. Raises ValueError
    with every fault of the table."""
    try:
        data = read_input(path)
    except OSError as error:
        raise ValueError(f"a readable CSV file ({error.strerror or error})") from error
    return MeasuredCurve(*(values.copy() for values in _parsed(str(path), data)))


# Each condition and each variation of a scene reads its curve. Equal bytes give an equal curve.
@lru_cache(maxsize=4)
def _parsed(path: str, data: bytes) -> MeasuredCurve:
    try:
        table = csv_file.listed(path, data)
    except SceneError as error:
        raise ValueError(f"{error.faults[0].expected} ({error.faults[0].given})") from error
    if not table or [cell.strip() for cell in table[0][1]] != _HEADER:
        raise ValueError(f"a CSV whose header is {','.join(_HEADER)}")
    if long := [number for number, row in table[1:] if len(row) != 2]:
        raise ValueError(f"two numbers in every row (line {long[0]} has another count)")
    (time, wrong_times), (force, wrong_forces) = (
        csv_file.numbers(path, name, place, table[1:]) for place, name in enumerate(_HEADER)
    )
    wrong = [f"{f.expected} ({f.key}: {f.given})" for f in wrong_times + wrong_forces]
    if np.unique(time).size < 2:
        wrong.append("at least two different times")
    if (time < 0.0).any():
        wrong.append("times that are not negative")
    steps = np.diff(time[np.isfinite(time)])
    if (steps < 0.0).any():
        wrong.append("times in increasing order")
    if ((steps[1:] == 0.0) & (steps[:-1] == 0.0)).any():
        wrong.append("each time in at most two rows (two are a jump)")
    if wrong:
        raise ValueError("a curve with " + ", ".join(wrong))
    return MeasuredCurve(time, force)


def without_baseline(curve: MeasuredCurve, baseline: tuple[float, float] | None) -> MeasuredCurve:
    """The curve minus the straight line from the first to the last value of the ``baseline`` (N),
    readings without thrust at the first and at the last time."""
    if baseline is None:
        return curve
    share = (curve.time - curve.time[0]) / (curve.time[-1] - curve.time[0])
    line = baseline[0] + (baseline[1] - baseline[0]) * share
    return MeasuredCurve(curve.time, curve.force - line)


def fit_gaussian(curve: MeasuredCurve) -> GaussianFit:
    """Least-squares Gaussian of a measured curve, started from its moments. Raises ValueError if
    there is none."""
    found = _fitted(*(np.asarray(values, dtype=float).tobytes() for values in curve))
    if isinstance(found, str):
        raise ValueError(found)
    return found


# A search that does not converge takes a second, and each condition of a scene needs the fit.
@lru_cache(maxsize=32)
def _fitted(times: bytes, forces: bytes) -> GaussianFit | str:
    """The fit of a curve by its bytes, or the reason why there is none."""
    time, force = np.frombuffer(times), np.frombuffer(forces)
    total = float(np.trapezoid(force, time))
    if time.size < 4 or total <= 0.0:
        return "a curve of at least four points and positive impulse, for a Gaussian to fit"

    def gaussian(t, peak, centre, width):
        return peak * np.exp(-0.5 * ((t - centre) / width) ** 2)

    centre = float(np.trapezoid(force * time, time) / total)
    width = math.sqrt(
        max(
            np.trapezoid(force * (time - centre) ** 2, time) / total,
            np.diff(np.unique(time)).min() ** 2,
        )
    )
    start = (total / (width * math.sqrt(2.0 * math.pi)), centre, width)
    try:
        with warnings.catch_warnings():
            # Warnings are about the covariance, which is not used; failed fits are found below.
            warnings.simplefilter("ignore", scipy.optimize.OptimizeWarning)
            (peak, centre, width), _ = scipy.optimize.curve_fit(
                gaussian, time, force, p0=start, maxfev=20000
            )
    except RuntimeError:
        return "a curve that a Gaussian fits (least squares did not converge)"
    peak, centre, width = float(peak), float(centre), abs(float(width))
    # The best fit of a flat curve is a very wide Gaussian, with thrust long after the burn.
    if not time[0] <= centre <= time[-1] or width > 0.5 * (time[-1] - time[0]):
        return (
            f"a curve that a Gaussian fits (found centre {centre:.4g} s, width {width:.4g} s, "
            f"for a curve from {time[0]:.4g} to {time[-1]:.4g} s)"
        )
    residual = np.linalg.norm(force - gaussian(time, peak, centre, width)) / np.linalg.norm(force)
    return GaussianFit(
        peak=peak,
        centre=centre,
        width=width,
        relative_residual=float(residual),
        impulse=peak * width * math.sqrt(2.0 * math.pi),
        curve_impulse=total,
    )
