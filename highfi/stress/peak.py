"""The worst node of all elements, as an evolving record: von Mises stress, strain and rotation of a
displacement gradient.

With G the displacement gradient at a node of an element, e its symmetric and w its antisymmetric
part, and g the shear modulus, Hooke's law leaves of the equivalent stress::

    s^2 = g^2 (2 [(exx-eyy)^2 + (eyy-ezz)^2 + (ezz-exx)^2] + 3 [gxy^2 + gyz^2 + gzx^2])
          (shear strains in engineering measure)
    strain^2 = sum e_ij^2  (no principal strain is larger)
    rotation^2 = wyz^2 + wzx^2 + wxy^2  (rad^2)

Stresses of the elements that meet at a node are not averaged: the worst one counts, as it does
where strength is judged.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import inlined

STRESS, STRAIN, ROTATION = 0, 1, 2


class Worst(NamedTuple):
    """Evolving: largest square (3,) of STRESS over the shear modulus, STRAIN, ROTATION; where
    (3,2), element and its node; when (3,) s."""

    square: np.ndarray
    place: np.ndarray
    time: np.ndarray


def nothing() -> Worst:
    """No element looked at yet."""
    return Worst(np.zeros(3), np.zeros((3, 2), dtype=np.int64), np.zeros(3))


@inlined
def measure(room, known, gradient, squares, nodes):
    """Squares of STRESS, STRAIN, ROTATION at each of the ``nodes`` of an element, put from
    ``squares`` on in ``room``; returns how many of them are above those ``known``.

    ``gradient``: where the nine components begin, each a row of all nodes, component * 3 + axis.
    Places are numbers written in the caller, so that every loop has a length its compiler knows.
    """
    above, stress_known, strain_known, rotation_known = 0, known[0], known[1], known[2]
    for k in range(nodes):
        n = gradient + k
        xx, xy, xz = room[n], room[n + nodes], room[n + 2 * nodes]
        yx, yy, yz = room[n + 3 * nodes], room[n + 4 * nodes], room[n + 5 * nodes]
        zx, zy, zz = room[n + 6 * nodes], room[n + 7 * nodes], room[n + 8 * nodes]
        a, b, c = xy + yx, yz + zy, zx + xz
        shear = a * a + b * b + c * c
        stress = (
            2.0 * ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx))
            + 3.0 * shear
        )
        strain = xx * xx + yy * yy + zz * zz + 0.5 * shear
        rotation = 0.25 * ((xy - yx) * (xy - yx) + (yz - zy) * (yz - zy) + (zx - xz) * (zx - xz))
        room[squares + k], room[squares + nodes + k], room[squares + 2 * nodes + k] = (
            stress,
            strain,
            rotation,
        )
        above += (stress > stress_known) + (strain > strain_known) + (rotation > rotation_known)
    return above


@inlined
def note(room, worst, e, squares, nodes):
    """Raise ``worst`` to the squares that ``measure`` left in ``room`` for element ``e``."""
    for what in range(3):
        for k in range(nodes):
            if room[squares + nodes * what + k] > worst.square[what]:
                worst.square[what], worst.place[what, 0], worst.place[what, 1] = (
                    room[squares + nodes * what + k],
                    e,
                    k,
                )
