"""Errors of linear and angular momentum of a run, in the frame of its solution
(``mechanics.comoving``).

    error = largest |change of a sum of momenta - impulse from outside| / scale

The scale is the largest momentum of the payload or of the whole system. Impulses round where they
cancel, and so do their moments about the origin; both sizes enter the lower bound of the scale
(``mechanics.promises``). Momenta are sums over the steps, each rounded by half a unit in the last
place at most. Under a constant force these errors have one sign, so n steps may add n eps / 2 of
the momentum.
"""

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics import promises
from tipoff.mechanics.outcome import Motion


def errors(
    moved: Motion,
    mass: float,
    values: np.ndarray,
    given: np.ndarray,
    forces: np.ndarray,
    promised: promises.Promises,
    steps: int = 0,
) -> tuple[float, float]:
    """Errors of linear and angular momentum (1) of n samples of a payload of ``mass`` (kg):
    ``values`` (n,6) kg m/s and kg m2/s of the whole, ``given`` (n,6) N s and N m s from outside,
    pad ``forces`` (n,f,3) N; ``steps`` were summed."""
    rounding = max(promises.ROUNDING, 0.5 * steps * float(np.finfo(float).eps))
    own = mass * moved.velocity
    orbit = rotation.crosses(moved.position, own)
    lost = values - values[0] - (given - given[0])
    interval = moved.time[1] - moved.time[0] if moved.time.size > 1 else 0.0
    pressed = interval * float(np.sqrt(np.einsum("nfi,nfi->nf", forces, forces)).sum())
    terms = max(_largest(own), _largest(values[:, :3]), _largest(given[:, :3])) + pressed
    reach = max(_largest(moved.position), _largest(moved.platform_position))
    linear = promises.scale(
        max(_largest(own), _largest(values[:, :3])), terms, promised.linear_momentum_error, rounding
    )
    angular = promises.scale(
        max(_largest(orbit), _largest(values[:, 3:])),
        terms * reach,
        promised.angular_momentum_error,
        rounding,
    )
    return promises.relative(_largest(lost[:, :3]), linear), promises.relative(
        _largest(lost[:, 3:]), angular
    )


def _largest(values: np.ndarray) -> float:
    return float(np.sqrt(np.einsum("ni,ni->n", values, values).max()))
