"""Critical step of the coupled system: rail, contact, payload.

Contact adds G k G' to the stiffness, where a column of G is the gap of one cell. In the mass
metric

    lambda_max(rail + contact) <= lambda_max(rail) + k max over nodes (area_a / m_a)
                                  + k sum over faces A (1/m + r'I^-1 r)

because the largest eigenvalue of a sum is at most the sum, and that of G k G' on the nodes alone is
at most the largest sum of magnitudes in a row of M^-1 G k G' (Gershgorin):

    sum over b of |sum over cells of A N_a N_b| / m_a <= area_a / m_a
    area_a = sum over cells of A |N_a| sum over b of |N_b|

On bilinear facets no N is negative and their sum is one, so area_a is the node's own share of the
area; on quadratic triangles the corners' N may be negative and the last sum reaches 5/3.

Damping C whose velocity lags by half a step equals damping at the mid-step velocity, [u(n+1) -
u(n-1)] / 2dt, in a system with the mass M - dt C/2. Such a system conserves or loses v'(M - dt
C/2)v + u(n)'K u(n+1). Nothing grows while this is positive, that is for

    dt^2/4 lambda(M^-1 K) + dt/2 lambda(M^-1 C) <= 1

With C = alpha M + beta K of the rail, and friction c at the nodes, a step is stable for

    dt^2/4 (lambda_rail + lambda_contact) + dt/2 (alpha + beta lambda_rail) + dt/2 max(c/m) <= 1

where c of a node has the bound of area_a / m_a with each cell's damping in place of its area. Every
term grows with lambda_rail, so its upper bound is sufficient, for any dependence of the damping
ratio on frequency below it. The first two terms give the limit of a run: the limit for w^2 =
lambda_rail + lambda_contact with the ratio (alpha + beta lambda_rail) / 2w. The third divides steps
during the run (``dynamics.substeps``). Rail frequencies are for mounts that do not move. A free
platform may raise them by the share m_rail / m_platform, which the safety factor covers.
"""

import itertools
from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.system import System
from tipoff.highfi.statics.stable_step import critical_step
from tipoff.mechanics.laws.pushers import SLOW
from tipoff.mechanics.laws.structural_damping import Damping


def contact_frequency_squared(system: System) -> float:
    """Upper bound (1/s2) of the contribution of contact to the largest squared frequency."""
    if system.model.interface_stiffness is None:
        return 0.0
    rail, payload, faces = system.rail, system.model.payload, system.faces
    size = 4.0 * faces.half_length * faces.half_width
    reach = (faces.centre**2).sum(axis=1) * np.linalg.eigvalsh(payload.inverse_inertia)[-1]
    body = (size * (1.0 / payload.mass + reach)).sum()
    return system.model.interface_stiffness * (
        (system.surface.share * rail.inverse_mass).max() + body
    )


class Bound(NamedTuple):
    """Upper bounds of contributions to M^-1 K and M^-1 C."""

    stiffness: float  # 1/s2
    damping: float  # 1/s


def of_pushers(system: System) -> Bound:
    """Bounds of the contribution of spring pushers: the sums of their slopes of force over travel,
    and of friction over speed, times the inverse mass of payload and platform at their points."""
    pushers, payload, frame = system.pushers, system.model.payload, system.frame
    if not len(pushers.point):
        return Bound(0.0, 0.0)
    reach = (pushers.point**2).sum(axis=1)
    inverse = 1.0 / payload.mass + reach * np.linalg.eigvalsh(payload.inverse_inertia)[-1]
    if frame is not None:
        # A payload on its rails is nowhere farther from the platform than at either end.
        place = pushers.point + payload.mass_centre + system.body_offset
        far = np.linalg.norm(place, axis=1) + float(np.ptp(system.rail.points[:, 0]))
        inverse += 1.0 / frame.mass + far**2 * np.linalg.eigvalsh(frame.inverse_inertia)[-1]
    steepest = [
        np.abs(np.diff(pushers.force[begin:end]) / np.diff(pushers.travel[begin:end])).max()
        for begin, end in itertools.pairwise(pushers.first)
    ]
    return Bound(float(steepest @ inverse), float(pushers.friction @ inverse) / SLOW)


def damping_ratio(damping: Damping, rail: float, contact: float, more: float = 0.0) -> float:
    """Ratio z for the limit ``critical_step(w, z)`` of rails with the highest frequency ``rail``
    (rad/s), a ``contact`` contribution (1/s2) to its square, w^2 = rail^2 + contact, and ``more``
    damping (1/s)."""
    rates = more + (damping.mass_rate + damping.stiffness_time * rail**2)
    return float(0.5 * rates / np.sqrt(rail**2 + contact)) if rates else 0.0


def step_limit(damping: Damping, rail: float, contact: float, more: float = 0.0) -> float:
    """Largest stable step (s) without friction at the rails; see ``damping_ratio``."""
    ratio = damping_ratio(damping, rail, contact, more)
    return critical_step(float(np.sqrt(rail**2 + contact)), ratio)


def used(step: float, limit: float, ratio: float) -> float:
    """Share of the condition above that ``step`` (s) uses, without friction; ``limit`` (s), with
    damping ``ratio``, uses 1."""
    half_turn = step / limit * (np.hypot(1.0, ratio) - ratio)  # dt w / 2
    return float(half_turn**2 + 2.0 * ratio * half_turn)
