"""What the walls of a rail give way under the rearmost pads, all along their way to the open end: a part of the stage ``mesh``."""

import itertools

import numpy as np

from scenes import model as scene_model
from scenes.scene import Scene

_STATIONS = 52  # 4 mm apart on the reference rail, where front pads then come to the places of rear ones
_SAME = 1e-9  # m


def under_a_pad(scene: Scene, element_size: float, mesh) -> dict | None:
    """Compliance (m/N) under each face of the first of the rearmost pads, and between them, over the place (m) of their middle;
    None where it never has a wall under all of it."""
    from highfi import compliance

    faces = scene_model.built(scene).nominal
    pad = faces.pad[faces.centre[:, 0].argmin()]
    own = np.flatnonzero(faces.pad == pad)
    middle, half = faces.centre[own[0], 0], faces.half_length[own[0]]
    way = np.linspace(max(0.0, scene.rail.start + half - middle), scene.rail.end - half - middle, _STATIONS)
    found = compliance.along(scene, element_size, way, patterns=1)
    whole = (found.gram[:, own, 0, 0] > 1.0 - 1e-6).all(axis=1)
    if not whole.any():
        return None
    matrix = found.matrix[whole][:, own, 0][:, :, own, 0]
    names = [f"{'+' if faces.sign[face] > 0.0 else '-'}{'xyz'[faces.axis[face]]}" for face in own]
    return {"pad": int(pad), "place_m": (middle + way[whole]).tolist(),
            "mounts_m": _spans(mesh.points[mesh.surfaces["mount"]][:, :, 0]),
            "direct_m_per_n": {name: matrix[:, i, i].tolist() for i, name in enumerate(names)},
            "cross_m_per_n": {f"{names[i]} {names[j]}": matrix[:, i, j].tolist()
                              for i, j in itertools.combinations(range(len(names)), 2)}}


def _spans(facets: np.ndarray) -> list[list[float]]:
    """Stretches of X (m) that facets with nodes at ``facets`` (m,k) take up, those that touch put together."""
    spans: list[list[float]] = []
    for low, high in sorted(zip(facets.min(axis=1).tolist(), facets.max(axis=1).tolist())):
        if spans and low <= spans[-1][1] + _SAME:
            spans[-1][1] = max(spans[-1][1], high)
        else:
            spans.append([low, high])
    return spans
