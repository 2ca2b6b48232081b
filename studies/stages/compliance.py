"""Stage ``compliance``: what compliant contact takes from the finite elements, the rail's
compliance under the pads, by statics and without a single run of the reference.

Where agreement is judged the mesh is the reference's own; elsewhere it is the coarsest whose
compliance is within 1 % of that.
"""

import time
from pathlib import Path

from scenes import sources
from scenes.files import content_hash
from scenes.scene import Scene
from scenes.walls import Walls, digest
from studies.compliance import under_a_pad
from studies.progress import say
from studies.study import Study

NAME = "compliance"


def run(study: Study) -> dict:
    """``file``, null for a scene without contact; stations, the compliance under a pad, the seconds
    it took."""

    def make() -> tuple[dict, list[Path]]:
        began = time.perf_counter()
        found = load(study, study.scene)
        if found is None:
            return {"file": None, "under_a_pad": None}, []
        import highfi

        asked = study.highfi(next(iter(study.conditions)))
        mesh = highfi.prepare(asked.scene, asked.numerics)
        path = _path(study, study.scene, study.settings.element_size)
        return {
            "file": study.relative(path),
            "stations": len(found.travel),
            "rails": int(found.rail.max()) + 1,
            "element_size_m": study.settings.element_size,
            "wall_s": time.perf_counter() - began,
            "under_a_pad": under_a_pad(study.scene, found, mesh.points[mesh.surfaces["mount"]]),
        }, [path]

    return study.stage(NAME, study.key(__name__, study.settings.element_size), make)


def load(study: Study, scene: Scene, judged: bool = True) -> Walls | None:
    """Rail compliance under the pads of ``scene``, on the reference's own mesh where agreement is
    ``judged``; found if it is not kept. None without contact."""
    if scene.contact is None:
        return None
    size = study.settings.element_size
    if not judged and not _path(study, scene, size).is_file():
        from calibrate.rail_compliance import fine_enough

        size = fine_enough(scene, size)
    path = _path(study, scene, size)
    try:
        return Walls.load(path)
    except FileNotFoundError:
        pass
    except ValueError as fault:
        say(f"  {fault}, so it is found again")
    import calibrate

    say(f"rail compliance, once per rail and pads: {1e3 * size:g} mm elements, up to a minute")
    began = time.perf_counter()
    found = calibrate.compliance(scene, size)
    found.save(path)
    say(f"  found in {time.perf_counter() - began:.3g} s, kept in {path}")
    return found


def of_law(study: Study, scene: Scene) -> Walls | None:
    """What springs stand on in ``scene``: rigid walls where its rails are warm, else None."""
    found = load(study, scene) if scene.thermal is not None else None
    return found and found.rigid()


def under(study: Study, names) -> dict[str, Walls | None]:
    """Rail compliance of each condition by name; conditions with the same rail and pads share
    it."""
    scenes = {name: study.condition(name) for name in names}
    known = {digest(scene): load(study, scene) for scene in scenes.values() if scene.contact}
    return {name: known[digest(scene)] if scene.contact else None for name, scene in scenes.items()}


def _path(study: Study, scene: Scene, element_size: float) -> Path:
    key = content_hash(digest(scene), element_size, sources.digest("calibrate.rail_compliance"))
    return study.path(f"{NAME}-{key[:8]}.npz")
