"""Constants of IMPACT and of friction from measured force, penetration, its rate and tangential
force: a fit of the law itself.

    N = max(0, k p^e + c s(p/d) q),   T = mu N   while sliding

Where a run of the whole scene sees the law through the motion it causes, a test bench sees it
directly. The fit moves logarithms of (k p_m^e, e, c, d), p_m the largest penetration, from the
start towards least squares of N; mu follows from T in closed form.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from tipoff.calibration.information import information, weak_directions
from tipoff.scenes.effects.contact import Impact, impact

NAMES = ["contact.stiffness", "contact.exponent", "contact.damping", "contact.damping_depth"]


class LawFit(NamedTuple):
    """Constants in SI; information (4,4) about the logarithms in ``NAMES`` (k taken as force at the
    largest penetration) from N over its norm; weak directions; and the relative residual of N."""

    law: Impact
    friction: float
    information: np.ndarray
    weak_directions: list[str]
    relative_residual: float


def fit(
    penetration: np.ndarray,
    closing: np.ndarray,
    normal: np.ndarray,
    tangential: np.ndarray,
    start: Impact,
) -> LawFit:
    """Fit to n samples of penetration (m), its rate (m/s), normal force (N) and size of the
    tangential force while sliding (N).

    Raises ValueError for samples that are not finite, never press, or are fewer than the constants.
    """
    columns = [
        np.asarray(column, dtype=float) for column in (penetration, closing, normal, tangential)
    ]
    p, q, force, drag = columns
    if len({column.shape for column in columns}) != 1 or p.ndim != 1 or p.size < len(NAMES):
        raise ValueError(
            f"samples: given shapes {[column.shape for column in columns]}, expected four of one "
            f"length of at least 4"
        )
    if not all(np.isfinite(column).all() for column in columns) or not (
        p.max() > 0.0 and force.any()
    ):
        raise ValueError(
            "samples: expected finite values with a penetration above zero and a force"
        )
    deepest, scale = float(p.max()), float(np.linalg.norm(force))

    def law(logarithms: np.ndarray) -> Impact:
        load, exponent, damping, depth = map(float, np.exp(logarithms))
        return Impact(load / deepest**exponent, exponent, damping, depth)

    def residuals(logarithms: np.ndarray) -> np.ndarray:
        return (normal_force(law(logarithms), p, q) - force) / scale

    first = np.log(
        [
            start.stiffness * deepest**start.exponent,
            start.exponent,
            start.damping,
            start.damping_depth,
        ]
    )
    # Tolerances at rounding: noise-free data end the iteration where nothing is left to gain.
    found = least_squares(
        residuals, first, "3-point", x_scale="jac", ftol=1e-15, xtol=1e-15, gtol=1e-15, max_nfev=200
    )
    matrix = information(found.jac)
    return LawFit(
        law(found.x),
        float(drag @ force / (force @ force)),
        matrix,
        weak_directions(matrix, NAMES),
        float(np.sqrt(2.0 * found.cost)),
    )


def normal_force(law: Impact, penetration: np.ndarray, closing: np.ndarray) -> np.ndarray:
    """N (n,) of IMPACT; zero without penetration and where the law would pull."""
    return np.array(
        [max(0.0, sum(impact(law, p, q))) if p > 0.0 else 0.0 for p, q in zip(penetration, closing)]
    )
