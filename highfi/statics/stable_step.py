"""The largest stable step of the explicit scheme, and the step that a run uses.

Central differences are stable for

    dt <= (2 / w) (sqrt(1 + z^2) - z)

with w the highest frequency of M^-1 K in rad/s and z its damping ratio, if the damping force lags
by half a step (Belytschko, Liu, Moran, Nonlinear Finite Elements, 2000, section 6.2). There are two
bounds of w. `element_bound` is a theorem: no frequency of the assembled system exceeds the highest
one of its elements, whatever is fixed (Irons; Hughes, The Finite Element Method, 1987, section
7.3.2); joints under the mounts add at most their own largest eigenvalue to w^2. `operator_bound` is
sharper and includes contact springs.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh_tridiagonal

from tipoff.faults import InputError
from tipoff.highfi.statics.assembly import Operator
from tipoff.highfi.statics.mounts import largest_share
from tipoff.highfi.statics.operator import internal_force

_BATCH = 2048  # classes of elements treated at once; bounds the memory of an unstructured mesh
_DIVIDES = 1e-9  # allowed relative error of a requested step as a divisor of the sample interval


class StepError(InputError):
    """The requested step would be unstable or does not divide the sampling interval."""


class FrequencyBound(NamedTuple):
    """Bounds of the highest frequency of the free nodes."""

    upper: float  # rad/s, the bound to use
    ritz: float  # rad/s, a lower bound
    iterations: int  # operator calls


def element_bound(operator: Operator) -> float:
    """Upper bound (rad/s) of every frequency of the mesh: the highest of K_e x = w^2 M_e x over the
    element classes, and the share of joints.

    M_e has the mass that the element contributes to its nodes. Assembly and fixed nodes can only
    lower the highest frequency. Contact springs raise it and are not included.
    """
    scale, highest = 1.0 / np.sqrt(np.repeat(operator.node_mass, 3, axis=1)), 0.0
    for start in range(0, len(scale), _BATCH):
        part = scale[start : start + _BATCH]
        matrices = operator.stiffness[start : start + _BATCH] * part[:, :, None] * part[:, None, :]
        highest = max(highest, np.linalg.eigvalsh(matrices).max())
    if operator.joints is not None:
        highest += largest_share(operator.joints, operator.mass)
    return math.sqrt(highest)


def operator_bound(
    operator: Operator,
    added_stiffness: np.ndarray | None = None,
    *,
    tolerance: float = 1e-3,
    iterations: int = 200,
) -> FrequencyBound:
    """Upper estimate (rad/s) of the highest frequency of the free nodes, by Lanczos iteration on
    M^-1/2 (K + S) M^-1/2, K with the joints under the mounts.

    added_stiffness (n,3) N/m is the diagonal S of contact springs, none if absent. With Ritz value
    t and residual r, an eigenvalue lies in [t - r, t + r]. There is no proof that it is the highest
    one. But the start vector is random, so it is not orthogonal to the highest mode, and Ritz
    values converge fastest at the ends of the spectrum. The result never exceeds the element bound
    with springs, w^2 <= w_element^2 + max(S / m); it is this bound if `iterations` do not bring r
    below tolerance * t.
    """
    inverse_root_mass = np.where(operator.free, 1.0 / np.sqrt(operator.mass), 0.0)[:, None]
    springs = (
        np.zeros((len(operator.mass), 3))
        if added_stiffness is None
        else np.asarray(added_stiffness, dtype=float)
    )
    if springs.shape != (len(operator.mass), 3) or not (springs >= 0.0).all():
        raise ValueError(f"added_stiffness must be non-negative, shape {(len(operator.mass), 3)}")
    force = np.empty((len(operator.mass), 3))

    def apply(vector):
        displacement = vector * inverse_root_mass
        internal_force(
            displacement, operator.cells, operator.shape_class, operator.stiffness, force
        )
        total = force + springs * displacement
        if operator.joints is not None:
            total += (operator.joints @ displacement.ravel()).reshape(total.shape)
        return total * inverse_root_mass

    cap = element_bound(operator) ** 2 + (springs * inverse_root_mass**2).max()
    ritz, residual, used = _lanczos(apply, inverse_root_mass > 0.0, cap, tolerance, iterations)
    upper = min(cap, ritz + residual) if residual <= tolerance * ritz else cap
    return FrequencyBound(math.sqrt(upper), math.sqrt(ritz), used)


def _lanczos(apply, free, scale, tolerance, iterations):
    """Largest Ritz value of a symmetric operator, its residual norm and the number of applications.

    No re-orthogonalisation: lost orthogonality repeats converged values, but the largest one and
    its residual stay correct (Paige 1971). The residual of a Ritz pair is the last off-diagonal
    entry times the last component of its vector.
    """
    vector = np.random.default_rng(0).standard_normal((len(free), 3)) * free
    norm = math.sqrt(_product(vector, vector))
    if norm == 0.0:
        raise ValueError("no free node: there is no frequency to bound")
    vector /= norm
    previous, off_diagonal = np.zeros_like(vector), 0.0
    diagonal, off_diagonals = [], []
    for used in range(1, iterations + 1):
        following = apply(vector) - off_diagonal * previous
        diagonal.append(_product(vector, following))
        following -= diagonal[-1] * vector
        off_diagonal = math.sqrt(_product(following, following))
        if used % 10 == 0 or used == iterations or off_diagonal <= 1e-14 * scale:
            value, shape = eigh_tridiagonal(
                diagonal, off_diagonals, select="i", select_range=(used - 1, used - 1)
            )
            ritz, residual = float(value[0]), off_diagonal * abs(float(shape[-1, 0]))
            if residual <= tolerance * ritz:
                break
        off_diagonals.append(off_diagonal)
        previous, vector = vector, following / off_diagonal
    return ritz, residual, used


def _product(a: np.ndarray, b: np.ndarray) -> float:
    """Scalar product, not by BLAS: with several runs on one machine, its threads wait for each
    other, a hundred times longer than the product takes."""
    return float((a * b).sum())


def critical_step(frequency: float, damping_ratio: float = 0.0) -> float:
    """Largest stable step (s) for a frequency in rad/s whose damping force lags by half a step, see
    the module docstring."""
    # 1 / (sqrt(1+z2) + z) equals sqrt(1+z2) - z, without cancellation at large z.
    return 2.0 / frequency / (math.hypot(1.0, damping_ratio) + damping_ratio)


def choose_step(
    limit: float, safety: float, sample_interval: float, requested: float | None = None
) -> float:
    """Largest step (s) that is at most safety * limit and divides the sample interval.

    A `requested` step is checked and not changed. Raises StepError if it exceeds the limit or does
    not divide the interval, ValueError unless limit > 0, sample_interval > 0 and 0 < safety <= 1.
    """
    if not (limit > 0.0 and sample_interval > 0.0 and 0.0 < safety <= 1.0):
        raise ValueError(
            f"need limit > 0, sample_interval > 0, 0 < safety <= 1; got {limit}, "
            f"{sample_interval}, {safety}"
        )
    if requested is None:
        return sample_interval / math.ceil(sample_interval / (safety * limit))
    if not 0.0 < requested <= limit:
        raise StepError(
            f"the requested step of {requested:.6g} s is not stable: the limit is {limit:.6g} s "
            f"(ratio {requested / limit:.4g})"
        )
    count = sample_interval / requested
    if round(count) < 1 or abs(count - round(count)) > _DIVIDES * count:
        raise StepError(
            f"the requested step of {requested:.6g} s does not divide the sample interval of "
            f"{sample_interval:.6g} s; "
            f"{sample_interval / math.ceil(count):.6g} s does"
        )
    return requested
