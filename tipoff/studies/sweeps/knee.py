"""The end of growth: selects which of five simple laws fits the largest rate g over the size s of an
error best.

    proportional   g = b s
    straight       g = a + b s
    levelling      g = p (1 - exp(-s/h))                 ever slower growth, without a knee
    plateau        g = a + b min(s, k)                   growth up to k, then none
    knee           g = a + b s + c max(s - k, 0)         growth up to k, then with another slope

Each is fitted by least squares, k and h by scanning. The law with the smallest corrected
information criterion (Hurvich and Tsai, Biometrika 76, 1989) is taken::

    AICc = n ln(RSS/n) + 2 K + 2 K (K + 1)/(n - K - 1),   K = constants + 1

which penalises additional constants. An rms residual below 1/500 of the largest rate, the error of
integration of most cases, counts as 1/500. The interval of k is a percentile bootstrap: angles are drawn
again with replacement, the largest rate is taken over them, and the chosen law is fitted again. A
resample of the angles can only lower the maximum, so the interval applies to the position of the knee and
not to the height of the curve.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

RESAMPLES = 400
LAWS = ("proportional", "straight", "levelling", "plateau", "knee")
MISFIT = 0.1  # rms residual over the largest value, above which no law fits the curve
# largest growth of a plateau: beyond the knee, over the value at the knee; for a levelling curve,
# the remaining growth over its limit
LEVEL = 0.1
# of the largest value: error of 95 % of the cases at the coarsest tolerance of lowfi.Numerics
_RESOLUTION = 2e-3
_LEAST = 6  # sizes; with fewer, AICc of the knee law is not defined
_SCANNED = 121


@dataclass(frozen=True)
class Growth:
    """The chosen ``law`` and its ``verdict``; ``knee`` with the ends of its 95 % interval, None if
    the law has no knee; slopes before and after the knee (or the only slope); ``misfit``, the rms
    residual over the largest value; ``plateau_share``, the share of resamples whose verdict is a
    plateau; AICc by law."""

    law: str
    verdict: str
    knee: float | None
    low: float | None
    high: float | None
    slope_before: float | None
    slope_after: float | None
    misfit: float
    plateau_share: float
    criteria: dict[str, float]


class _Fit(NamedTuple):
    """The best of a law for curves (m,n): scanned constant (m,) or NaN, residual sums of squares
    (m,), linear constants (m,p), AICc (m,)."""

    scanned: np.ndarray
    residual: np.ndarray
    constants: np.ndarray
    criterion: np.ndarray


def growth(
    sizes: np.ndarray, values: np.ndarray, seed: int = 1, resamples: int = RESAMPLES
) -> Growth | None:
    """The growth of the largest of ``values`` (s,a), one column per angle, over ``sizes`` (s,)
    above zero. NaN marks a case that did not settle.

    None if fewer than six sizes have a value, or all values are zero.
    """
    some = np.isfinite(values).any(axis=1)
    sizes, values = np.asarray(sizes, dtype=float)[some], np.asarray(values, dtype=float)[some]
    if len(sizes) < _LEAST or not (values[np.isfinite(values)] != 0.0).any():
        return None
    drawn = np.random.default_rng(seed).integers(values.shape[1], size=(resamples, values.shape[1]))
    curves = np.vstack(
        [largest(values)[None], *(largest(values[:, angles])[None] for angles in drawn)]
    )
    curves = curves[np.isfinite(curves).all(axis=1)]
    fits = {law: _fitted(law, sizes, curves) for law in LAWS}
    chosen = np.array(LAWS)[np.argmin([fit.criterion for fit in fits.values()], axis=0)]
    verdicts = [
        _verdict(law, sizes, fits[law], curve, index)
        for index, (law, curve) in enumerate(zip(chosen, curves))
    ]
    law, fit = chosen[0], fits[chosen[0]]
    bent = law in ("plateau", "knee")
    half = 0.5 * (sizes[-2] - sizes[1]) / (_SCANNED - 1)  # half the step of the scan
    low, high = (
        np.percentile(fit.scanned[1:], (2.5, 97.5)) + np.array([-half, half])
        if bent and len(curves) > 1
        else (None, None)
    )
    before, after = _slopes(law, fit.constants[0])
    return Growth(
        str(law),
        verdicts[0],
        knee=float(fit.scanned[0]) if bent else None,
        low=None if low is None else float(low),
        high=None if high is None else float(high),
        slope_before=before,
        slope_after=after,
        misfit=_misfit(fit, curves[0], 0),
        plateau_share=float(np.mean([each == "plateau" for each in verdicts[1:]]))
        if len(curves) > 1
        else 0.0,
        criteria={name: float(item.criterion[0]) for name, item in fits.items()},
    )


def largest(values: np.ndarray) -> np.ndarray:
    """Largest (s,) of ``values`` (s,a) over the angles that settled; NaN where none did."""
    found = np.where(np.isfinite(values), values, -np.inf).max(axis=1)
    return np.where(np.isfinite(found), found, np.nan)


def _fitted(law: str, sizes: np.ndarray, curves: np.ndarray) -> _Fit:
    """Least squares of all curves at once, at the value of the scanned constant with the smallest
    residual."""
    scanned, designs = _scan(law, sizes)
    constants = np.stack([curves @ np.linalg.pinv(design).T for design in designs])
    residual = np.stack(
        [
            ((curves - found @ design.T) ** 2).sum(axis=1)
            for found, design in zip(constants, designs)
        ]
    )
    best, all_curves = residual.argmin(axis=0), np.arange(len(curves))
    count, free = len(sizes), constants.shape[2] + np.isfinite(scanned[0]) + 1
    least = residual[best, all_curves]
    counted = np.maximum(least / count, (_RESOLUTION * curves.max(axis=1)) ** 2)
    criterion = (
        count * np.log(counted) + 2.0 * free + 2.0 * free * (free + 1.0) / (count - free - 1.0)
    )
    return _Fit(scanned[best], least, constants[best, all_curves], criterion)


def _scan(law: str, sizes: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Values of the scanned constant (NaN: there is none), and for each the matrix of the linear
    constants."""
    one, none = np.ones_like(sizes), np.array([np.nan])
    if law == "proportional":
        return none, [sizes[:, None]]
    if law == "straight":
        return none, [np.column_stack([one, sizes])]
    if law == "levelling":
        widths = np.geomspace(0.05, 10.0, _SCANNED) * sizes[-1]
        return widths, [-np.expm1(-sizes / width)[:, None] for width in widths]
    places = np.linspace(sizes[1], sizes[-2], _SCANNED)  # two sizes at least on either side
    if law == "plateau":
        return places, [np.column_stack([one, np.minimum(sizes, place)]) for place in places]
    return places, [
        np.column_stack([one, sizes, np.maximum(sizes - place, 0.0)]) for place in places
    ]


