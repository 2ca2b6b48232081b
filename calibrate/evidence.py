"""Evidence of calibrated constants: residuals per condition, weak directions, intervals,
provenance."""

import math

import numpy as np

from tipoff.calibration import information
from tipoff.calibration.intervals import half_widths, independent
from tipoff.calibration.objective import Parts, Target
from tipoff.calibration.parameters import Parameter
from tipoff.calibration.search import Found, Plan
from tipoff.comparison.curves import Curves
from tipoff.scenes.scene import Scene

_ON_BOUND = 1e-3  # share of the bounds; a closer value counts as on the bound
_NOTHING = 1e-12  # of the largest eigenvalue of the information matrix; less is rounding
_ALIKE = 0.1  # remaining share of its information, below which a parameter acts like others


def residuals(part: Parts, wanted: Target) -> dict[str, float]:
    """Relative L2 of rates and of v_x, and the largest settled error of an axis (deg/s)."""
    return {
        "rate_relative_l2": float(np.sqrt((part.rate**2).sum())),
        "velocity_relative_l2": float(np.sqrt((part.velocity**2).sum())),
        "settled_rate_error_deg_s": math.degrees(
            float(np.abs(part.settled).max()) * wanted.amplitudes[2]
        ),
    }


def weak_directions(
    scene: Scene,
    free: list[Parameter],
    held: list[Parameter],
    shares: np.ndarray,
    matrix: np.ndarray,
    ratio: float = information.WEAK_RATIO,
) -> list[str]:
    """Sentences on weak directions (``information.weak``), on parameters held because of them, and
    on values at a bound.

    ``matrix`` is the information on free and held parameters together, in this order.
    """
    count = len(free)
    inner, names = matrix[:count, :count], [item.name for item in free]
    sentences = information.weak_directions(inner, names, ratio)
    sentences += [
        f"{item.name} held at {item.read(scene):.4g} {item.unit}: {_why(matrix, names, index)}"
        for index, item in enumerate(held, start=count)
    ]
    for item, share, bound in zip(free, shares, _on_bound(shares)):
        if bound:
            side = "lower" if share < 0.5 else "upper"
            sentences.append(
                f"{item.name} lies on its {side} bound {item.value(round(float(share))):.4g} "
                f"{item.unit}: physics, "
                "not the curves, sets its value"
            )
    return sentences


def _why(matrix: np.ndarray, names: list[str], index: int) -> str:
    """Reason why the parameter ``index``, not one of the fitted ``names`` at the start, is held."""
    fitted, alone = range(len(names)), matrix[index, index]
    left = information.left_alone(matrix, index, fitted)
    largest = float(np.linalg.eigvalsh(matrix)[-1])
    if alone <= _NOTHING * largest:
        return "at these constants it has no effect"
    found = (
        f"of its information {alone:.2g} only {left:.2g} is left when the others are fitted again"
    )
    alike = information.acts_as(matrix, index, fitted)
    if left < _ALIKE * alone and alike.any():
        like = information.combination(alike / np.linalg.norm(alike), names)
        found += f", since it acts as {like}"
    return f"{found}, {left / largest:.1e} of the largest eigenvalue"


def intervals(
    free: list[Parameter], shares: np.ndarray, matrix: np.ndarray, parts: list[Parts]
) -> tuple[list[list[float]], float]:
    """Interval of every free parameter (SI), and the number of independent residuals.

    Infinite if the curves do not determine the parameter: in a weak direction, on a bound, or with
    an interval wider than the bounds, where linear theory is not valid.
    """
    curves = [curve for part in parts for curve in (part.velocity, *part.rate.T)]
    count = sum(map(independent, curves))
    # the value of the objective, from which the matrix was made
    squares = sum(float(part.vector() @ part.vector()) for part in parts) / len(parts)
    half = half_widths(matrix, squares, count, [item.vector for item in information.weak(matrix)])
    return ends(free, shares, half), count


def ends(free: list[Parameter], shares: np.ndarray, half: np.ndarray) -> list[list[float]]:
    """Ends (SI) of intervals of half widths (p,) about the ``shares``; infinite for a parameter on
    a bound or with an interval wider than the bounds."""
    bounded = (half < 0.5) & ~_on_bound(shares)
    return [
        [item.value(share - width), item.value(share + width)] if inside else [-math.inf, math.inf]
        for item, share, width, inside in zip(free, shares.tolist(), half.tolist(), bounded)
    ]


def _on_bound(shares: np.ndarray) -> np.ndarray:
    return (shares <= _ON_BOUND) | (shares >= 1.0 - _ON_BOUND)


def provenance(
    scene: Scene,
    references: dict[str, Curves],
    constants: dict[str, float],
    found: Found,
    plan: Plan,
    evaluations: int,
    intervals: str,
) -> dict[str, str]:
    """Text and hashes on the source of the constants, with the basis of the ``intervals``."""
    exponent, stiffness = constants.get("contact.exponent", 1.0), constants.get("contact.stiffness")
    basins = "; ".join(
        f"{value:.6g} at " + ", ".join(f"{share:.4f}" for share in shares)
        for value, shares in found.basins
    )
    law = "compliant contact" if scene.contact is not None else "none"
    if scene.contact is not None and stiffness is not None:
        law = f"{scene.contact.law}, k = {stiffness:.6g} N/m^{exponent:.6g}"
    return {
        "scene": scene.name,
        "scene_hash": scene.hash,
        "contact_law": law,
        "references": ", ".join(f"{name}: {item.source}" for name, item in references.items()),
        "search": f"{plan.points} Sobol' points, {_starts(found, plan)}, least squares; "
        f"{evaluations} evaluations; "
        f"seed {plan.seed}",
        "intervals": f"95 %, linear, {intervals}",
        "basins": f"each start ended at objective and shares of the bounds: {basins}",
    }


def _starts(found: Found, plan: Plan) -> str:
    if found.shares.size > 1:
        return f"{plan.starts} starts of CMA-ES"
    return f"scalar searches from {len(found.basins) - 1} local minima"
