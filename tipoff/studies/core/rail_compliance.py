"""The rail's compliance under the pads of a study: found once for a rail and its pads, and kept in the
study's folder by content."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

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
    from tipoff.calibration import rail_compliance  # slow to load

    size = study.settings.element_size
    if not judged and not rail_compliance.kept_file(scene, study.folder, size).is_file():
        size = rail_compliance.fine_enough(scene, size)
    return rail_compliance.kept(scene, study.folder, size, say)


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
