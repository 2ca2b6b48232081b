"""Estimate of the duration of a calibration, printed before it begins.

    time = ceil(runs / at a time) * elements * steps * ns per element and step
           + evaluations * conditions * time of the surrogate

A step also has a part that does not grow with its elements: what a stored run took beyond ``_ELEMENT_NS`` for each.
The elements of a built-in section are counted without a mesh. Steps and nanoseconds come from stored runs
of the reference: of this scene, else of another scene in the same folder, else from a benchmark, else
from typical values. The line states the source. The estimate neglects the load of other programs, and
that a run ends soon after the exit. It is abandoned after one second.
"""

import contextlib
import importlib
import json
import math
import threading
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from tipoff import sources
from tipoff.files import read_json, require_whole
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes.scene import Scene
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study
from tipoff.workspace.words import counted

PATIENCE = 1.0  # s
# per element and step, the 2 mm mesh of the reference scene on one thread of an AMD EPYC
_TYPICAL_NS = 11.0
_TYPICAL_RUNS = {SPRINGS: 3e-3, COMPLIANT: 6e-3}  # s, a run of the surrogate on the same processor
_ELEMENT_NS = 5.0  # of an element alone, on the same processor
_STEP = 0.7  # dt sqrt(E / rho) / h of meshes of the built-in section
_COMPILED = " and half a minute to compile, this once"
_LARGEST = 1e18  # largest plausible number in a file; a larger one is damage
_LOOKED_AT = 4  # stored runs, newest first


class Pace(NamedTuple):
    """Cost of a reference run: nanoseconds per element and step; element size (m), elements and
    steps of its mesh, None where only the speed is known; and the source, as text."""

    ns: float
    element_size: float | None = None
    elements: int | None = None
    steps: int | None = None
    source: str = ""


def calibration(
    study: Study,
    requested: Sequence[Run],
    model: str = SPRINGS,
    fit: Sequence[str] | None = None,
) -> str:
    """The line for a calibration of a ``model`` on the reference runs ``requested``, found in a second
    at most."""
    count = len(requested)
    return _line(study, requested, lambda: _search(study, count, model, fit), "the search", "about")


def search(
    study: Study, conditions: int, model: str = SPRINGS, fit: Sequence[str] | None = None
) -> str:
    """The line for a calibration of a ``model`` on curves of so many ``conditions``, with the
    parameters ``fit``; found in a second at most."""
    importlib.import_module("tipoff.calibration")
    return work("the search", in_time(lambda: _search(study, conditions, model, fit)))


def _line(
    study: Study, requested: Sequence[Run], rest: Callable[[], float], name: str, bound: str
) -> str:
    for package in ("tipoff.calibration", "tipoff.highfi", "h5py"):
        importlib.import_module(package)  # needed in any case, so not counted in the second
    missing = [run for run in requested if not study.store.path(run).is_file()]
    together = min(study.settings.workers, len(missing))
    reference, seconds = in_time(lambda: (_references(missing, together, pace(study)), rest())) or (
        None,
        None,
    )
    return words(len(missing), together, reference, work(name, seconds, bound))


def work(name: str, seconds: float | None, bound: str = "about") -> str:
    """The work after the runs of the reference, with its duration (s) where that is speed."""
    return name if seconds is None else f"{name}, {bound} {span(seconds)}"


def words(missing: int, together: int, reference: tuple[float, str] | None, after: str) -> str:
    """The line: number of ``missing`` runs, number of runs ``together``, seconds of all with their
    source, and the work ``after`` them."""
    if not missing:
        return f"no reference run to make; {after}"
    head = f"{counted(missing, 'reference run')} to make" + (
        f", {together} at a time" if together > 1 else ""
    )
    if reference is None:
        return f"{head}: duration unknown, no similar run is stored; then {after}"
    seconds, source = reference
    return f"{head}: about {span(seconds)}{source}{_COMPILED if _is_cold() else ''}; then {after}"


def span(seconds: float) -> str:
    """A time (s) as text, rounded to about a tenth."""
    if seconds < 60.0:
        return f"{max(1, round(seconds)) if seconds < 10.0 else 5 * round(seconds / 5.0)} s"
    if seconds < 600.0:
        tens = round(seconds / 10.0)
        return f"{tens // 6} min" + (f" {10 * (tens % 6)} s" if tens % 6 else "")
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 90 else f"{minutes / 60.0:.1f} h"


