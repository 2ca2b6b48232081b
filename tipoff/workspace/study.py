"""One scene under study: its conditions, folder, stored runs, and stages that are skipped if
nothing changed.

A stage writes ``out/<scene>/<stage>.json`` with the ``key`` of everything on which it depends, the
digests of the ``files`` that it wrote, the warnings of the scene as ``implausible``, the ``state`` of
tipoff that made it, and what it ``took``: wall time (s) and runs. It is made again if the key differs,
if one of its files is missing or changed, or if the result does not match its digest. Readers verify
all files, so a stage never uses a damaged one.
"""

import hashlib
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from tipoff import cache, sources
from tipoff.faults import Fault, SceneError
from tipoff.files import content_hash, read_json
from tipoff.mechanics.rail_compliance import DEGREE, RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import implausible
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.names import NOMINAL
from tipoff.scenes.scene import Scene
from tipoff.workspace import machine, words
from tipoff.workspace.errors import FAILED as FAILED
from tipoff.workspace.errors import NotAsked as NotAsked
from tipoff.workspace.errors import StudyError as StudyError
from tipoff.workspace.kernel_process import compiled_beside
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.settings import Settings
from tipoff.workspace.store import Store

_T = TypeVar("_T")
_RESULTS: cache.Cache[dict] = cache.documents(dict, dict)


