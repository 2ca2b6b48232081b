"""Rotations without heap allocation: quaternions (scalar first, body to inertial) and matrices as
tuples.

A matrix is nine numbers row by row. ``step`` advances a quaternion by a constant angular velocity
exactly: ``q <- exp(dt w / 2) q`` with w in inertial axes.
"""

import math

import numpy as np

from tipoff.kernels.jit import njit


@njit
def cross(a, b):
    """Vector product of two triples."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@njit
def dot(a, b):
    """Scalar product of two triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit
def matrix(q):
    """Rotation matrix (nine numbers) of the unit quaternion ``q``."""
    w, x, y, z = q
    return (
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )


@njit
def rotate(m, v):
    """Body to inertial: M v."""
    return (
        m[0] * v[0] + m[1] * v[1] + m[2] * v[2],
        m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
        m[6] * v[0] + m[7] * v[1] + m[8] * v[2],
    )


@njit
def unrotate(m, v):
    """Inertial to body: M' v."""
    return (
        m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
        m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
        m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
    )


@njit
def product(p, q):
    """Hamilton product p q."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@njit
def exponential(vector):
    """Unit quaternion of the rotation vector ``vector`` (rad)."""
    angle = np.sqrt(dot(vector, vector))
    # sin(a/2)/a loses digits near zero; two series terms are exact to 1e-17 below 1e-4 rad.
    factor = 0.5 - angle * angle / 48.0 if angle < 1e-4 else np.sin(0.5 * angle) / angle
    return (np.cos(0.5 * angle), factor * vector[0], factor * vector[1], factor * vector[2])


@njit
def normalised(q):
    """``q`` scaled to unit norm."""
    scale = 1.0 / np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return (q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale)


@njit
def step(q, rate, dt):
    """Quaternion after ``dt`` (s) at the constant inertial-axes angular velocity ``rate``
    (rad/s)."""
    turn = exponential((dt * rate[0], dt * rate[1], dt * rate[2]))
    return normalised(product(turn, q))


@njit
def multiply(j, v):
    """Matrix ``j`` (3,3) times a triple."""
    return (
        j[0, 0] * v[0] + j[0, 1] * v[1] + j[0, 2] * v[2],
        j[1, 0] * v[0] + j[1, 1] * v[1] + j[1, 2] * v[2],
        j[2, 0] * v[0] + j[2, 1] * v[1] + j[2, 2] * v[2],
    )


@njit
def solve(a, b, c, v):
    """x of the regular symmetric matrix with the columns ``a``, ``b`` and ``c``, so that
    M x = v, by Cramer's rule."""
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    scale = 1.0 / dot(a, bc)
    return (scale * dot(bc, v), scale * dot(ca, v), scale * dot(ab, v))


@njit
def angular_velocity(m, inverse_inertia, momentum):
    """Inertial-axes angular velocity R I^-1 R' h of a body with inertial-axes spin momentum h;
    inverse inertia is (3,3)."""
    return rotate(m, multiply(inverse_inertia, unrotate(m, momentum)))


def vector(q) -> list[float]:
    """Rotation vector (3,) rad, at most pi long, of the unit quaternion ``q``."""
    w, x, y, z = q if q[0] >= 0.0 else [-part for part in q]
    sine = math.hypot(x, y, z)
    factor = 2.0 if sine < 1e-12 else 2.0 * math.atan2(sine, w) / sine
    return [factor * x, factor * y, factor * z]


def crosses(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector products of two (n,3) arrays. numpy's function takes ten times as long, because it
    looks for the axis."""
    return a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]


def single(quaternion: np.ndarray) -> np.ndarray:
    """Rotation matrix (3,3) of one unit quaternion (4,), a tenth of the time of ``matrices``."""
    w, x, y, z = quaternion.tolist()
    return np.array(matrix((w, x, y, z))).reshape(3, 3)


def matrices(quaternion: np.ndarray) -> np.ndarray:
    """Rotation matrices (n,3,3) of unit quaternions (n,4)."""
    w, x, y, z = np.asarray(quaternion, dtype=float).T
    rows = [
        1 - 2 * (y * y + z * z),
        2 * (x * y - w * z),
        2 * (x * z + w * y),
        2 * (x * y + w * z),
        1 - 2 * (x * x + z * z),
        2 * (y * z - w * x),
        2 * (x * z - w * y),
        2 * (y * z + w * x),
        1 - 2 * (x * x + y * y),
    ]
    return np.stack(rows, axis=-1).reshape(-1, 3, 3)
