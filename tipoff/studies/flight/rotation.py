"""Free rotation of rigid bodies in closed form, of any inertia, for any time (Jacobi; Landau and
Lifshitz, Mechanics, section 37).

In principal axes, with L the magnitude of the angular momentum and T the kinetic energy. Axis 3 is the
one whose component of the angular momentum keeps its sign::

    w = (a cn u, b sn u, c dn u),   u = u0 + lambda t,   lambda^2 = (I3 - I2)(L^2 - 2 T I1) / (I1 I2 I3)

The angle of precession of axis 3 about the angular momentum contains Legendre's integral of the third
kind::

    phi(t) = L t / I3 + L (I3 - I1) / (I1 I3 lambda) (Pi(n; u) - Pi(n; u0)),     n = -I3 (I2 - I1) / (I1 (I3 - I2)) <= 0

Pi is computed from Carlson's R_F and R_J (DLMF 19.25.14). There are no time steps, so the error is
rounding times the phase. Rotation near the middle axis is unstable: there the rounding error grows as
exp(lambda t), like any disturbance.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ellipj, ellipkinc, ellipkm1, elliprf, elliprj

# Smallest relative distance of the moments. It is the relative error of the phase for a body of
# revolution. If such a body rotates across its axis, half of the digits are lost.
_PARTED = 1e-13


class Free(NamedTuple):
    """n free bodies: principal ``axes`` (n,3,3) as columns in body axes, ``moments`` (3,n,1) kg m2,
    ``amplitude`` (3,n,1) rad/s, and as (n,1) ``speed`` lambda, ``phase`` u0, ``quarter`` period K
    of u, ``parameter`` m and its ``complement`` 1 - m, ``characteristic`` n, ``momentum`` L, factor
    ``precession`` of Pi, and ``start``, Pi at u0; ``frame`` (n,3,3), from momentum axes to inertial
    axes."""

    axes: np.ndarray
    moments: np.ndarray
    amplitude: np.ndarray
    speed: np.ndarray
    phase: np.ndarray
    quarter: np.ndarray
    parameter: np.ndarray
    complement: np.ndarray
    characteristic: np.ndarray
    momentum: np.ndarray
    precession: np.ndarray
    start: np.ndarray
    frame: np.ndarray


def free(inertia: np.ndarray, turn: np.ndarray, rate: np.ndarray) -> Free:
    """Bodies of ``inertia`` (n,3,3) kg m2 at attitude ``turn`` (n,3,3), body to inertial, and
    ``rate`` (n,3) rad/s in body axes."""
    axes, moments, (w1, w2, w3) = _principal(inertia, rate)
    i1, i2, i3 = moments
    d21, d31, d32, side = abs(i2 - i1), abs(i3 - i1), abs(i3 - i2), np.sign(i3 - i2)
    x, y = np.sqrt(i1 * d31) * w1, np.sqrt(i2 * d32) * w2
    # |2 T I3 - L^2| and |L^2 - 2 T I1|, without cancellation
    outer, inner = x**2 + y**2, i2 * d21 * w2**2 + i3 * d31 * w3**2
    apart = abs(i3 * d32 * w3**2 - i1 * d21 * w1**2)  # |L^2 - 2 T I2|, zero on the separatrix
    # inner is zero only at rest
    scale, moves = np.where(inner > 0.0, d32 * inner, 1.0), inner > 0.0
    complement = np.where(moves, np.clip(d31 * apart / scale, 1e-30, 1.0), 1.0)
    parameter, quarter = np.minimum(d21 * outer / scale, 1.0), ellipkm1(complement)
    ahead = np.where(w3 < 0.0, -1.0, 1.0)
    amplitude = np.stack(
        [
            np.sqrt(outer / (i1 * d31)),
            ahead * side * np.sqrt(outer / (i2 * d32)),
            ahead * np.sqrt(inner / (i3 * d31)),
        ]
    )
    angle = np.arctan2(y * ahead * side, x)
    halves = np.round(angle / np.pi)
    phase = (
        np.clip(ellipkinc(angle - np.pi * halves, parameter), -quarter, quarter)
        + 2.0 * halves * quarter
    )
    speed, momentum = (
        np.sqrt(d32 * inner / (i1 * i2 * i3)),
        np.sqrt((i1 * w1) ** 2 + (i2 * w2) ** 2 + (i3 * w3) ** 2),
    )
    precession = momentum * (i3 - i1) / (i1 * i3 * np.where(moves, speed, 1.0))
    body = Free(
        axes,
        moments,
        amplitude=amplitude,
        speed=speed,
        phase=phase,
        quarter=quarter,
        parameter=parameter,
        complement=complement,
        characteristic=-i3 * d21 / (i1 * d32),
        momentum=momentum,
        precession=precession,
        start=np.zeros_like(speed),
        frame=axes,
    )
    body = body._replace(start=_course(body, phase)[-1])
    begin, _ = _at_momentum(body, np.zeros_like(speed))
    return body._replace(frame=turn @ axes @ begin[:, 0].transpose(0, 2, 1))


def at(body: Free, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Attitudes (n,k,3,3), body to inertial, and rates (n,k,3) rad/s in body axes after ``time``
    (n,k) s."""
    turn, rate = _at_momentum(body, time)
    back = body.axes.transpose(0, 2, 1)
    return body.frame[:, None] @ turn @ back[:, None], rate @ back


