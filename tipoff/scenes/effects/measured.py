"""A measured thrust curve: reading, checking, and its least-squares Gaussian fit."""

import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used


class MeasuredCurve(NamedTuple):
    """Times (s, strictly increasing, >= 0) and forces (N), each (n,) with n >= 2."""

    time: np.ndarray
    force: np.ndarray


class GaussianFit(NamedTuple):
    """Peak (N), centre and width (s), relative L2 residual, impulse of the fit and of the curve (N
    s)."""

    peak: float
    centre: float
    width: float
    relative_residual: float
    impulse: float
    curve_impulse: float


def read_curve(path: str | Path) -> MeasuredCurve:
    """Read a CSV with header ``time_s,force_N``. Raises ValueError naming everything that is wrong
    with the table."""
    try:
        # Spreadsheets put a byte-order mark in front of UTF-8, which "utf-8-sig" takes away.
        with open(path, newline="", encoding="utf-8-sig") as stream:
            rows = list(csv.reader(stream))
    except OSError as error:
        raise ValueError(f"a readable CSV file ({error.strerror})") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"a CSV file of text ({error})") from error
    if not rows or [cell.strip() for cell in rows[0]] != ["time_s", "force_N"]:
        raise ValueError("a CSV whose header is time_s,force_N")
    try:
        data = [(float(time), float(force)) for time, force in filter(None, rows[1:])]
    except ValueError as error:
        raise ValueError(f"two numbers in every row ({error})") from error
    time, force = np.array(data, dtype=float).reshape(-1, 2).T
    wrong = []
    if time.size < 2:
        wrong.append("at least two rows")
    if not (np.isfinite(time).all() and np.isfinite(force).all()):
        wrong.append("finite numbers only")
    if (time < 0.0).any():
        wrong.append("times that are not negative")
    if (np.diff(time[np.isfinite(time)]) <= 0.0).any():
        wrong.append("times in increasing order")
    if wrong:
        raise ValueError("a curve with " + ", ".join(wrong))
    return MeasuredCurve(np.ascontiguousarray(time), np.ascontiguousarray(force))


def fit_gaussian(curve: MeasuredCurve) -> GaussianFit:
    """Least-squares Gaussian through a measured curve, started from its moments. Raises ValueError
    where none fits."""
    time, force = curve
    total = np.trapezoid(force, time)
    if time.size < 4 or total <= 0.0:
        raise ValueError(
            "a curve of at least four points and positive impulse, for a Gaussian to fit"
        )

    def gaussian(t, peak, centre, width):
        return peak * np.exp(-0.5 * ((t - centre) / width) ** 2)

    centre = np.trapezoid(force * time, time) / total
    width = math.sqrt(
        max(np.trapezoid(force * (time - centre) ** 2, time) / total, np.diff(time).min() ** 2)
    )
    start = (total / (width * math.sqrt(2.0 * math.pi)), centre, width)
    try:
        (peak, centre, width), _ = scipy.optimize.curve_fit(
            gaussian, time, force, p0=start, maxfev=20000
        )
    except RuntimeError as error:
        raise ValueError("a curve that a Gaussian fits (least squares did not converge)") from error
    peak, centre, width = float(peak), float(centre), abs(float(width))
    # A flat curve is fitted perfectly by an endless Gaussian, which would push long after the burn.
    if not time[0] <= centre <= time[-1] or width > 0.5 * (time[-1] - time[0]):
        raise ValueError(
            f"a curve that a Gaussian fits (found centre {centre:.4g} s, width {width:.4g} s, "
            f"for a curve from {time[0]:.4g} to {time[-1]:.4g} s)"
        )
    residual = np.linalg.norm(force - gaussian(time, peak, centre, width)) / np.linalg.norm(force)
    return GaussianFit(
        peak, centre, width, float(residual), peak * width * math.sqrt(2.0 * math.pi), float(total)
    )
