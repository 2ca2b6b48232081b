"""Local error of a step, as speeds at the pads, relative to the allowed error.

With the error e of each slot, the error e_w = I^-1 e_h of the rate, the distance ``reach`` of the
farthest pad from the mass centre and the step h, each body's ratio is the largest of::

    |e_v| across, reach |e_w|, |e_r| / h across, 2 reach |e_q| / h      over   rtol (floor + |v| across + reach |w|)
    |e_v| along X, |e_r| / h along X                                     over   rtol (floor + |v| along X)

This way 6 m/s along the rail do not loosen the tolerance of millimetres per second across it. All
speeds are in the frame that moves with the platform (``mechanics.comoving``), so a common speed of
all bodies loosens nothing either. The part of a rate due to rounding is subtracted: it matters for
a thin body that lies across its axes, with moments of inertia that differ by a factor of a million.
Modes of the rails are bounded by the error of their energy, as a speed of the payload's mass m. A
step too long for the highest mode fails here, or earlier at the proven limit::
    sqrt(sum over modes of (e_q'^2 + omega^2 e_q^2) / m)                 over   the first of these, of the payload
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.kernels.reference import by_reference
from tipoff.lowfi.contact.compliant.modes import energies
from tipoff.lowfi.dynamics.dormand_prince import local_error
from tipoff.lowfi.numerics import Numerics
from tipoff.lowfi.state import (
    BODY_SIZE,
    PAYLOAD,
    PLACE,
    PLATFORM,
    SPIN,
    VELOCITY,
    modal_size,
    motion,
    quaternion,
    triple,
)
from tipoff.mechanics.promises import Promises

_ROUNDING = 2e-15  # of a product of an inverse inertia and a spin, in its largest axis


@by_reference
class Tolerance(NamedTuple):
    """Allowed errors of a run."""

    relative: float  # local error of a step, relative to the speeds of the body
    floor: float  # m/s, lower speeds count as this value
    reach: float  # m, distance of the farthest pad from the mass centre of the payload
    total: float  # promised relative error of the total ledger
    transverse: float  # promised relative error of the transverse ledger


def tolerance(numerics: Numerics, promised: Promises) -> Tolerance:
    """Tolerance without ``reach``, which each case adds."""
    return Tolerance(
        relative=numerics.relative_tolerance,
        floor=numerics.speed_floor,
        reach=0.0,
        total=promised.energy_error,
        transverse=promised.transverse_energy_error,
    )


@kernel
def with_reach(tolerance, reach):
    """``tolerance`` of a payload with another ``reach`` (m)."""
    return Tolerance(
        relative=tolerance.relative,
        floor=tolerance.floor,
        reach=reach,
        total=tolerance.total,
        transverse=tolerance.transverse,
    )


@kernel
def error_ratio(tolerance, system, loop, dt):
    """Error of the step of ``dt`` (s) to ``loop.end`` over the allowed error; NaN if a term is
    NaN."""
    payload, end, error = system.payload, loop.end, loop.work
    local_error(dt, loop.stages, modal_size(system.compliance), error)
    ratio = _body_ratio(tolerance, payload.inverse_inertia, dt, error[:BODY_SIZE], end[:BODY_SIZE])
    return worse(
        worse(ratio, _platform_ratio(tolerance, system.platform, dt, error, end)),
        _rail_ratio(tolerance, payload, system.compliance, error, end),
    )


@kernel
def worse(a, b):
    """The larger of two numbers; NaN if either is NaN."""
    return a if not a <= b else b


@kernel
def _platform_ratio(tolerance, platform, dt, error, end):
    ratio = 0.0
    if platform.free:
        ratio = _body_ratio(
            tolerance, platform.inverse_inertia, dt, error[PLATFORM:], end[PLATFORM:]
        )
    return ratio


@kernel
def _rail_ratio(tolerance, payload, compliance, error, end):
    ratio = 0.0
    if compliance is not None:
        ratio = _modal_ratio(tolerance, payload, compliance.modes, error, end)
    return ratio


@kernel
def _modal_ratio(tolerance, payload, modes, error, end):
    ratio = 0.0
    if modes.square.size > 0:
        body = motion(payload, end, PAYLOAD)
        across = (
            tolerance.floor
            + np.hypot(body.velocity[1], body.velocity[2])
            + tolerance.reach * np.sqrt(rotation.dot(body.rate, body.rate))
        )
        kinetic, strain = energies(modes, error)
        ratio = np.sqrt(2.0 * (kinetic + strain) / payload.mass) / (across * tolerance.relative)
    return ratio


@kernel
def _body_ratio(tolerance, inverse_inertia, dt, error, end):
    """Ratio of one body, whose slots come first in ``error`` and ``end``."""
    velocity, e_q = triple(end, VELOCITY), quaternion(error, 0)
    e_place, e_velocity = triple(error, PLACE), triple(error, VELOCITY)
    spin = triple(end, SPIN)
    rate, e_rate = (
        rotation.multiply(inverse_inertia, spin),
        rotation.multiply(inverse_inertia, triple(error, SPIN)),
    )
    # of the spin, as a rate about the axis of least inertia
    rounding = (
        _ROUNDING
        * (abs(inverse_inertia[0, 1]) + abs(inverse_inertia[0, 2]) + abs(inverse_inertia[1, 2]))
        * np.sqrt(rotation.dot(spin, spin))
    )
    across = (
        tolerance.floor
        + np.hypot(velocity[1], velocity[2])
        + tolerance.reach * np.sqrt(rotation.dot(rate, rate))
    )
    lateral = worse(np.hypot(e_velocity[1], e_velocity[2]), np.hypot(e_place[1], e_place[2]) / dt)
    e_turn = (
        2.0 * np.sqrt(e_q[0] * e_q[0] + e_q[1] * e_q[1] + e_q[2] * e_q[2] + e_q[3] * e_q[3]) / dt
    )
    angular = tolerance.reach * (worse(np.sqrt(rotation.dot(e_rate, e_rate)), e_turn) - rounding)
    axial = worse(abs(e_velocity[0]), abs(e_place[0]) / dt)
    return (
        worse(worse(lateral, angular) / across, axial / (tolerance.floor + abs(velocity[0])))
        / tolerance.relative
    )
