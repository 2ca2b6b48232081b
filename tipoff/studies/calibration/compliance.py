"""Stage ``compliance``: compliance of the rail under the pads, from the statics of the finite
elements, without a run of the reference.

Where agreement is judged, the mesh is that of the reference; elsewhere it is the coarsest mesh whose
compliance is within 1 % of that.
"""

import time
from pathlib import Path

from tipoff.studies.calibration.under_a_pad import under_a_pad
from tipoff.studies.core.study import Study

NAME = "compliance"


def run(study: Study) -> dict:
    """``file``, null for a scene without contact; number of stations, compliance under a pad (m/N),
    wall time (s)."""

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
            "wall_s": time.perf_counter() - began,
            "under_a_pad": under_a_pad(study.scene, found, mesh.points[mesh.surfaces["mount"]]),
        }, [path]

    return study.stage(NAME, study.key(__name__, study.settings.element_size), make)