def _slopes(law: str, constants: np.ndarray) -> tuple[float | None, float | None]:
    if law == "levelling":
        return None, None
    before = float(constants[0] if law == "proportional" else constants[1])
    return before, {"plateau": 0.0, "knee": float(constants[1:].sum())}.get(law, before)


def _misfit(fit: _Fit, curve: np.ndarray, index: int) -> float:
    return float(np.sqrt(fit.residual[index] / len(curve)) / curve.max())


def _verdict(law: str, sizes: np.ndarray, fit: _Fit, curve: np.ndarray, index: int) -> str:
    """The verdict for one curve: its law, or that no law fits."""
    if _misfit(fit, curve, index) > MISFIT:
        return "none of the laws"
    if law == "levelling":
        left = np.exp(-sizes[-1] / fit.scanned[index])  # share of the limit that remains
        return "levels off without a knee" if left <= LEVEL else "no plateau, grows ever slower"
    if law != "knee":
        return {
            "proportional": "no plateau, in proportion",
            "straight": "no plateau, straight",
        }.get(law, law)
    knee, (start, slope, more) = fit.scanned[index], fit.constants[index]
    there = start + slope * knee
    rise = (slope + more) * (sizes[-1] - knee)
    if abs(rise) <= LEVEL * there and slope > 0.0:
        return "plateau"
    if rise < 0.0:
        return "falls beyond the knee"
    return (
        "no plateau, grows faster beyond the knee"
        if more > 0.0
        else "no plateau, grows slower beyond the knee"
    )
