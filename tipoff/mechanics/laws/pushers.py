"""The law of spring pushers: kernel records, the force over travel, its potential, and inertia.

A pusher is guided along a line that is fixed in the platform, with a unit vector e. It pushes at a
point of the payload, at x in platform axes, and at the same place on the platform::

    s = e . x - e . x_0,     force F(s) e,     power F(s) ds/dt,     energy given up  W(s) = integral of F from 0 to s

x_0 is the nominal place of the point, so s is the travel from there. ds/dt is the speed along e of the
payload's point relative to the platform's point at the same place. So F is the gradient of a potential
for every motion, and the pair of forces keeps both momenta. F is piecewise linear in s. A pusher whose
stroke is used up stays off. Its friction opposes s with a constant force, which fades below
``SLOW``::

    friction  f tanh(ds/dt / SLOW)

The moving part of a pusher of mass m goes with the payload up to the end of its stroke, and then stops
with the platform. Its inertia takes a pair of forces along e, and its kinetic energy stays behind::

    inertia  -m d2s/dt2,     kept  m (ds/dt)^2 / 2

Both are exact on a platform that does not move. Pushers at rest are part of a free platform; there the law
leaves out the momentum m ds/dt that they have with it, which is m over the mass of the platform of the whole.
With several pushers, d2s/dt2 = a - D L follows from the relative accelerations a without inertia, the pairs
L = m d2s/dt2, and D_ij, the change of the speed of travel i by a unit impulse of pair j::

    (1 + diag(m) D) L = diag(m) a
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.kernels.reference import by_reference

SLOW = 1e-3  # m/s


@by_reference
class Pushers(NamedTuple):
    """Kernel record of n pushers with k knots of their curves of force."""

    direction: np.ndarray  # (n,3) unit vectors, in platform axes
    point: np.ndarray  # (n,3) m, in body axes from the payload's actual mass centre
    origin: np.ndarray  # (n,) m, place along its direction at zero travel, in platform axes
    first: np.ndarray  # (n+1,) place in the arrays of knots of the first one of each
    travel: np.ndarray  # (k,) m, of each knot, rising from zero; the last one is the stroke
    force: np.ndarray  # (k,) N
    energy: np.ndarray  # (k,) J, given up from zero travel to each knot
    friction: np.ndarray  # (n,) N
    mass: np.ndarray  # (n,) kg, of the moving parts; empty if none has one


@kernel
def direction_of(pushers, i):
    """Unit vector of pusher ``i`` in platform axes."""
    return (pushers.direction[i, 0], pushers.direction[i, 1], pushers.direction[i, 2])


@kernel
def point_of(pushers, i):
    """Point (m) of pusher ``i`` in body axes."""
    return (pushers.point[i, 0], pushers.point[i, 1], pushers.point[i, 2])


@kernel
def travel(pushers, i, place, turn):
    """Travel (m) of pusher ``i`` for the ``place`` (m) of the payload's mass centre and its
    rotation ``turn`` (nine numbers) in platform axes."""
    arm = rotation.rotate(turn, point_of(pushers, i))
    x = (place[0] + arm[0], place[1] + arm[1], place[2] + arm[2])
    return rotation.dot(direction_of(pushers, i), x) - pushers.origin[i]


@kernel
def last_segment(pushers, i):
    """Number of the segment beyond the stroke of pusher ``i``, in which it is off."""
    return pushers.first[i + 1] - pushers.first[i] - 1


@kernel
def segment_at(pushers, i, s):
    """Number of the segment of pusher ``i`` at the travel ``s`` (m)."""
    segment = 0
    while (
        segment < last_segment(pushers, i) and s >= pushers.travel[pushers.first[i] + segment + 1]
    ):
        segment += 1
    return segment


@kernel
def slope(pushers, i, segment):
    """Change of force over travel (N/m) of pusher ``i`` in a ``segment``."""
    if segment == last_segment(pushers, i):
        return 0.0
    k = pushers.first[i] + segment
    return (pushers.force[k + 1] - pushers.force[k]) / (pushers.travel[k + 1] - pushers.travel[k])


@kernel
def force(pushers, i, segment, s):
    """Force (N) of pusher ``i`` at the travel ``s`` (m) by the line of its ``segment``."""
    if segment == last_segment(pushers, i):
        return 0.0
    k = pushers.first[i] + segment
    return pushers.force[k] + slope(pushers, i, segment) * (s - pushers.travel[k])


@kernel
def given_up(pushers, i, segment, s):
    """Energy (J) that pusher ``i`` has given up from zero travel to ``s`` (m)."""
    k = pushers.first[i] + segment
    mean = 0.5 * (force(pushers, i, segment, s) + pushers.force[k])
    if segment == last_segment(pushers, i):
        mean = 0.0
    return pushers.energy[k] + mean * (s - pushers.travel[k])


@kernel
def friction(pushers, i, segment, speed):
    """Friction (N) of pusher ``i`` at the ``speed`` (m/s) of its travel, against it."""
    if segment == last_segment(pushers, i):
        return 0.0
    return pushers.friction[i] * np.tanh(speed / SLOW)


@kernel
def damping(pushers, i, segment, speed):
    """Change of ``friction`` over speed (N s/m)."""
    if segment == last_segment(pushers, i):
        return 0.0
    share = np.tanh(speed / SLOW)
    return pushers.friction[i] / SLOW * (1.0 - share * share)


@kernel
def solve(a, x):
    """Replace the right side ``x`` (n,) of the equations of the module's docstring with the matrix
    ``a`` (n,n) by the pairs. All leading minors are positive, so no pivot is needed."""
    count = x.size
    for k in range(count):
        for i in range(k + 1, count):
            factor = a[i, k] / a[k, k]
            x[i] -= factor * x[k]
            for j in range(k + 1, count):
                a[i, j] -= factor * a[k, j]
    for k in range(count - 1, -1, -1):
        for j in range(k + 1, count):
            x[k] -= a[k, j] * x[j]
        x[k] /= a[k, k]


def energy_given_up(pushers: Pushers, segment: np.ndarray, s: np.ndarray) -> float:
    """Sum of ``given_up`` (J) of all n pushers in their ``segment`` (n,) at the travel ``s`` (n,) m,
    without a kernel."""
    here = pushers.first[:-1] + segment
    is_off = here == pushers.first[1:] - 1
    after = np.where(is_off, here, here + 1)
    width = np.where(is_off, 1.0, pushers.travel[after] - pushers.travel[here])
    rise = (pushers.force[after] - pushers.force[here]) / width
    way = np.where(is_off, 0.0, s - pushers.travel[here])
    return float((pushers.energy[here] + way * (pushers.force[here] + 0.5 * rise * way)).sum())
