"""Agreement on other rails, from the folders beside that of a scene."""

from dataclasses import replace
from pathlib import Path

from tipoff import scenes
from tipoff.mechanics.rail_compliance import digest
from tipoff.studies.agreement import stage as compare
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, picked


def beside(folder: Path) -> list[dict]:
    """Agreement and constants of the catalogue's scenes with other rails or pads, from current
    results in folders beside ``folder``."""
    found, own = [], digest(scenes.load(folder.name)) if folder.name in scenes.catalog() else None
    for path in sorted(folder.parent.glob("*/agreement.json")):
        name = path.parent.name
        if name not in scenes.catalog() or digest(scenes.load(name)) == own:
            continue
        size = picked(path, lambda found: float(found["element_size_m"]))
        if size is None:
            continue
        other = Study(scenes.load(name), path.parent, replace(defaults(name), element_size=size))
        if agreement := compare.stored(other):
            constants = picked(
                other.path("calibration.json"), lambda found: dict(found["constants"])
            )
            if constants is None:
                continue
            found.append(
                {
                    "name": name,
                    "element_size_m": size,
                    "agreement": agreement,
                    "constants": constants,
                }
            )
    return found
