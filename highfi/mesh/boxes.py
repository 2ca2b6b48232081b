"""Faces of a mesh file that lie in boxes.

A box takes the faces that lie in it completely. A face that a box cuts is a fault if it faces the same
way as a face that the box takes: it is a part of the same wall, and would be left out.
"""

import numpy as np

from tipoff.meshes.imprint import SAME

_LIKE = 0.99  # cosine between normals of one wall
_PROBES = (np.arange(8) + 0.5) / 8.0  # along both sides of a face
_SHOWN = 4  # boxes with faults


def chosen(
    points: np.ndarray, faces: np.ndarray, boxes: np.ndarray
) -> tuple[np.ndarray, list[str]]:
    """Which faces (f,4) or (f,3) lie in one of the ``boxes`` (b,2,3) m, and what is wrong with a
    box. A mesh without faces has other faults."""
    if not len(faces):
        return np.zeros(0, dtype=bool), []
    corners = points[faces]
    normals = _normals(corners)
    found, faults = np.zeros(len(faces), dtype=bool), []
    for number, (low, high) in enumerate(boxes, 1):
        inside = ((corners > low - SAME) & (corners < high + SAME)).all(axis=(1, 2))
        found |= inside
        if not inside.any():
            low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
            faults.append(
                f"box {number} contains no face of an element; the mesh has {reach(low, high)}; "
                "rail.unit, rail.axes and rail.origin place it"
            )
            continue
        alike = (normals @ np.unique(normals[inside].round(2), axis=0).T > _LIKE).any(axis=1)
        cut = np.flatnonzero(alike & ~inside)
        cut = cut[_is_cut(corners[cut], low, high)]
        if len(cut):
            first = corners[cut[0]]
            faults.append(
                f"box {number} cuts {len(cut)} faces of elements, the first with "
                f"{reach(first.min(axis=0), first.max(axis=0))}; let it end between elements"
            )
    return found, faults[:_SHOWN]


def reach(low: np.ndarray, high: np.ndarray) -> str:
    """Text of the extent between two corners (3,) m."""
    return ", ".join(f"{axis} {a:.6g} to {b:.6g} m" for axis, a, b in zip("xyz", low, high))


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normals (f,3); zero for flat faces."""
    last = corners[:, 3] if corners.shape[1] == 4 else corners[:, 0]
    across = np.cross(corners[:, 2] - corners[:, 0], last - corners[:, 1])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, length, out=np.zeros_like(across), where=length > 0.0)


def _is_cut(corners: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which faces (f,) have points in a box. A triangle is a quadrilateral of which two corners
    coincide."""
    four = corners if corners.shape[1] == 4 else corners[:, [0, 1, 2, 2]]
    r, s = (grid.ravel() for grid in np.meshgrid(_PROBES, _PROBES))
    weights = np.stack([(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s])
    places = np.einsum("kp,fki->fpi", weights, four)
    return ((places > low - SAME) & (places < high + SAME)).all(axis=2).any(axis=1)
