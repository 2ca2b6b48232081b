"""Stage ``walls``: how the rail gives way under the pads, from the matrices of the reference and without a single run of it."""

import time
from pathlib import Path

from scenes.files import content_hash
from scenes.scene import Scene
from scenes.walls import Walls, digest
from studies.compliance import under_a_pad
from studies.progress import say
from studies.store import SOURCES, code_hash
from studies.study import Study


def run(study: Study) -> dict:
    """``walls``: the file, null for a scene without contact; stations, the compliance under a pad, the seconds it took."""
    def make() -> tuple[dict, list[Path]]:
        began = time.perf_counter()
        found = load(study, study.scene)
        if found is None:
            return {"walls": None, "compliance": None}, []
        import highfi

        asked = study.highfi(next(iter(study.conditions)))
        mesh = highfi.prepare(asked.scene, asked.numerics)
        path = _path(study, study.scene)
        return {"walls": study.relative(path), "stations": len(found.travel), "rails": int(found.rail.max()) + 1,
                "element_size_m": study.settings.element_size, "wall_s": time.perf_counter() - began,
                "compliance": under_a_pad(study.scene, found, mesh.points[mesh.surfaces["mount"]])}, [path]

    return study.stage("walls", study.key(SOURCES["highfi"], study.settings.element_size), make)


def load(study: Study, scene: Scene) -> Walls | None:
    """Walls for the rail and pads of ``scene``, found if they are not there; None without contact."""
    if scene.contact is None:
        return None
    path = _path(study, scene)
    try:
        return Walls.load(path)
    except FileNotFoundError:
        pass
    except ValueError as fault:
        say(f"  {fault}, so they are found again")
    from highfi import compliance

    found = compliance.walls(scene, study.settings.element_size)
    found.save(path)
    return found


def of_law(study: Study, scene: Scene) -> Walls | None:
    """What a contact law stands on in ``scene``: rigid walls where its rails are warm, else None, walls as they were mounted."""
    found = load(study, scene) if scene.thermal is not None else None
    return found and found.rigid()


def under(study: Study, names) -> dict[str, Walls | None]:
    """Walls of each condition by name; conditions with the same rail and pads share them."""
    scenes = {name: study.condition(name) for name in names}
    known = {digest(scene): load(study, scene) for scene in scenes.values() if scene.contact}
    return {name: known[digest(scene)] if scene.contact else None for name, scene in scenes.items()}


def _path(study: Study, scene: Scene) -> Path:
    key = content_hash(digest(scene), study.settings.element_size, code_hash(*SOURCES["highfi"]))
    return study.path(f"walls-{key[:8]}.npz")
