"""Stage ``compliance``: compliance of the rail under the pads, from the statics of the finite
elements of the size of the reference's, without a run of the reference.
"""

import itertools
import time
from pathlib import Path

import numpy as np

from tipoff.mechanics import model as scene_model
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.scene import Scene
from tipoff.workspace.study import Study

NAME = "compliance"
_SAME = 1e-9  # m


def run(study: Study) -> dict:
    """``file``, null for a scene without contact; ``elements`` and their uncertainty; number of
    stations, compliance under a pad (m/N), wall time (s)."""

    def make() -> tuple[dict, list[Path]]:
        began = time.perf_counter()
        found = study.rail_compliance(study.scene)
        if found is None:
            return {"file": None, "under_a_pad": None}, []
        from tipoff import highfi
        from tipoff.calibration.rail_compliance import kept_file

        request = study.highfi(next(iter(study.conditions)))
        mesh = highfi.prepare(request.scene, request.numerics)
        path = kept_file(study.scene, study.folder, study.settings.element_size)
        return {
            "file": study.relative(path),
            "stations": len(found.travel),
            "rails": int(found.rail.max()) + 1,
            "element_size_m": study.settings.element_size,
            "elements": found.stated(),
            "wall_s": time.perf_counter() - began,
            "under_a_pad": _under_a_pad(study.scene, found, mesh.points[mesh.surfaces["mount"]]),
        }, [path]

    return study.stage(NAME, study.key(__name__, study.settings.element_size), make)


def _under_a_pad(scene: Scene, compliance: RailCompliance, mounts: np.ndarray) -> dict:
    """Compliance (m/N) under each face of the first of the rearmost pads, and between them, over
    the place (m) of their middle; ``mounts`` (m,k,3) m are the nodes of the clamped facets."""
    faces = scene_model.built(scene).nominal
    pad = faces.pad[faces.centre[:, 0].argmin()]
    own = np.flatnonzero(faces.pad == pad)
    matrix = compliance.compliance()[:, own][:, :, own]
    names = [f"{'+' if faces.sign[face] > 0.0 else '-'}{'xyz'[faces.axis[face]]}" for face in own]
    return {
        "pad": int(pad),
        "place_m": (faces.centre[own[0], 0] + compliance.travel).tolist(),
        "mounts_m": _spans(mounts[:, :, 0]),
        "direct_m_per_n": {name: matrix[:, i, i].tolist() for i, name in enumerate(names)},
        "cross_m_per_n": {
            f"{names[i]} {names[j]}": matrix[:, i, j].tolist()
            for i, j in itertools.combinations(range(len(names)), 2)
        },
    }


def _spans(facets: np.ndarray) -> list[list[float]]:
    """Intervals of X (m) covered by facets with nodes at ``facets`` (m,k); adjacent intervals are
    merged."""
    spans: list[list[float]] = []
    for low, high in sorted(zip(facets.min(axis=1).tolist(), facets.max(axis=1).tolist())):
        if spans and low <= spans[-1][1] + _SAME:
            spans[-1][1] = max(spans[-1][1], high)
        else:
            spans.append([low, high])
    return spans