@dataclass(frozen=True)
class Study:
    """A scene and its results."""

    scene: Scene
    folder: Path  # out/<scene>
    settings: Settings
    only: tuple[str, ...] = ()  # restricts the conditions that highfi and lowfi run
    # stages that were announced
    _announced: set = field(default_factory=set, repr=False, compare=False)

    def unrestricted(self) -> "Study":
        """The same study with all its conditions."""
        return replace(self, only=()) if self.only else self

    @cached_property
    def store(self) -> Store:
        """Trajectories of this scene."""
        return Store(
            self.folder, self.settings.workers, self.settings.checkpoint_every, self.settings.resume
        )

    @cached_property
    def conditions(self) -> dict[str, Scene]:
        """Scene of every condition by name: fitted and held out, else all named ones, else the
        scene itself."""
        roles = self.scene.agreement
        names = (
            self.only
            or tuple(dict.fromkeys([*roles.fitted, *roles.held_out]))
            or tuple(self.scene.conditions)
        )
        return {name: self.condition(name) for name in names} or {NOMINAL: self.scene}

    def condition(self, name: str) -> Scene:
        """The scene of one condition. Raises SceneError for an unknown name."""
        return self.scene.condition(name)

    def fitted(self) -> list[str]:
        """Names of the fitted conditions. Raises NotAsked if there are none."""
        if not self.scene.agreement.fitted:
            known = ", ".join(self.scene.conditions) or "none yet: state [conditions.NAME]"
            expected = (
                'at least one condition on which springs are calibrated, as in [agreement] fitted = ["NAME"]; '
                f"conditions of this scene: {known}"
            )
            raise NotAsked([Fault(self.scene.name, "agreement.fitted", "nothing", expected)])
        return list(self.scene.agreement.fitted)

    def highfi(
        self,
        name: str,
        overrides: dict | None = None,
        tag: str = "",
        element_size: float | None = None,
        **numerics: Any,
    ) -> Run:
        """A finite-element run of condition ``name`` with ``overrides``; ``tag`` distinguishes its
        label. ``element_size`` is in m."""
        from tipoff import highfi

        numbers = _numerics(
            highfi.Numerics,
            element_size=element_size or self.settings.element_size,
            **numerics,
        )
        return Run("highfi", name + tag, self.condition(name).replace(overrides or {}), numbers)

    def coarse(
        self, name: str, overrides: dict | None = None, tag: str = "", **numerics: Any
    ) -> Run:
        """``highfi`` on the coarse mesh, for differences of runs."""
        return self.highfi(name, overrides, f"{tag}-coarse", self.settings.coarse_size, **numerics)

    def lowfi(
        self,
        name: str,
        calibration: Calibration | None = None,
        overrides: dict | None = None,
        tag: str = "",
        compliance: RailCompliance | None = None,
        **numerics: Any,
    ) -> Run:
        """A surrogate run of condition ``name``: compliant if its rail ``compliance`` is given,
        else on springs, with the scene's constants unless calibrated."""
        from tipoff import lowfi

        label = (
            f"{name}{tag}{'-calibrated' if calibration else ''}{'-compliant' if compliance else ''}"
        )
        numbers = _numerics(lowfi.Numerics, **numerics)
        scene = self.condition(name).replace(overrides or {})
        return Run(
            fidelity="lowfi",
            label=label,
            scene=scene,
            numerics=numbers,
            calibration=calibration,
            compliance=compliance or self.rigid_rails(scene),
        )

    def rail_compliance(
        self,
        scene: Scene,
        element_size: float | None = None,
        degree: int = DEGREE,
        run_degree: int | None = None,
    ) -> RailCompliance | None:
        """Rail compliance under the pads of ``scene``, on elements of ``element_size`` (m; None:
        those of the reference), for patterns of this ``degree``. It is computed once for a rail
        with its pads and clearance, and stored in this folder. The kernels of runs on it, for
        patterns of ``run_degree`` if they have fewer, are compiled at the same time
        (``workspace.kernel_process``). None without contact."""
        if scene.contact is None:
            return None
        from tipoff.calibration import rail_compliance  # slow to load

        size = element_size or self.settings.element_size
        if rail_compliance.kept_file(scene, self.folder, size, degree).exists():
            return rail_compliance.kept(scene, self.folder, size, say, degree)
        with compiled_beside(scene, self.settings.workers, run_degree or degree):
            return rail_compliance.kept(scene, self.folder, size, say, degree)

    def rail_compliances(
        self, names: Iterable[str], element_size: float | None = None
    ) -> dict[str, RailCompliance | None]:
        """``rail_compliance`` of each condition by name."""
        return self.compliances_of({name: self.condition(name) for name in names}, element_size)

    def compliances_of(
        self, scenes: Mapping[str, Scene], element_size: float | None = None
    ) -> dict[str, RailCompliance | None]:
        """``rail_compliance`` of each of ``scenes``; scenes with the same inputs share it."""
        from tipoff.calibration.rail_compliance import made_from  # slow to load

        found: dict[str, RailCompliance | None] = {"": None}
        keys = {name: made_from(scene) if scene.contact else "" for name, scene in scenes.items()}
        for name, key in keys.items():
            if key not in found:
                found[key] = self.rail_compliance(scenes[name], element_size)
        return {name: found[key] for name, key in keys.items()}

    def rigid_rails(self, scene: Scene) -> RailCompliance | None:
        """The rails of springs in ``scene``: rigid, with their offset if they are warm or from a file,
        else None."""
        straight = scene.rail.IS_STRAIGHT and scene.thermal is None
        if scene.contact is None or straight:
            return None
        from tipoff.calibration import rail_compliance  # slow to load

        size = self.settings.element_size
        if scene.thermal is None:
            return rail_compliance.walls(scene, size)
        return rail_compliance.kept(scene, self.folder, size, say).rigid()

    def path(self, name: str) -> Path:
        """A file in the folder of this scene."""
        return self.folder / name

    def relative(self, path: Path) -> str:
        """A path relative to the folder of this scene, as in result files."""
        return path.relative_to(self.folder).as_posix()

    def key(self, module: str, *inputs: Any) -> str:
        """Digest of the scene with its conditions and roles, settings, the code and libraries on
        which the stage's ``module`` depends, and further inputs."""
        described = self.scene.model_dump(
            mode="json", include={"name", "conditions", "agreement", "provenance"}
        )
        return content_hash(
            self.scene.hash,
            described,
            self.settings.hash,
            list(self.only),
            sources.program(module, libraries=self.scene.rail.libraries()),
            inputs,
        )

    def stage(self, name: str, key: str, make: Callable[[], tuple[dict, list[Path]]]) -> dict:
        """The result of a stage: the stored one if its key is the same and its files are intact,
        else a new one, which is written.

        ``make`` returns the result and the files it wrote.
        """
        path, again = self.path(f"{name}.json"), f"{name} is made again"
        found = _RESULTS.get(path, key, again)
        if found is not None and self.whole(found, again):
            self._announce(name, "nothing changed")
            return found
        self._announce(name, self.scene.name)
        began, runs = time.perf_counter(), self.store.made
        result, files = make()
        took = {"wall_s": time.perf_counter() - began, "runs": self.store.made - runs}
        return _RESULTS.put(
            path,
            key,
            {
                "stage": name,
                "scene": self.scene.name,
                "key": key,
                "quantities": words.QUANTITIES,
                "implausible": implausible.of_all_conditions(self.scene),
                "state": machine.state(),
                "took": took,
                **result,
                "files": {self.relative(file): _digest(file) for file in files},
            },
        )

    def stored(self, name: str, key: Callable[[dict], str]) -> dict | None:
        """The stored result of a stage if it has the ``key`` of a new result with its options. None
        otherwise, also if the options are not valid now or one of its files is missing."""
        found = read(self.path(f"{name}.json"))
        try:
            return found if found and found["key"] == key(found) else None
        except (SceneError, OSError, KeyError, TypeError, ValueError, AttributeError):
            return None

    def _announce(self, name: str, text: str) -> None:
        if name not in self._announced:
            say(f"{name}: {text}")
        self._announced.add(name)

    def whole(self, document: dict, remedy: str) -> bool:
        """Whether every file of a result exists unchanged; prints the name of the first changed
        file with the ``remedy``."""
        listed = document.get("files", {})
        if not isinstance(listed, dict):
            return False
        for name, expected in listed.items():
            path = self.path(name)
            try:
                if not path.is_file():
                    return False
            except ValueError:  # an impossible file name
                return False
            if _digest(path) != expected:
                say(f"  {path} has changed since it was written: {remedy}")
                return False
        return True


