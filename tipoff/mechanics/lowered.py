"""First guess of the place of a payload that rests on its rails."""

import numpy as np

from tipoff.kernels import rotation


def lowered(faces, place: np.ndarray, quaternion: np.ndarray, weight) -> np.ndarray:
    """Place (3,) m of the mass centre, moved from ``place`` along Y and along Z by the ``weight`` (3,)
    until a face is at a wall that carries it. ``faces`` and ``place`` are in the axes of the
    rails."""
    found = np.array(place, dtype=float)
    centres = found + faces.centre @ rotation.single(quaternion).T
    for axis in (1, 2):
        down = np.sign(weight[axis])
        below = (faces.axis == axis) & (faces.sign == down)
        if down and below.any():
            gaps = down * (faces.wall[below] - centres[below, axis])
            found[axis] += down * gaps.min()
    return found
