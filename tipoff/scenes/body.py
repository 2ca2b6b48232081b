"""Inertia of a rigid body: the table of a scene file and the tensor of the kernels."""

import numpy as np
from pydantic import model_validator

from tipoff.scenes.rounding import below
from tipoff.scenes.table import Table
from tipoff.scenes.units import Inertia, PositiveInertia


class InertiaTensor(Table):
    """Inertia tensor (kg m2) about the mass centre in body axes. xy, xz, yz are entries of the
    tensor, not products of inertia of opposite sign."""

    #: Moment of inertia about x.
    xx: PositiveInertia
    #: Moment of inertia about y.
    yy: PositiveInertia
    #: Moment of inertia about z.
    zz: PositiveInertia
    #: Tensor entry xy, minus the integral of x y dm.
    xy: Inertia = 0.0
    #: Tensor entry xz, minus the integral of x z dm.
    xz: Inertia = 0.0
    #: Tensor entry yz, minus the integral of y z dm.
    yz: Inertia = 0.0

    @model_validator(mode="after")
    def _physical(self):
        moments = np.linalg.eigvalsh(tensor(self))
        given = f"its principal moments are {', '.join(f'{each:.6g}' for each in moments)} kg m2"
        if moments[0] <= 0.0:
            raise ValueError(f"a positive definite inertia tensor ({given})")
        if below(moments[0] + moments[1], moments[2]):
            raise ValueError(
                f"principal moments that satisfy the triangle inequality I1 + I2 >= I3 ({given})"
            )
        return self


def inverse(inertia: np.ndarray) -> np.ndarray:
    """Inverse (3,3) of an ``inertia`` tensor (3,3) by its principal axes. It is symmetric, and its
    axes are accurate to rounding even if one moment is far below the others."""
    moments, axes = np.linalg.eigh(inertia)
    whole = (axes / moments) @ axes.T
    return 0.5 * (whole + whole.T)


def tensor(inertia: InertiaTensor) -> np.ndarray:
    """The (3,3) tensor (kg m2) of an inertia table."""
    return np.array(
        [
            [inertia.xx, inertia.xy, inertia.xz],
            [inertia.xy, inertia.yy, inertia.yz],
            [inertia.xz, inertia.yz, inertia.zz],
        ]
    )
