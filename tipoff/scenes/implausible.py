"""All that is probably wrong with the input of a study: values of a scene and of its conditions, and the
random errors that it states."""

from tipoff.scenes import uncertainty
from tipoff.scenes.faults import SceneError
from tipoff.scenes.scene import Scene


def of_all_conditions(scene: Scene) -> list[str]:
    """Messages on a scene, those on its conditions with other keys, and those on its random errors."""
    found: dict[str, str] = {}
    for name in (None, *scene.conditions):
        for words in scene.warnings if name is None else scene.condition(name).warnings:
            found.setdefault(
                words.partition(":")[0], words if name is None else f"{words} (condition {name})"
            )
    return [*found.values(), *_of_errors(scene)]


def _of_errors(scene: Scene) -> list[str]:
    """Messages on the errors that the scene states, if they can be read; their faults are those of the study
    that draws them."""
    try:
        stated = uncertainty.of_scene(scene)
    except SceneError:
        return []
    return uncertainty.far_from_scene(stated, scene) if stated else []
