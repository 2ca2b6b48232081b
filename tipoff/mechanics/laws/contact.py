"""Laws of the springs between a pad face and its wall.

With penetration p > 0 and closing speed q = dp/dt the normal force is F = max(0, raw), where raw
is::

    IMPACT          k p^e + c s(p/d) q,   s(x) = x^2 (3 - 2 x) on 0..1 and 1 beyond     (ADAMS/Solver)
    Hunt-Crossley   k p^e (1 + a q)                                                     (Hunt and Crossley 1975)
    linear          k p + c q

Stored energy is k p^(e+1) / (e+1) in each law.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import njit


class ContactLaw(NamedTuple):
    """Kernel record of a law."""

    stiffness: float  # N/m^e
    exponent: float = 1.0  # e
    damping: float = 0.0  # N s/m
    damping_depth: float = 0.0  # m, depth of full damping; zero for any
    dissipation: float = 0.0  # s/m


NO_CONTACT = ContactLaw(stiffness=0.0)


@njit
def parts(law, penetration, closing):
    """Elastic and damping part (N) for penetration > 0 (m) and closing speed (m/s), before the
    no-pull rule."""
    elastic = law.stiffness * _power(penetration, law.exponent)
    coefficient = _coefficient(
        law.damping, law.damping_depth, law.dissipation, elastic, penetration
    )
    return elastic, coefficient * closing


@njit
def _power(base, exponent):
    if exponent == 1.0:
        return base
    # sqrt is several times cheaper than pow, and 1.5 (Hertz) is by far the most common exponent
    return base * np.sqrt(base) if exponent == 1.5 else base**exponent


@njit
def _coefficient(damping, damping_depth, dissipation, elastic, penetration):
    """Damping force over closing speed (N s/m)."""
    if damping == 0.0:
        return elastic * dissipation
    if damping_depth == 0.0:
        return damping
    x = min(penetration / damping_depth, 1.0)
    return damping * x * x * (3.0 - 2.0 * x)


@njit
def stored_energy(law, penetration):
    """Elastic energy (J) stored at penetration > 0 (m)."""
    return _stored(law.stiffness, law.exponent, penetration)


@njit
def _stored(stiffness, exponent, penetration):
    if exponent == 1.0:
        return 0.5 * stiffness * penetration * penetration
    return stiffness * penetration ** (exponent + 1.0) / (exponent + 1.0)