def read(path: Path, remedy: str = "repeat the command that wrote it") -> dict | None:
    """The content of a result file with any key; None if it is missing or does not match its
    digest. Prints the latter with the ``remedy``."""
    return cache.whole(path, remedy, lambda: read_json(path))


def picked(path: Path, pick: Callable[[dict], _T]) -> _T | None:
    """The value that ``pick`` takes from a result file with any key, for example of another version
    of the program; None if the file is missing, damaged, or lacks it. Prints the latter two."""
    found = read(path)
    if found is None:
        return None
    try:
        return pick(found)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
        say(f"  {path} was written by another version of the program: repeat the command")
        return None


def require_success(runs: dict[str, Trajectory], purpose: str) -> None:
    """Raise StudyError naming every run that failed."""
    failed = [
        f"{name}: {run.status}{': ' + run.message if run.message else ''}"
        for name, run in runs.items()
        if run.status in FAILED
    ]
    if failed:
        raise StudyError(f"cannot {purpose}, because these runs failed:\n  " + "\n  ".join(failed))


def _numerics(kind: type, **values: Any) -> Any:
    """The numerics of a fidelity. Raises SceneError with a fault for each bad value."""
    try:
        return kind(**values)
    except ValueError as error:
        raise SceneError(numerics_faults(error)) from None


def numerics_faults(error: ValueError) -> list[Fault]:
    """The faults in the text of an ``error`` of numerics, which has for each ``name: given value, expected
    ...``, as faults of options."""
    found = []
    for text in str(error).split("; "):
        name, _, rest = text.partition(": given ")
        given, _, expected = rest.partition(", expected ")
        option = "tolerance" if name == "relative_tolerance" else name.replace("_", "-")
        found.append(Fault(f"--{option}", "value", given, expected))
    return found


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
