"""Peaks of von Mises stress, strain and rotation over all elements, from the displacement gradients
at their nodes.

With G the displacement gradient at a node of an element, e its symmetric and w its antisymmetric
part, and g the shear modulus, Hooke's law gives the equivalent stress::

    s^2 = g^2 (2 [(exx-eyy)^2 + (eyy-ezz)^2 + (ezz-exx)^2] + 3 [gxy^2 + gyz^2 + gzx^2])
          (shear strains in engineering measure)
    strain^2 = sum e_ij^2  (no principal strain is larger)
    rotation^2 = wyz^2 + wzx^2 + wxy^2  (rad^2)

Stresses of the elements that meet at a node are not averaged: the largest one is used, as is usual
in strength assessment.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import inlined

STRESS, STRAIN, ROTATION = 0, 1, 2


class Peak(NamedTuple):
    """Evolving: largest STRESS, STRAIN and ROTATION so far."""

    square: np.ndarray  # (3,) squares, that of the stress over the shear modulus
    place: np.ndarray  # (3,2) element and its node
    time: np.ndarray  # (3,) s


def no_peak() -> Peak:
    """No element seen yet."""
    return Peak(square=np.zeros(3), place=np.zeros((3, 2), dtype=np.int64), time=np.zeros(3))


@inlined
def measure(space, limit, gradient, squares, nodes):
    """Squares of STRESS, STRAIN, ROTATION at each of the ``nodes`` of an element, written from
    place ``squares`` of the workspace ``space``; returns how many of them are above ``limit`` (3,).

    ``gradient``: start of the nine components, each a row of all nodes, component * 3 + axis.
    Places are constants of the caller, so that the compiler knows the length of every loop.
    """
    above, stress_limit, strain_limit, rotation_limit = 0, limit[0], limit[1], limit[2]
    for k in range(nodes):
        n = gradient + k
        xx, xy, xz = space[n], space[n + nodes], space[n + 2 * nodes]
        yx, yy, yz = space[n + 3 * nodes], space[n + 4 * nodes], space[n + 5 * nodes]
        zx, zy, zz = space[n + 6 * nodes], space[n + 7 * nodes], space[n + 8 * nodes]
        a, b, c = xy + yx, yz + zy, zx + xz
        shear = a * a + b * b + c * c
        stress = (
            2.0 * ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx))
            + 3.0 * shear
        )
        strain = xx * xx + yy * yy + zz * zz + 0.5 * shear
        rotation = 0.25 * ((xy - yx) * (xy - yx) + (yz - zy) * (yz - zy) + (zx - xz) * (zx - xz))
        space[squares + k], space[squares + nodes + k], space[squares + 2 * nodes + k] = (
            stress,
            strain,
            rotation,
        )
        above += (stress > stress_limit) + (strain > strain_limit) + (rotation > rotation_limit)
    return above


@inlined
def note(space, peak, e, squares, nodes):
    """Raise ``peak`` to the squares of element ``e`` that ``measure`` wrote to ``space``."""
    for what in range(3):
        for k in range(nodes):
            if space[squares + nodes * what + k] > peak.square[what]:
                peak.square[what], peak.place[what, 0], peak.place[what, 1] = (
                    space[squares + nodes * what + k],
                    e,
                    k,
                )
