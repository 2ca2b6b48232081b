"""All that is probably wrong with the input of a study: values of a scene and of its conditions, and the
random errors that it states."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from tipoff.faults import SceneError
from tipoff.scenes import uncertainty
from tipoff.scenes.scene import Scene
from tipoff.scenes.variation import Variations

MOST_CASES = 1000  # that are examined; a case takes 1 ms


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


def of_cases(
    scene: Scene, count: int, rows: Callable[[int, int], Sequence[Mapping[str, Any]]]
) -> list[str]:
    """Messages on the fields of ``count`` cases of a scene that are plausible in the scene itself, each
    with its first case. ``rows`` gives the overrides of the cases from one number up to another. Of more
    than ``MOST_CASES``, as many are examined, evenly spread. A case that the scene refuses has none."""
    known = {words.partition(":")[0] for words in scene.warnings}
    first: dict[str, str] = {}
    doubtful: dict[str, int] = {}
    varied = Variations(scene)
    numbers = np.unique(np.linspace(0, count - 1, min(count, MOST_CASES)).round().astype(int))
    for number in numbers.tolist():
        try:
            found = varied.of(rows(number, number + 1)[0]).warnings
        except SceneError:
            continue
        for words in found:
            if (key := words.partition(":")[0]) not in known:
                first.setdefault(key, f"{words} (case {number}")
                doubtful[key] = doubtful.get(key, 0) + 1
    of = f"{len(numbers):,}" if len(numbers) == count else f"{len(numbers):,} examined"
    return [
        words + (f", and {more:,} more of {of})" if (more := doubtful[key] - 1) else ")")
        for key, words in first.items()
    ]
