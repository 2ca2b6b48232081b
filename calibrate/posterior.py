"""Intervals of the parameters of a fit on compliant contact: half widths at 95 % without and with
model error (``discrepancy``), and whether the curves exclude the scene's own values.

The curves exclude the scene's values if these are outside the interval with model error in a
direction that is not weak. The level is 1 - 0.05 / k for k directions, so that all intervals hold
together with 95 % (Bonferroni). Otherwise the scene's values are kept.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.calibration import discrepancy, information
from tipoff.calibration.intervals import LEVEL, PART


class Posterior(NamedTuple):
    """Half widths in shares, infinite if the curves do not determine a parameter."""

    half: np.ndarray  # (p,) without model error
    half_with_model_error: np.ndarray  # (p,)
    excludes: bool  # whether the curves exclude the scene's own values
    words: str  # the same as text
    source: str  # basis of the intervals
    half_of_nuisances: np.ndarray  # (c,) with model error


def at_optimum(
    curves: Sequence[discrepancy.Curve],
    matrix: np.ndarray,
    shares: np.ndarray,
    own: np.ndarray,
    nuisances: np.ndarray | None = None,
) -> Posterior:
    """The posterior about the fitted ``shares`` (p,), with the ``curves`` and the information
    ``matrix`` (p,p) there; ``own`` (p,) are the scene's values. ``nuisances`` (n,c) are slopes of
    all curves, one after the other, to the nuisances of the fit, in any unit."""
    if nuisances is None:
        nuisances = np.zeros((sum(curve.time.size for curve in curves), 0))
    weak = information.weak(matrix, information.ROUNDING)
    vectors = np.linalg.eigh(matrix)[1][:, len(weak) :]
    if not vectors.size:
        none = np.full(shares.size, np.inf)
        words = "the curves determine none of these parameters; the scene's values are kept"
        unknown = np.full(nuisances.shape[1], np.inf)
        return Posterior(
            half=none,
            half_with_model_error=none,
            excludes=False,
            words=words,
            source="without information",
            half_of_nuisances=unknown,
        )
    ends = np.cumsum([curve.time.size for curve in curves])[:-1]
    seen = [
        curve._replace(slope=np.hstack([curve.slope @ vectors, more]))
        for curve, more in zip(curves, np.split(nuisances, ends))
    ]
    errors = discrepancy.likeliest(seen)
    count = vectors.shape[1]
    whole_space = np.eye(count + nuisances.shape[1])
    scatter, whole = discrepancy.deviations(
        seen, errors, np.hstack([vectors, np.zeros((shares.size, nuisances.shape[1]))])
    )
    deviation = discrepancy.deviations(seen, errors, whole_space)[1]
    along, beside = deviation[:count], deviation[count:]
    lost = np.any([np.abs(item.vector) >= PART for item in weak], axis=0) if weak else False
    scatter, whole = (np.where(lost, np.inf, found) for found in (scatter, whole))
    wide = scipy.stats.norm.ppf(1.0 - 0.5 * (1.0 - LEVEL) / along.size)
    asks = bool((np.abs(vectors.T @ (own - shares)) > wide * along).any())
    usual = scipy.stats.norm.ppf(0.5 + 0.5 * LEVEL)
    return Posterior(
        half=usual * scatter,
        half_with_model_error=usual * whole,
        excludes=asks,
        words="the curves exclude the scene's values"
        if asks
        else "nothing needs fitting: the scene's values are inside the 95 % intervals with model "
        "error, and are kept",
        source=f"from the residuals as white noise; with model error of {100.0 * errors[0]:.2g} % in "
        f"v_x and {100.0 * errors[1]:.2g} % in the rates at the end of a curve",
        half_of_nuisances=usual * beside,
    )
