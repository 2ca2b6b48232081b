"""Where warm walls stand, for a contact law with one point per face.

With W(x) the mean over a face of how far its wall stands away from the payload when the face's
centre is at x along the rail, in platform axes, n the outward normal of the straight wall and e the
unit vector along the rail::

    p = n . x - wall - W,     dp/dx = n - W' e

Contact pushes along dp/dx and friction acts across it, so a wall that recedes ahead pushes forward,
and no energy is lost on the way. W is the cubic spline through what the statics of the rail has
found (``mechanics.rail_compliance``), and goes on straight beyond its ends.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import inlined
from tipoff.mechanics.model import Model
from tipoff.mechanics.rail_compliance import GRAM, RailCompliance, cubic
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import Scene


class Bow(NamedTuple):
    """cubic (s-1,f,4): W between stations as powers of the way (m) from the one before, ``spacing``
    (m) apart from ``origin`` (f,), X (m) of the centres at ignition, on."""

    cubic: np.ndarray
    spacing: float
    origin: np.ndarray


def under_pads(scene: Scene, model: Model, compliance: RailCompliance | None) -> Bow | None:
    """Record for the kernels; None where nothing is warm, nothing touches, or walls that give way
    know it themselves. Raises SceneError as ``require`` does."""
    require(scene, compliance)
    if model.thermal is None or model.contact is None:
        return None
    assert compliance is not None  # which was required
    if compliance.flexibility is not None:
        return None
    mean = compliance.moved(model.thermal.amounts) @ GRAM[0]
    platform = model.platform.mass_centre[0] if model.platform is not None else 0.0
    origin = model.faces.centre[:, 0] + (model.payload.mass_centre[0] - platform)
    return Bow(
        cubic(compliance.travel, mean),
        float(compliance.travel[1] - compliance.travel[0]),
        np.ascontiguousarray(origin),
    )


def require(scene: Scene, compliance: RailCompliance | None) -> None:
    """Raises SceneError for a warm scene without walls, and for walls of another rail."""
    if scene.thermal is None or scene.contact is None:
        return
    if compliance is None:
        expected = (
            "walls found for warm rails (highfi.compliance.walls), or their rigid() for a "
            "contact law to stand on"
        )
        raise SceneError([Fault(scene.name, "thermal", "no walls", expected)])
    compliance.require(scene)


@inlined
def stand(bow, number, x):
    """W (m) under face ``number`` with its centre at ``x`` (m), and its slope."""
    way = x - bow.origin[number]
    inside = min(max(way, 0.0), bow.spacing * bow.cubic.shape[0])
    station = min(int(inside / bow.spacing), bow.cubic.shape[0] - 1)
    c, s = bow.cubic[station, number], inside - station * bow.spacing
    slope = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + (way - inside) * slope, slope