def precession_rate(body: Free) -> np.ndarray:
    """Mean rate of precession (n,) rad/s of principal axis 3 about the angular momentum."""
    return (
        body.momentum / body.moments[2] + body.precession * body.speed * _whole(body) / body.quarter
    )[:, 0]


def spin_rate(body: Free) -> np.ndarray:
    """Mean rate (n,) rad/s of the additional rotation about principal axis 3, counted about the
    angular momentum: one turn in each nutation, backwards if axis 3 has the largest moment."""
    return -np.sign(body.moments[2] - body.moments[1])[:, 0] * 2.0 * np.pi / nutation_period(body)


def nutation_period(body: Free) -> np.ndarray:
    """Period (n,) s of the rates, 4 K / lambda; infinite at rest."""
    return np.divide(
        4.0 * body.quarter, body.speed, out=np.full_like(body.speed, np.inf), where=body.speed > 0.0
    )[:, 0]


def _principal(inertia: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Right-handed principal axes, moments (3,n,1) and rates (3,n,1). The last axis has the largest
    or the smallest moment: the one about which the body rotates, as decided by the separatrix L^2 =
    2 T I2."""
    moments, axes = np.linalg.eigh(inertia)
    axes[:, :, 2] *= np.linalg.det(axes)[:, None]
    for above in (1, 2):
        moments[:, above] = np.maximum(moments[:, above], (1.0 + _PARTED) * moments[:, above - 1])
    w = np.einsum("nji,nj->ni", axes, rate)
    i1, i2, i3 = moments.T
    smallest = (i3 * (i3 - i2) * w[:, 2] ** 2 <= i1 * (i2 - i1) * w[:, 0] ** 2)[:, None]
    mirror = np.array([1.0, -1.0, 1.0])  # an exchange of only two axes would make them left-handed
    axes = np.where(smallest[:, None], axes[:, :, ::-1] * mirror, axes)
    return (
        axes,
        np.where(smallest, moments[:, ::-1], moments).T[..., None],
        np.where(smallest, w[:, ::-1] * mirror, w).T[..., None],
    )


def _at_momentum(body: Free, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Attitudes (n,k,3,3) of the principal axes in axes at the angular momentum, and rates (n,k,3)
    along them."""
    (i1, i2, i3), (a, b, c) = body.moments, body.amplitude
    sn, cn, dn, third = _course(body, body.phase + body.speed * time)
    rate = np.stack([a * cn, b * sn, c * dn], axis=-1)
    precession = body.momentum * time / i3 + body.precession * (third - body.start)
    nutation = np.arctan2(np.hypot(i1 * a * cn, i2 * b * sn), i3 * c * dn)
    # Components of the momentum across axis 3 without their common factor, which is zero in
    # rotation about axis 3.
    ahead = np.where(c < 0.0, -1.0, 1.0) * np.sign(i3 - i2)
    spin = np.arctan2(np.sqrt(i1 / abs(i3 - i1)) * cn, ahead * np.sqrt(i2 / abs(i3 - i2)) * sn)
    return _euler(precession, nutation, spin), rate


def _course(body: Free, u: np.ndarray) -> tuple[np.ndarray, ...]:
    """sn, cn, dn and Pi of u (n,k), reduced to the half period about zero, where their series are
    exact."""
    halves = np.round(u / (2.0 * body.quarter))
    sn, cn, dn, _ = ellipj(u - 2.0 * halves * body.quarter, body.parameter)
    third = sn * _carlson(cn**2, dn**2, sn**2, body.characteristic) + 2.0 * halves * _whole(body)
    sign = 1.0 - 2.0 * (halves % 2.0)
    return sign * sn, sign * cn, dn, third


def _whole(body: Free) -> np.ndarray:
    """The complete integral Pi(n), (n,1)."""
    return _carlson(0.0, body.complement, 1.0, body.characteristic)


def _carlson(cosine, delta, sine, characteristic) -> np.ndarray:
    """Pi(n; u) / sn u from the squares of cn, dn and sn."""
    return elliprf(cosine, delta, 1.0) + characteristic * sine / 3.0 * elliprj(
        cosine, delta, 1.0, 1.0 - characteristic * sine
    )


def _euler(first: np.ndarray, tilt: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Matrices (n,k,3,3) of turns about z by ``last``, then x by ``tilt``, then z by ``first``."""
    (cf, ct, cl), (sf, st, sl) = (
        tuple(map(part, (first, tilt, last))) for part in (np.cos, np.sin)
    )
    rows = [
        cf * cl - sf * ct * sl,
        -cf * sl - sf * ct * cl,
        sf * st,
        sf * cl + cf * ct * sl,
        -sf * sl + cf * ct * cl,
        -cf * st,
        st * sl,
        st * cl,
        ct,
    ]
    return np.stack(rows, axis=-1).reshape(*np.shape(ct), 3, 3)
