"""A measured thrust curve: reading, checking, and its least-squares Gaussian fit."""

import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import curve_fit


class MeasuredCurve(NamedTuple):
    """Times (s, strictly increasing, >= 0) and forces (N), each (n,) with n >= 2."""

    time: np.ndarray
    force: np.ndarray


class GaussianFit(NamedTuple):
    """Peak (N), centre and width (s), relative L2 residual, impulse of the fit and of the curve (N s)."""

    peak: float
    centre: float
    width: float
    relative_residual: float
    impulse: float
    curve_impulse: float


def read_curve(path: str | Path) -> MeasuredCurve:
    """Read a CSV with header ``time_s,force_N``. Raises ValueError naming what is wrong with the table."""
    try:
        with open(path, newline="") as stream:
            rows = list(csv.reader(stream))
    except OSError as error:
        raise ValueError(f"a readable CSV file ({error.strerror}: {path})") from error
    if not rows or [cell.strip() for cell in rows[0]] != ["time_s", "force_N"]:
        raise ValueError("a CSV whose header is time_s,force_N")
    try:
        data = np.array([[float(cell) for cell in row] for row in rows[1:] if row], dtype=float)
    except ValueError as error:
        raise ValueError(f"two numbers in every row ({error})") from error
    if data.ndim != 2 or data.shape[0] < 2 or data.shape[1] != 2:
        raise ValueError("at least two rows of two columns")
    if not np.isfinite(data).all():
        raise ValueError("finite numbers only")
    if data[0, 0] < 0.0:
        raise ValueError("times that are not negative")
    if (np.diff(data[:, 0]) <= 0.0).any():
        raise ValueError("times in increasing order")
    return MeasuredCurve(np.ascontiguousarray(data[:, 0]), np.ascontiguousarray(data[:, 1]))


def fit_gaussian(curve: MeasuredCurve) -> GaussianFit:
    """Least-squares Gaussian through a measured curve, started from its moments."""
    time, force = curve

    def gaussian(t, peak, centre, width):
        return peak * np.exp(-0.5 * ((t - centre) / width) ** 2)

    total = np.trapezoid(force, time)
    centre = np.trapezoid(force * time, time) / total
    width = math.sqrt(max(np.trapezoid(force * (time - centre) ** 2, time) / total, np.diff(time).min() ** 2))
    start = (total / (width * math.sqrt(2.0 * math.pi)), centre, width)
    (peak, centre, width), _ = curve_fit(gaussian, time, force, p0=start, maxfev=20000)
    width = abs(width)
    residual = np.linalg.norm(force - gaussian(time, peak, centre, width)) / np.linalg.norm(force)
    return GaussianFit(peak, centre, width, float(residual), peak * width * math.sqrt(2.0 * math.pi), float(total))
