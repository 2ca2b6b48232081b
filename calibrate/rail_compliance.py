"""The rail's compliance under the pads, computed from the finite elements and stored in a folder.

Its elements have the size of the reference by default. So all commands and the Python interface use
the same compliance, and a surrogate is judged with the compliance of its results.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from tipoff import cache, sources
from tipoff.files import content_hash, tell
from tipoff.highfi.rail import inputs
from tipoff.mechanics.rail_compliance import DEGREE, RailCompliance, content, stored
from tipoff.mechanics.rail_compliance.joint_terms import JointTerms
from tipoff.remaining import Remaining
from tipoff.scenes import scene_model
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.scene import Scene
from tipoff.scenes.studies import ELEMENT_SIZE
from tipoff.scenes.studies import element_size as own_size

_SAID: set[Path] = set()  # files whose uncertainty was reported
_DECIDES = {"rail", "pads", "contact", "platform"}  # tables that determine ``made_from``
_PLACES = 4  # stations along the rail at which meshes are compared
# A loop over scenes with one rail reads it once.
KEPT: cache.Cache[RailCompliance] = cache.binary(content, RailCompliance.load, cache.Held)
# of long rails; that of others is in the file of their compliance
KEPT_UNCERTAINTY = cache.documents(stored.plain_uncertainty, stored.uncertainty)
KEPT_JOINTS = cache.binary(stored.content_of_joints, stored.read_joints)


def compliance(
    scene: Scene, element_size: float | None = None, degree: int = DEGREE
) -> RailCompliance:
    """Compliance of the rails of ``scene`` under its pads, with the modes of the rails and the
    uncertainty by the elements, in elements of ``element_size`` (m), by default those of the
    reference (``scenes.studies``), for patterns of this ``degree``.

    Takes seconds to minutes, once for a rail and its pads. Raises SceneError or MeshError.
    """
    size = element_size or own_size(scene.studies, scene.rail.length)
    found = computed(scene, size, degree, waits=True)
    return found.finding(partial(_joints, scene, size, degree))


def computed(scene: Scene, size: float, degree: int, waits: bool) -> RailCompliance:
    """As ``compliance``, without terms for other mounts; a long rail has its uncertainty only if the
    caller ``waits`` for it."""
    from tipoff.highfi import compliance as statics  # slow to load
    from tipoff.highfi import discretisation

    rails = statics.rails(scene, size)
    found = statics.condense(scene, size, held=rails, degree=degree)
    if found.nodes is not None and not waits:
        return replace(found, element_size=discretisation.size_of(scene, size))
    return discretisation.stated(scene, size, found, rails)


def _joints(scene: Scene, element_size: float, degree: int) -> JointTerms | None:
    """The terms of all factors on the stiffness of the mounts; None for rigid ones."""
    from tipoff.highfi import compliance as statics  # slow to load

    if scene.rail.mount_stiffness is None:
        return None
    return statics.condense(scene, element_size, degree=degree, joints=True).joints


def walls(scene: Scene, element_size: float | None = None) -> RailCompliance | None:
    """The rigid walls that springs of ``scene`` need if they may be offset: warm, with the statics
    of ``compliance``, or from a file, as drawn. None for the built-in section, which is straight,
    and without contact. ``element_size`` (m) is that of a solid. Raises SceneError or MeshError."""
    if scene.contact is None:
        return None
    if scene.thermal is not None:
        return compliance(scene, element_size).rigid()
    from tipoff.highfi import compliance as statics  # slow to load

    return statics.walls(scene, element_size or own_size(scene.studies, scene.rail.length))


def kept(
    scene: Scene,
    folder: Path,
    element_size: float,
    say: Callable[[str], None] | None = None,
    degree: int = DEGREE,
) -> RailCompliance:
    """As ``compliance``, in elements of ``element_size`` (m), read from ``folder`` if it is stored
    there for this rail, these pads and this code, else computed and stored. ``say`` gets messages
    on long computations and, once per process and file, the uncertainty by the elements. That of a long
    rail is computed when it is first used, because it takes longer than the first runs."""
    key = _key(scene, element_size, degree)
    path = cache.file(folder, "compliance", key, ".npz")
    say = say or (lambda _: None)
    found = KEPT.get_or_make(
        path, key, "it is computed again", lambda: _made(scene, element_size, degree, path, say)
    )
    found.finding(partial(_kept_joints, scene, folder, element_size, degree))
    if found.nodes is not None:  # a long rail
        found.finding_uncertainty(partial(_kept_uncertainty, scene, folder, element_size, degree))
    elif path not in _SAID:
        _SAID.add(path)
        say(f"  {found.accuracy()}")
    return found


def _kept_uncertainty(scene: Scene, folder: Path, size: float, degree: int) -> dict[str, Any]:
    """As ``discretisation.Uncertainty.stated``, from a file beside that of the compliance."""

    def made() -> dict[str, Any]:
        from tipoff.highfi import discretisation  # slow to load
        from tipoff.highfi.rail import places

        tell(
            f"uncertainty of the rail compliance by {500.0 * size:g} mm elements, once; takes up to "
            "minutes"
        )
        with places.progress_to(_Waiting(tell, time.perf_counter)):
            return discretisation.of_scene(scene, size).stated()

    key = _key(scene, size, degree)
    path = cache.file(folder, "uncertainty", key, ".json")
    return KEPT_UNCERTAINTY.get_or_make(path, key, "it is computed again", made)


def _kept_joints(scene: Scene, folder: Path, element_size: float, degree: int) -> JointTerms | None:
    """As ``_joints``, from a file beside that of the compliance."""
    if scene.rail.mount_stiffness is None:
        return None

    def made() -> JointTerms:
        tell(
            "terms for other stiffnesses of the mounts, once per rail and pads; takes as long again"
        )
        terms = _joints(scene, element_size, degree)
        assert terms is not None
        return terms

    key = _key(scene, element_size, degree)
    path = cache.file(folder, "joints", key, ".npz")
    return KEPT_JOINTS.get_or_make(path, key, "it is computed again", made)


def _made(
    scene: Scene, element_size: float, degree: int, path: Path, say: Callable[[str], None]
) -> RailCompliance:
    from tipoff.highfi.rail import places  # slow to load

    say(
        f"rail compliance, once per rail and pads: {1e3 * element_size:g} mm elements"
        f"{_why(scene, element_size)}; takes seconds to minutes"
    )
    began = time.perf_counter()
    with places.progress_to(_Waiting(say, time.perf_counter)):
        found = computed(scene, element_size, degree, waits=False)
    say(f"  computed in {time.perf_counter() - began:.3g} s, stored in {path}")
    return found


def _why(scene: Scene, element_size: float) -> str:
    """Why elements are larger than usual."""
    length, stated = scene.rail.length, scene.studies and scene.studies.element_size
    if stated or element_size != own_size(None, length) or element_size == ELEMENT_SIZE:
        return ""
    return f" (the default for a rail of {length:.3g} m)"


class _Waiting:
    """Reports the remaining time of parts of the work of more than ``LONG`` seconds by the ``clock``: at
    each quarter, and after ``SILENT`` seconds without a line. The speed is counted from the first
    report of a part, because a mesh is made before it."""

    LONG, SILENT = 30.0, 60.0

    def __init__(self, say: Callable[[str], None], clock: Callable[[], float]):
        self._say, self._clock = say, clock
        self._part, self._began, self._next = "", 0.0, 0.0
        self._remaining = Remaining(0.0)
        self._said = clock()
        self._advises = True

    def __call__(self, fraction: float, part: str = "loads") -> None:
        now = self._clock()
        if part != self._part:
            self._part, self._began, self._next = part, now, 0.0
            self._remaining = Remaining(now, fraction)
            return
        self._remaining.note(now, fraction)
        left = self._remaining.seconds(now)
        if fraction >= 1.0 or (left is not None and now - self._began + left < self.LONG):
            return
        if (left is None or fraction < self._next) and now - self._said < self.SILENT:
            return
        words = self._remaining.words(now)
        advice = "; coarser elements take less" if self._advises else ""
        self._said, self._next, self._advises = now, 0.25 * (int(4.0 * fraction) + 1), False
        self._say(f"  {part} {100.0 * fraction:.0f} %{words and f', about {words}'}{advice}")


def kept_file(scene: Scene, folder: Path, element_size: float, degree: int = DEGREE) -> Path:
    """The file of ``kept``, named after all inputs of the compliance."""
    return cache.file(folder, "compliance", _key(scene, element_size, degree), ".npz")


def _key(scene: Scene, element_size: float, degree: int) -> str:
    program = sources.of_runs(__name__, libraries=scene.rail.libraries())
    return content_hash(made_from(scene), element_size, degree, program)


def made_from(scene: Scene) -> str:
    """Hexadecimal digest of all inputs of the compliance from ``scene``, including the clearance,
    and of its rail and pads. Scenes with the same digest share a compliance. Raises SceneError if
    the built-in section does not fit the pads."""
    text = scene.model_dump_json(include=_DECIDES)
    return _digest_of(_Asked(text, tuple(scene.rail.contents().items()), scene))


@dataclass(frozen=True)
class _Asked:
    """A scene; equal to others with the same ``text`` (JSON) of the tables ``_DECIDES`` and the same
    ``contents`` of files."""

    text: str
    contents: tuple[tuple[str, str], ...]
    scene: Scene = field(compare=False)


@lru_cache(maxsize=16)  # each call of the surrogate in a loop over scenes asks
def _digest_of(asked: _Asked) -> str:
    scene = asked.scene
    return content_hash(digest(scene), inputs.of_scene(inputs.nominal(scene)).digest())


def direct(scene: Scene, element_size: float) -> np.ndarray:
    """Mean displacement (s,f) m/N of each of f faces under a unit force on it, at s places along the
    rail, in elements of ``element_size`` (m)."""
    from tipoff.highfi import compliance as statics  # slow to load

    faces = scene_model.built(scene).nominal
    way = (scene.rail.end - faces.half_length - faces.centre[:, 0]).max()
    found = statics.along(scene, element_size, np.linspace(0.0, way, _PLACES), patterns=1)
    return np.einsum("sff->sf", found.matrix[:, :, 0, :, 0])
