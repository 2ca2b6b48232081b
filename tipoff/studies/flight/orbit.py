"""Relative motion beside a circular orbit, in closed form (Clohessy and Wiltshire, J. Aerospace
Sci. 27, 1960).

Orbit axes rotate with the mean motion n about z: x radially outwards, y along the flight, z along the
orbit's normal::

    x'' = 2 n y' + 3 n^2 x,     y'' = -2 n x',     z'' = -n^2 z

Gravity is linear in the distance from the orbit. The error is of the order of the squared distance over
the orbit's radius.
"""

import numpy as np


def transition(motion: float, time: np.ndarray) -> np.ndarray:
    """Transition matrices (...,6,6) over ``time`` (...) s of a state, place (m) and velocity (m/s)
    in orbit axes; ``motion`` rad/s."""
    n, angle = motion, motion * np.asarray(time, dtype=float)
    c, s = np.cos(angle), np.sin(angle)
    found = np.zeros((*angle.shape, 6, 6))
    for (row, column), value in {
        (0, 0): 4.0 - 3.0 * c,
        (1, 0): 6.0 * (s - angle),
        (1, 1): 1.0,
        (2, 2): c,
        (0, 3): s / n,
        (0, 4): 2.0 * (1.0 - c) / n,
        (1, 3): 2.0 * (c - 1.0) / n,
        (1, 4): (4.0 * s - 3.0 * angle) / n,
        (2, 5): s / n,
        (3, 0): 3.0 * n * s,
        (4, 0): 6.0 * n * (c - 1.0),
        (5, 2): -n * s,
        (3, 3): c,
        (3, 4): 2.0 * s,
        (4, 3): -2.0 * s,
        (4, 4): 4.0 * c - 3.0,
        (5, 5): c,
    }.items():
        found[..., row, column] = value
    return found


def state(motion: float, axes: np.ndarray, place: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """States (n,6) of free bodies at ``place`` (n,3) m from a point on the orbit with the relative
    ``velocity`` (n,3) m/s, both in axes that do not rotate; ``axes`` (3,3) converts these to orbit
    components."""
    r, v = place @ axes.T, velocity @ axes.T
    turning = np.stack([-motion * r[:, 1], motion * r[:, 0], np.zeros(len(r))], axis=1)
    return np.concatenate([r, v - turning], axis=1)


def places(motion: float, states: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Places (n,k,3) m in orbit axes of ``states`` (n,6) after ``time`` (n,k) s."""
    return np.einsum("nkij,nj->nki", transition(motion, time)[..., :3, :], states)


def back(motion: float, axes: np.ndarray, place: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Vectors (n,k,3) in orbit axes at ``time`` (n,k) s, converted to axes that do not rotate with
    the orbit."""
    c, s = np.cos(motion * time), np.sin(motion * time)
    held = np.stack(
        [
            c * place[..., 0] - s * place[..., 1],
            s * place[..., 0] + c * place[..., 1],
            place[..., 2],
        ],
        axis=-1,
    )
    return held @ axes
