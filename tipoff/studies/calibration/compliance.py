"""Stage ``compliance``: compliance of the rail under the pads from statics, on elements of the
reference's size, without a run of the reference.
"""

import itertools
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import scene_model
from tipoff.scenes.scene import Scene
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

_SAME = 1e-9  # m


@dataclass(frozen=True, kw_only=True)
class UnderPad:
    """Compliance (m/N) of the walls under a pad, by face and between faces, over the place (m) of
    the middle of the pad; mounts are intervals of X (m)."""

    pad: int
    place_m: list[float]
    mounts_m: list[list[float]]
    direct_m_per_n: dict[str, list[float]]
    cross_m_per_n: dict[str, list[float]]


@dataclass(frozen=True, kw_only=True)
class Compliance:
    """The ``file`` with its number of ``stations`` and ``rails``; ``elements`` and their uncertainty; all
    None for a scene without contact."""

    file: str | None = None
    stations: int | None = None
    rails: int | None = None
    element_size_m: float | None = None
    elements: dict[str, Any] | None = None
    wall_s: float | None = None
    under_a_pad: UnderPad | None = None


def run(study: Study) -> Made[Compliance]:
    """The rail compliance under the pads."""

    def make() -> tuple[Compliance, list[Path]]:
        began = time.perf_counter()
        found = study.rail_compliance(study.scene)
        if found is None:
            return Compliance(), []
        from tipoff import highfi
        from tipoff.calibration.rail_compliance import kept_file

        request = study.highfi(next(iter(study.conditions)))
        mesh = highfi.prepare(request.scene, request.numerics)
        path = kept_file(study.scene, study.folder, study.settings.element_size)
        return Compliance(
            file=study.relative(path),
            stations=len(found.travel),
            rails=int(found.rail.max()) + 1,
            element_size_m=study.settings.element_size,
            elements=found.stated(),
            wall_s=time.perf_counter() - began,
            under_a_pad=_under_a_pad(study.scene, found, mesh.points[mesh.surfaces["mount"]]),
        ), [path]

    return STAGE.run(study, None, make)


STAGE = Stage(
    "compliance", __name__, inputs=lambda study, _: study.settings.element_size, result=Compliance
)


def _under_a_pad(scene: Scene, compliance: RailCompliance, mounts: np.ndarray) -> UnderPad:
    """Compliance under the first of the rearmost pads; ``mounts`` (m,k,3) m are the nodes of the clamped
    facets."""
    faces = scene_model.built(scene).nominal
    pad = faces.pad[faces.centre[:, 0].argmin()]
    own = np.flatnonzero(faces.pad == pad)
    matrix = compliance.compliance()[:, own][:, :, own]
    names = [f"{'+' if faces.sign[face] > 0.0 else '-'}{'xyz'[faces.axis[face]]}" for face in own]
    return UnderPad(
        pad=int(pad),
        place_m=(faces.centre[own[0], 0] + compliance.travel).tolist(),
        mounts_m=_spans(mounts[:, :, 0]),
        direct_m_per_n={name: matrix[:, i, i].tolist() for i, name in enumerate(names)},
        cross_m_per_n={
            f"{names[i]} {names[j]}": matrix[:, i, j].tolist()
            for i, j in itertools.combinations(range(len(names)), 2)
        },
    )


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
