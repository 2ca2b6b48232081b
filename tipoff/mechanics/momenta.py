"""Errors of linear and angular momentum of a run, in the frame of its solution
(``mechanics.comoving``).

    error = largest |change of a sum of momenta - impulse from outside| / scale
    scale = largest sum of the magnitudes of the momenta of all parts

Parts are the bodies, and the nodes of elastic rails. Momenta may cancel: between payload and
platform, two rails, or the nodes of a body that turns. So the scale is the sum of magnitudes, not
the magnitude of the sum. An angular momentum is split into spins and, for bodies
that are not apart, orbits about the origin.

Impulses from outside that cancel, such as weight and reaction of the ground, cause rounding; so do
moments about the origin. The sums of magnitudes of all of these enter the lower bound of the scale
(``mechanics.promises``). Momenta are sums over the steps, each rounded by at most half a unit in
the last place. Under a constant force these errors have one sign, so n steps may add n eps / 2 of
the momentum.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics import promises


class Sizes(NamedTuple):
    """Sums of magnitudes over all parts at n samples."""

    linear: np.ndarray  # (n,) kg m/s, of m v
    angular: np.ndarray  # (n,) kg m2/s, of r x m v and of the spins
    # (n,) kg m2/s, of |r| |m v| and of the spins: determines the rounding of ``angular``
    terms: np.ndarray


class Sums(NamedTuple):
    """Balanced momenta at n samples, and the sizes of their terms."""

    values: np.ndarray  # (n,6) kg m/s and kg m2/s, momenta of the whole
    given: np.ndarray  # (n,6) N s and N m s, from outside
    sizes: Sizes
    impulses: float  # N s, sum of the magnitudes of all impulses, including those that cancel
    reach: float  # m, largest distance of a force from the origin


def size(values: np.ndarray) -> np.ndarray:
    """Magnitudes (n,) of vectors (n,3)."""
    return np.sqrt(np.einsum("ni,ni->n", values, values))


def of_bodies(bodies: Iterable[tuple[float, np.ndarray, np.ndarray, np.ndarray]]) -> Sizes:
    """Sums over rigid ``bodies``: mass (kg), place (n,3) m, velocity (n,3) m/s and spin (n,3) kg m2/s
    of each, the last in any axes."""
    found = []
    for mass, place, velocity, spin in bodies:
        own, turning = mass * velocity, size(spin)
        orbit = size(rotation.crosses(place, own))
        found.append((size(own), orbit + turning, size(place) * size(own) + turning))
    return Sizes(*np.sum(found, axis=0))


def impulses(time: np.ndarray, given: np.ndarray, forces: np.ndarray, weight: float) -> float:
    """Bound of the sum of the magnitudes of all impulses (N s) up to the last of the times (n,) s.
    Their sum is ``given`` (n,6); pad ``forces`` (n,f,3) N and ``weight`` (N) may cancel in it."""
    changes = size(np.diff(given[:, :3], axis=0)).sum()
    interval = time[1] - time[0] if time.size > 1 else 0.0
    pressed = interval * np.sqrt(np.einsum("nfi,nfi->nf", forces, forces)).sum()
    return float(changes + pressed + 2.0 * weight * (time[-1] - time[0]))


def errors(sums: Sums, promised: promises.Promises, steps: int = 0) -> tuple[float, float]:
    """Errors of linear and angular momentum (1) of ``sums`` over so many ``steps``."""
    rounding = max(promises.ROUNDING, 0.5 * steps * float(np.finfo(float).eps))
    lost = sums.values - sums.values[0] - (sums.given - sums.given[0])
    largest = [float(part.max()) for part in sums.sizes]
    linear = promises.scale(
        largest[0], largest[0] + sums.impulses, promised.linear_momentum_error, rounding
    )
    angular = promises.scale(
        largest[1],
        largest[2] + sums.impulses * sums.reach,
        promised.angular_momentum_error,
        rounding,
    )
    return (
        promises.relative(float(size(lost[:, :3]).max()), linear),
        promises.relative(float(size(lost[:, 3:]).max()), angular),
    )
