"""The change of rate by ejection, with a budget of its uncertainty according to the GUM.

    d = w_1 - w_0
    w_0   mean over the reference window
    w_1   line through the settled window, at the instant of simulations
    u_c^2 = sum of squares of the standard uncertainties below
    U = k u_c,   k = t(95 %, nu_eff)   (Welch, Satterthwaite)

| part | standard uncertainty of component i | kind |
|---|---|---|
| noise | sigma sqrt(tau sum w^2), from residuals in both windows | A |
| bias instability | from B and the weights (below) | B |
| scale | u(s) abs(d_i) | B |
| misalignment, mounting | u(E) sqrt(sum over j != i of d_j^2) | B |
| g-sensitivity | u(G) times the change of specific force between the windows | B |
| temperature | u(c) times the change of temperature between the windows | B |
| quantisation | q sqrt(tau sum w^2 / 12); q sqrt(2/12) where noise does not spread it | B |
| bent line | a free tumble bends: w'' = 2 w'^2 / w for equations quadratic in w; rectangular | B |
| instant | slope times u(exit); without a channel class also one interval, rectangular | B |

The noise of d = sum_i w_i x_i, which is linear in the samples:

* White and short-correlated noise: variance sigma^2 tau sum w^2, with the integrated correlation time in
  samples tau = 1 + 2 sum_k rho_k, summed up to the first lag L >= 5 tau (Sokal) and at least one. A fit
  to the samples reduces every rho by tau/n; the factor 1 + (2 L + 1)/n corrects this (Wolff, Comput.
  Phys. Commun. 156, 2004).
* Bias instability B: two-sided density B^2 / (2 pi f) (IEEE 952), so the variance is the integral of
  density times |W(f)|^2, with the transform W of the weights. It is finite since a difference has W(0) =
  0.

The samples are not filtered here: a mean needs no filter, and a filter would spread the burn into the
windows.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.faults import Fault, SceneError
from tipoff.studies.measured.events import Spans, inside
from tipoff.studies.measured.log import Calibrated
from tipoff.studies.measured.sheet import Sheet

COVERAGE = 0.95
_FITTED = 3  # parameters: a mean before, a straight line after
_TINY = 1e-15  # rad/s; smaller noise counts as none
# probability of such a residual by chance; below it, the payload is not in free motion
_UNSETTLED = 1e-5
_OVER_TAU = 5.0
_PADDED = 16  # times the span of the weights: resolution of low frequencies


class Reduced(NamedTuple):
    """Rates (3,) rad/s before ignition and after exit, their ``change``; ``parts``: standard
    uncertainties (3,) by name; ``combined`` (3,), ``factor`` (3,) of expansion; noise of one sample
    (3,) rad/s, its correlation time in samples."""

    before: np.ndarray
    after: np.ndarray
    change: np.ndarray
    parts: dict[str, np.ndarray]
    combined: np.ndarray
    factor: np.ndarray
    noise: np.ndarray
    correlation: float


def reduced(sheet: Sheet, found: Calibrated, spans: Spans, source: str) -> Reduced:
    """The change of rate. Raises SceneError if the rate is not settled."""
    calm, settled = inside(found.time, spans.reference), inside(found.time, spans.settled)
    away = found.time[settled] - found.time[settled].mean()
    lever, spread = spans.instant - found.time[settled].mean(), float((away**2).sum())
    weights = np.zeros(found.time.size)
    weights[calm], weights[settled] = -1.0 / calm.size, 1.0 / settled.size + lever * away / spread
    before, middle = found.rate[calm].mean(axis=0), found.rate[settled].mean(axis=0)
    slope = away @ found.rate[settled] / spread
    after = middle + lever * slope
    residuals = [found.rate[calm] - before, found.rate[settled] - middle - np.outer(away, slope)]
    tau = correlation_time(residuals, _FITTED)
    freedom = max(1.0, calm.size + settled.size - _FITTED * tau)
    sigma = np.sqrt(sum((stretch**2).sum(axis=0) for stretch in residuals) / freedom)
    change, length = after - before, spans.settled[1] - spans.settled[0]
    bend = 2.0 * slope**2 / np.maximum(np.abs(after), np.maximum(sigma, _TINY))
    _require_settled(
        residuals, tau, bend * length**2 / np.sqrt(720.0), sheet.gyro.resolution, source
    )
    parts = {"noise": sigma * np.sqrt(tau * (weights**2).sum())} | _systematic(
        sheet, found, change, weights, (calm, settled)
    )
    parts["quantisation"] = quantised(sheet.gyro.resolution, sigma, tau * (weights**2).sum())
    parts["bent line"] = 0.5 * bend * abs(lever**2 - length**2 / 12.0) / np.sqrt(3.0)
    parts["instant"] = np.abs(slope) * _uncertain_instant(sheet, found)
    combined = np.sqrt(sum(part**2 for part in parts.values()))
    # All other parts have infinite degrees of freedom. With little noise the factor is that of a
    # normal distribution.
    effective = freedom / tau / np.maximum(parts["noise"] / np.maximum(combined, _TINY), 1e-2) ** 4
    return Reduced(
        before,
        after,
        change=change,
        parts=parts,
        combined=combined,
        factor=scipy.stats.t.ppf(0.5 + 0.5 * COVERAGE, effective),
        noise=sigma,
        correlation=tau,
    )


def _systematic(
    sheet: Sheet, found: Calibrated, change: np.ndarray, weights: np.ndarray, windows
) -> dict[str, np.ndarray]:
    """Parts from the uncertainty of the calibration. Scale and misalignment act on the change
    alone, because both rates have the same errors."""
    sure, interval = sheet.gyro.uncertainty, found.time[1] - found.time[0]
    across = np.sqrt((change**2).sum() - change**2)
    calm, settled = windows

    def moved(values) -> np.ndarray | float:
        return 0.0 if values is None else values[settled].mean(axis=0) - values[calm].mean(axis=0)

    return {
        "bias instability": np.full(
            3, np.sqrt(instability_variance(weights, interval, sure.bias_instability))
        ),
        "scale": sure.scale * np.abs(change),
        "misalignment": sure.misalignment * across,
        "g-sensitivity": np.full(3, sure.g_sensitivity * np.linalg.norm(moved(found.force))),
        "temperature": np.full(3, sure.temperature * np.abs(moved(found.temperature))),
    }


def _uncertain_instant(sheet: Sheet, found: Calibrated) -> float:
    """Of the exit (s). A log without a channel class may be slow: the ignition is then known to one
    interval (rectangular)."""
    interval = 0.0 if sheet.channel_class else float(found.time[1] - found.time[0])
    return float(np.hypot(sheet.windows.exit_uncertainty, interval / np.sqrt(12.0)))


def quantised(resolution: float, sigma: np.ndarray, factor: float) -> np.ndarray:
    """Part of the rounding. Noise of half a step or more makes rounding random, and a mean reduces
    it; with less noise, a mean may be wrong by a whole rounding error."""
    return np.where(
        sigma >= 0.5 * resolution,
        resolution * np.sqrt(factor / 12.0),
        resolution * np.sqrt(2.0 / 12.0),
    )


def _require_settled(
    residuals: list[np.ndarray], tau: float, bent: np.ndarray, resolution: float, source: str
) -> None:
    """Check that residuals of the straight line are noise as small as in the reference window plus
    the ``bent`` (3,) rad/s of a free tumble. A rate between two steps of the ``resolution``, with noise
    below half a step, is rounded to either: its variance is up to a quarter of the square of a step.
    Raises SceneError otherwise."""
    calm, settled = (
        (stretch**2).sum(axis=0) / (len(stretch) - lost) for stretch, lost in zip(residuals, (1, 2))
    )
    freedom = [max(1.0, len(stretch) / tau) for stretch in residuals]
    expected = np.maximum(calm, resolution**2 / 4.0 + _TINY**2)
    chance = scipy.stats.f.sf((settled - bent**2) / expected, freedom[1], freedom[0])
    if (chance < _UNSETTLED).any():
        worst = int(np.argmin(chance))
        given = f"{np.degrees(np.sqrt(settled[worst])):.3g} deg/s of scatter about {'xyz'[worst]}"
        expected = (
            f"the {np.degrees(np.sqrt(calm[worst])):.3g} deg/s of free fall; is "
            f"windows.exit too early?"
        )
        raise SceneError([Fault(source, "settled window", given, expected)])


def correlation_time(residuals: list[np.ndarray], fitted: int = 1) -> float:
    """tau from several intervals (n_i,3) of residuals of one sensor after a fit of ``fitted``
    parameters in all."""
    count, scales = sum(map(len, residuals)), sum((stretch**2).sum(axis=0) for stretch in residuals)
    if not scales.all():
        return 1.0  # rounded to a constant: no noise is visible
    raw = tau = 1.0
    for lag in range(1, max(map(len, residuals)) // 2):
        pairs = sum(max(len(stretch) - lag, 0) for stretch in residuals)
        rho = (
            sum((stretch[lag:] * stretch[:-lag]).sum(axis=0) for stretch in residuals)
            / pairs
            / (scales / count)
        )
        raw += 2.0 * float(rho.mean())
        tau = raw * (1.0 + fitted * (2.0 * lag + 1.0) / count)
        if lag >= _OVER_TAU * tau:
            break
    return max(tau, 1.0)


def instability_variance(weights: np.ndarray, interval: float, instability: float) -> float:
    """Variance by bias instability (rad/s) of a sum of samples every ``interval`` (s) with
    ``weights`` (n,)."""
    length = _PADDED * weights.size
    frequency = np.fft.rfftfreq(length, interval)[1:]
    power = np.abs(np.fft.rfft(weights, length)[1:]) ** 2
    return float(2.0 * (instability**2 / (2.0 * np.pi * frequency) * power).sum() * frequency[0])
