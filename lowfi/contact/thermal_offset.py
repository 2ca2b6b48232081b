"""Thermal offset of warm walls, for contact springs with one point per face.

With W(x) the offset of the wall away from the payload, as a mean over a face whose centre is at x
along the rail, in platform axes, n the outward normal of the straight wall and e the unit vector
along the rail::

    p = n . x - wall - W,     dp/dx = n - W' e

Contact pushes along dp/dx and friction acts across it, so a wall that recedes ahead pushes forward,
and no energy is lost. W is the cubic spline through the statics of the rail
(``mechanics.rail_compliance``), and continues straight beyond its ends.
"""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.kernels.reference import by_reference
from tipoff.mechanics.model import Model
from tipoff.mechanics.rail_compliance import GRAM, RailCompliance, cubic
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import Scene


@by_reference
class ThermalOffset(NamedTuple):
    """Thermal offset W of the walls under f faces, between s stations along the rail."""

    cubic: np.ndarray  # (s-1, f, 4) W (m) as powers of the distance (m) from the station before
    spacing: float  # m, between stations
    origin: np.ndarray  # (f,) m, X of the first station: the centre of the face at ignition


def under_pads(
    scene: Scene, model: Model, compliance: RailCompliance | None
) -> ThermalOffset | None:
    """Record for the kernels; None without temperatures or contact, and for compliant contact, which
    holds the offset itself. Raises SceneError as ``require`` does."""
    require(scene, compliance)
    if model.thermal is None or model.contact is None:
        return None
    assert compliance is not None  # by require
    if compliance.flexibility is not None:
        return None
    mean = compliance.of(scene).moved(model.thermal.amounts) @ GRAM[0]
    platform = model.platform.mass_centre[0] if model.platform is not None else 0.0
    origin = model.faces.centre[:, 0] + (model.payload.mass_centre[0] - platform)
    return ThermalOffset(
        cubic(compliance.travel, mean),
        float(compliance.travel[1] - compliance.travel[0]),
        np.ascontiguousarray(origin),
    )


def require(scene: Scene, compliance: RailCompliance | None) -> None:
    """Raises SceneError for a warm scene without rail compliance, and for that of another rail."""
    if scene.thermal is None or scene.contact is None:
        return
    if compliance is None:
        expected = (
            "a rail compliance (tipoff.compliance(scene)), or its rigid() for contact springs"
        )
        raise SceneError([Fault(scene.name, "thermal", "no rail compliance", expected)])
    compliance.require(scene)


@kernel
def offset_and_slope(offset, number, x):
    """W (m) under face ``number`` with its centre at ``x`` (m), and its slope."""
    way = x - offset.origin[number]
    inside = min(max(way, 0.0), offset.spacing * offset.cubic.shape[0])
    station = min(int(inside / offset.spacing), offset.cubic.shape[0] - 1)
    c, s = offset.cubic[station, number], inside - station * offset.spacing
    slope = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + (way - inside) * slope, slope