def pace(study: Study) -> Pace:
    """The nearest measured cost of a reference run."""
    own = sorted((study.folder / "highfi").glob("*.nc"), key=_age)
    others = sorted(study.folder.parent.glob("*/highfi/*.nc"), key=_age)
    for path in [*own[:_LOOKED_AT], *others[:_LOOKED_AT]]:
        if found := _stored(path):
            same = path.parent.parent == study.folder
            return (
                found
                if same
                else Pace(found.ns, source=f" (speed from runs of {path.parent.parent.name})")
            )
    try:
        rows = read_json(study.folder.parent / "bench" / "highfi.json")["rows"]
        nearest = min(
            rows, key=lambda row: abs(math.log(row["element_size_m"] / study.settings.element_size))
        )
        if 0.0 < (speed := float(nearest["ns_one_thread"])) < _LARGEST:
            return Pace(speed, source=" (speed from the benchmark)")
    except (OSError, ValueError, KeyError, TypeError, OverflowError):
        pass
    return Pace(_TYPICAL_NS, source=" (typical speed, not measured on this machine)")


def in_time(work: Callable):
    """The result of ``work``, or None if it takes longer than a second or fails."""
    found = []

    def attempt() -> None:
        # the runs report the same fault with a better message
        with contextlib.suppress(Exception):
            found.append(work())

    thread = threading.Thread(target=attempt, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return found[0] if found else None


def _references(missing: Sequence[Run], together: int, speed: Pace) -> tuple[float, str] | None:
    """Seconds of all ``missing`` runs, ``together`` at a time and mesh by mesh, with the source;
    None if the duration of a run is unknown."""
    found = [reference_seconds(run, speed) for run in missing]
    each = Counter(one for one in found if one is not None)
    if not each or None in found:
        return None
    return sum(
        math.ceil(count / together) * seconds for (seconds, _), count in each.items()
    ), speed.source


def reference_seconds(run: Run, speed: Pace) -> tuple[float, str] | None:
    """Seconds of one run, and the source of its speed; None if the number of elements is unknown."""
    size = run.numerics.element_size
    elements = _elements(run.scene, size, speed)
    if elements is None:
        return None
    if speed.steps is not None and speed.element_size is not None:
        steps = speed.steps * speed.element_size / size
    else:
        material = run.scene.rail.material
        steps = run.scene.expected_end / (
            _STEP * size * math.sqrt(material.density / material.youngs_modulus)
        )
    element = speed.ns if speed.elements is None else min(speed.ns, _ELEMENT_NS)
    fixed = (speed.ns - element) * (speed.elements or 0)
    return 1e-9 * steps * (fixed + element * elements), speed.source


def _elements(scene: Scene, size: float, speed: Pace) -> float | None:
    if scene.rail.IS_STRAIGHT:
        from tipoff.highfi.rail.geometry import elements  # slow to load

        return elements(scene, size)
    if speed.elements is None or speed.element_size is None:
        return None
    return speed.elements * (speed.element_size / size) ** 3


def _stored(path: Path) -> Pace | None:
    names = ("ns_per_element_step", "elements", "steps")
    if numbers := _numbers(
        path, [("numerics", "element_size"), *(("cost", name) for name in names)]
    ):
        size, ns, elements, steps = numbers
        return Pace(ns, size, int(elements), int(steps))
    return None


def _numbers(path: Path, names: Sequence[tuple[str, str]]) -> list[float] | None:
    """Numbers in tables of the file of a stored run; None if one is missing or implausible. Does
    not read arrays."""
    import h5py

    try:
        require_whole(path)
        with h5py.File(path) as file:
            found = [float(json.loads(file.attrs[table])[name]) for table, name in names]
    except Exception:  # the exception of HDF5 depends on the damage of the file
        return None
    return found if all(0.0 < number < _LARGEST for number in found) else None


def _search(
    study: Study, conditions: int, model: str = SPRINGS, fit: Sequence[str] | None = None
) -> float:
    """Seconds of the search over ``conditions``."""
    from tipoff.calibration import choice, parameters, refine, search

    if model == SPRINGS:
        evaluations = search.evaluations(len(parameters.free(study.scene)))
    else:
        count = choice.most(study.scene, fit)
        evaluations = search.evaluations(count) + refine.evaluations(count)
    return evaluations * conditions * _surrogate(study.folder, model)


def _is_cold() -> bool:
    """Whether no kernel is compiled yet."""
    return not any((sources.cache_folder() / "kernels").rglob("*.nbc"))


def _surrogate(folder: Path, model: str) -> float:
    """Seconds of one run of a ``model``: the fastest of the newest stored runs, because first runs
    also load kernels."""
    own = [
        path
        for path in (folder / "lowfi").glob("*.nc")
        if ("-compliant-" in path.name) == (model == COMPLIANT)
    ]
    newest = sorted(own, key=_age)[:_LOOKED_AT]
    found = [seconds for path in newest if (seconds := _numbers(path, [("cost", "wall_s")]))]
    return min(found, default=[_TYPICAL_RUNS[model]])[0]


def _age(path: Path) -> float:
    return -path.stat().st_mtime
