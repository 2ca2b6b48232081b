"""Offset of walls that are warm or not straight as drawn, for contact springs with one point per face.

With W(x) the mean offset of the wall away from the payload over a face with its centre at x along
the rail, in platform axes, n the outward normal of the straight wall and e the unit vector along
the rail::

    p = n . x - wall - W,     dp/dx = n - W' e

Contact pushes along dp/dx, and friction acts across it. So a wall that recedes ahead pushes
forward, and no energy is lost. W is the cubic spline through the statics of the rail
(``mechanics.rail_compliance``) and through means of the wall as drawn (``mechanics.drawn_walls``).
It continues straight beyond its ends.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.kernels.jit import kernel
from tipoff.kernels.reference import by_reference
from tipoff.mechanics import drawn_walls
from tipoff.mechanics.model import Model
from tipoff.mechanics.rail_compliance import RailCompliance, cubic


@by_reference
class ThermalOffset(NamedTuple):
    """Offset W of the walls under f faces, between s stations along the rail."""

    cubic: np.ndarray  # (s-1, f, 4) W (m) as powers of the distance (m) from the station before
    spacing: float  # m, between stations
    origin: np.ndarray  # (f,) m, X of the centre of the face at the first station


def under_pads(model: Model, compliance: RailCompliance | None) -> ThermalOffset | None:
    """Record of the rail ``compliance`` of a scene. None for walls without offset, and for compliant
    contact, which contains the offset itself."""
    if compliance is None or compliance.flexibility is not None:
        return None
    platform = model.platform.mass_centre[0] if model.platform is not None else 0.0
    origin = model.faces.centre[:, 0] + (model.payload.mass_centre[0] - platform)
    travel, mean = compliance.travel, None
    if model.thermal is not None:
        offset = compliance.moved(model.thermal.amounts)
        mean = (offset * compliance.gram[..., 0, :]).sum(axis=-1)
    if compliance.drawn is not None:
        fine = drawn_walls.grid(travel[0], travel[-1])
        warm = 0.0 if mean is None else scipy.interpolate.CubicSpline(travel, mean)(fine)
        travel, mean = fine, warm + _drawn_mean(compliance.drawn, model, fine, origin)
    if mean is None:
        return None
    return ThermalOffset(
        cubic(travel, mean),
        float(travel[1] - travel[0]),
        np.ascontiguousarray(origin + travel[0]),
    )


def _drawn_mean(
    drawn: np.ndarray, model: Model, travel: np.ndarray, origin: np.ndarray
) -> np.ndarray:
    """Means (s,f) m of the walls as drawn under faces whose middles are at X = ``origin`` (f,) m plus
    ``travel`` (s,) m."""
    places = np.linspace(model.rail_start, model.rail_end, len(drawn))
    return np.column_stack(
        [
            drawn_walls.mean(places, drawn[:, face], first + travel, half)
            for face, (first, half) in enumerate(zip(origin, model.faces.half_length))
        ]
    )


@kernel
def offset_and_slope(offset, number, x):
    """W (m) under face ``number`` with its centre at ``x`` (m), and its slope."""
    way = x - offset.origin[number]
    inside = min(max(way, 0.0), offset.spacing * offset.cubic.shape[0])
    station = min(int(inside / offset.spacing), offset.cubic.shape[0] - 1)
    c, s = offset.cubic[station, number], inside - station * offset.spacing
    slope = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + (way - inside) * slope, slope
