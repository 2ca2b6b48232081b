"""The rail's compliance under the pads of a study: found once for a rail and its pads, and kept in the
study's folder by content."""

import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from tipoff import sources
from tipoff.files import content_hash
from tipoff.mechanics.rail_compliance import Walls, digest
from tipoff.scenes.scene import Scene
from tipoff.studies.core.progress import say

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study


def load(study: "Study", scene: Scene, judged: bool = True) -> Walls | None:
    """Rail compliance under the pads of ``scene``, on the reference's own mesh where agreement is
    ``judged``; found if it is not kept. None without contact."""
    if scene.contact is None:
        return None
    size = study.settings.element_size
    if not judged and not path(study, scene, size).is_file():
        from tipoff.calibration.rail_compliance import fine_enough

        size = fine_enough(scene, size)
    file = path(study, scene, size)
    try:
        return Walls.load(file)
    except FileNotFoundError:
        pass
    except ValueError as fault:
        say(f"  {fault}, so it is found again")
    from tipoff import calibration

    say(f"rail compliance, once per rail and pads: {1e3 * size:g} mm elements, up to a minute")
    began = time.perf_counter()
    found = calibration.compliance(scene, size)
    found.save(file)
    say(f"  found in {time.perf_counter() - began:.3g} s, kept in {file}")
    return found


def of_law(study: "Study", scene: Scene) -> Walls | None:
    """What springs stand on in ``scene``: rigid walls where its rails are warm, else None."""
    found = load(study, scene) if scene.thermal is not None else None
    return found and found.rigid()


def under(study: "Study", names: Iterable[str]) -> dict[str, Walls | None]:
    """Rail compliance of each condition by name; conditions with the same rail and pads share
    it."""
    scenes = {name: study.condition(name) for name in names}
    known = {digest(scene): load(study, scene) for scene in scenes.values() if scene.contact}
    return {name: known[digest(scene)] if scene.contact else None for name, scene in scenes.items()}


def path(study: "Study", scene: Scene, element_size: float) -> Path:
    key = content_hash(
        digest(scene), element_size, sources.digest("tipoff.calibration.rail_compliance")
    )
    return study.path(f"compliance-{key[:8]}.npz")
