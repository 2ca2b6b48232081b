"""Check that the arrays of a rail compliance from a file are consistent."""

import math
from typing import Any

import numpy as np

from tipoff.mechanics import drawn_walls
from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST
from tipoff.mechanics.rail_compliance.patterns import DRAGGED, degree_of

_ROUNDING = 1e-6


def require(found: Any) -> None:
    """Raise ValueError if types or shapes of ``found``, a ``RailCompliance``, are not consistent,
    or if a number is not finite."""
    for name in ("find_joints", "find_uncertainty"):
        if getattr(found, name) is not None:
            raise ValueError(f"{name}: given an array, expected none in a file")
    _require_plain(found)
    _require_dimensions("travel", found.travel, 1)
    _require_dimensions("rail", found.rail, 1, "iu")
    _require_dimensions("frequency", found.frequency, 2)
    _require_dimensions("shape", found.shape, 4)
    patterns = found.shape.shape[2]
    degree_of(patterns)
    stations, faces, modes = found.travel.size, found.rail.size, found.frequency.shape[1]
    if stations < 2:
        raise ValueError(f"travel: given {stations} stations, expected at least 2")
    if not (np.diff(found.travel) > 0.0).all():
        raise ValueError("travel: given stations out of order, expected rising ones")
    if not faces or found.rail.min() < 0:
        raise ValueError(f"rail: given {faces} faces, expected each on a rail of number 0 or more")
    rails, most = found.members.shape
    expected: dict[str, tuple[int, ...]] = {
        "flexibility": (stations, faces, most, patterns, patterns),
        "half": (faces, 2),
        "frequency": (rails, modes),
        "shape": (stations, faces, patterns, modes),
    }
    if found.warm is not None:
        expected["warm"] = (FIELDS, stations, faces, patterns)
    if found.part is not None:
        expected["part"] = (stations, faces, 2)
    if found.dragged is not None:
        expected["dragged"] = (stations, faces, most, DRAGGED, DRAGGED)
    if found.dragged_shape is not None:
        expected["dragged_shape"] = (stations, faces, DRAGGED, modes)
    if found.drawn is not None:
        _require_dimensions("drawn", found.drawn, 3)
        expected["drawn"] = (max(len(found.drawn), 2), faces, drawn_walls.ACROSS)
    if found.uncertainty is not None:
        expected["uncertainty"] = (faces,)
    for name, shape in expected.items():
        _require_shape(name, getattr(found, name), shape)
    if (terms := found.joints) is None:
        return
    _require_dimensions("joints.share", terms.share, 2)
    _require_dimensions("joints.shape", terms.shape, 4)
    count, shapes = terms.share.shape[1], max(terms.shape.shape[3], modes)
    for name, shape in {
        "share": (rails, count),
        "moved": (stations, faces, patterns, count),
        "moved_first": (stations, faces, DRAGGED, count),
        "moved_by_friction": (stations, faces, DRAGGED, count),
        "heated": (rails, count, FIELDS),
        "shape": (stations, faces, patterns, shapes),
        "dragged_shape": (stations, faces, DRAGGED, shapes),
        "stiffness": (rails, shapes, shapes),
        "joint": (rails, shapes, shapes),
    }.items():
        _require_shape(f"joints.{name}", getattr(terms, name), shape)
    if not ((terms.share >= 0.0) & (terms.share <= 1.0 + _ROUNDING)).all():
        raise ValueError("joints.share: given parts beyond 0 to 1")
    for factor in (LEAST, MOST):
        squares = np.linalg.eigvalsh(terms.stiffness + (factor - 1.0) * terms.joint)
        if not (squares > 0.0).all():
            raise ValueError(
                f"joints.stiffness: given none at {factor:g} of the joints, expected some"
            )


def _require_plain(found: Any) -> None:
    for name in ("made_for", "not_known"):
        if not isinstance(getattr(found, name), str):
            raise ValueError(f"{name}: given {getattr(found, name)!r}, expected a text")
    for name in ("element_size", "frequency_uncertainty"):
        value = getattr(found, name)
        if value is not None and not (isinstance(value, float) and 0.0 <= value < math.inf):
            raise ValueError(f"{name}: given {value!r}, expected a number not below zero")


def _require_dimensions(name: str, array: np.ndarray, dimensions: int, kinds: str = "f") -> None:
    if array.ndim != dimensions or array.dtype.kind not in kinds:
        raise ValueError(
            f"{name}: given shape {array.shape} of {array.dtype}, expected finite numbers in "
            f"{dimensions} dimensions"
        )


def _require_shape(name: str, array: np.ndarray, shape: tuple[int, ...]) -> None:
    if array.shape != shape or array.dtype.kind != "f" or not np.isfinite(array).all():
        raise ValueError(
            f"{name}: given shape {array.shape} of {array.dtype}, expected finite numbers in the "
            f"shape {shape}"
        )
