"""Information of the data on the parameters: the matrix J'J and its weak directions.

J is the Jacobian of the weighted residuals with respect to the parameters' shares (0..1 of their
bounds). An eigenvalue is the second-order growth of the objective per unit of its direction. A
change of sqrt(noise^2 / eigenvalue) along a direction changes the objective as much as a relative
``noise`` does.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

# Large against the surrogate's tolerance (1e-6), small against the width of a basin (about 0.1).
DIFFERENCE_STEP = 1e-3
# If curves are fitted to some percent, they do not determine a direction in which a tenth of the
# bounds changes them by 0.5 % of their amplitude.
WEAK_EIGENVALUE = (0.005 / 0.1) ** 2
WEAK_RATIO = 1e-3
ROUNDING = 1e-10  # of the largest eigenvalue: rounding of differences


def jacobian(
    residuals: Callable[[np.ndarray], np.ndarray], shares: np.ndarray, step: float = DIFFERENCE_STEP
) -> np.ndarray:
    """Central differences (n,p) of ``residuals`` at ``shares`` (p,), one-sided at the bounds of the
    unit cube."""
    columns = []
    for i in range(shares.size):
        ahead, behind = shares.copy(), shares.copy()
        ahead[i], behind[i] = min(shares[i] + step, 1.0), max(shares[i] - step, 0.0)
        columns.append((residuals(ahead) - residuals(behind)) / (ahead[i] - behind[i]))
    return np.column_stack(columns)


def information(matrix: np.ndarray) -> np.ndarray:
    """J'J (p,p), exactly symmetric."""
    product = matrix.T @ matrix
    return 0.5 * (product + product.T)


class Weak(NamedTuple):
    """A weak direction."""

    eigenvalue: float
    ratio: float  # to the largest eigenvalue
    vector: np.ndarray  # (p,) unit vector


def weak(matrix: np.ndarray, ratio: float = WEAK_RATIO) -> list[Weak]:
    """The weak directions of an information matrix (p,p), weakest first: below ``WEAK_EIGENVALUE``,
    or below ``ratio`` of the largest eigenvalue."""
    values, vectors = np.linalg.eigh(matrix)
    values = np.maximum(values, 0.0)
    ratios = values / values[-1] if values[-1] > 0.0 else values
    found = [
        Weak(float(value), float(ratio), vector)
        for value, ratio, vector in zip(values, ratios, vectors.T)
    ]
    return [item for item in found if item.ratio < ratio or item.eigenvalue < WEAK_EIGENVALUE]


def weak_directions(matrix: np.ndarray, names: list[str], ratio: float = WEAK_RATIO) -> list[str]:
    """One sentence for every weak direction, as in ``weak``."""
    return [
        f"{combination(item.vector, names)}: eigenvalue {item.eigenvalue:.2g}, {item.ratio:.1e} of "
        f"the largest"
        for item in weak(matrix, ratio)
    ]


def left_alone(matrix: np.ndarray, index: int, others: Sequence[int] | None = None) -> float:
    """Information on parameter ``index`` that remains when the ``others`` (None: all) are fitted
    again: their Schur complement."""
    if others is None:
        others = [other for other in range(len(matrix)) if other != index]
    cross = matrix[list(others), index]
    return max(0.0, float(matrix[index, index] - cross @ acts_as(matrix, index, others)))


def acts_as(matrix: np.ndarray, index: int, others: Sequence[int]) -> np.ndarray:
    """The changes (k,) of the ``others`` whose effect is closest to that of parameter ``index``."""
    places = list(others)
    inner = np.linalg.pinv(matrix[np.ix_(places, places)], hermitian=True)
    return inner @ matrix[places, index]


def combination(vector: np.ndarray, names: list[str]) -> str:
    """Text of a unit vector: shares of the bounds, largest first, without components below 0.1."""
    vector = vector if vector[np.argmax(np.abs(vector))] > 0.0 else -vector
    order = np.argsort(-np.abs(vector), kind="stable")
    terms = [f"{vector[i]:+.2f} {names[i]}" for i in order if abs(vector[i]) >= 0.1]
    return " ".join(terms)
