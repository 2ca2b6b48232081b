"""How long a calibration will take, said before it begins.

    time = ceil(runs / at a time) * elements * steps * ns per element and step
           + evaluations * conditions * time of the surrogate

Elements are counted without a mesh where the rail is the built-in section. Steps and nanoseconds
come from runs of the reference that are stored, of this scene, else of one beside it, else from a
benchmark; where nothing was measured typical figures stand in, and the line says so. It may be
wrong by what other programs take, and by the time after the exit that a run leaves out. It may not
cost what it tells: after a second it is given up.
"""

import contextlib
import importlib
import json
import math
import threading
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numba

from tipoff.files import read_json, require_whole
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study

PATIENCE = 1.0  # s
# Numba names its settings while it loads, where no type checker sees them.
_numba_settings: Any = numba.config
# per element and step, the 2 mm mesh of the reference scene on one thread of an AMD EPYC
_TYPICAL_NS = 11.0
_TYPICAL_RUN = 3e-3  # s, the surrogate there
_STEP = 0.7  # dt sqrt(E / rho) / h of meshes of the built-in section
_COMPILED = " and a minute or two to compile, this once"
_LOOKED_AT = 4  # stored runs, newest first


class Pace(NamedTuple):
    """Cost of a reference run: nanoseconds per element and step; its mesh's element size (m),
    elements and steps, None where only the speed is known; and where it was measured, in words."""

    ns: float
    element_size: float | None = None
    elements: int | None = None
    steps: int | None = None
    source: str = ""


def calibration(study: Study, asked: Sequence[Run]) -> str:
    """The line for a calibration on the reference runs ``asked``, found in a second at most."""
    return _line(study, asked, lambda: _search(study, len(asked)), "the search", "about")


def search(study: Study, conditions: int) -> str:
    """The line for a calibration on curves of so many ``conditions``, found in a second at most."""
    importlib.import_module("tipoff.calibration")
    return work("the search", in_time(lambda: _search(study, conditions)))


def _line(
    study: Study, asked: Sequence[Run], rest: Callable[[], float], name: str, bound: str
) -> str:
    for package in ("tipoff.calibration", "tipoff.highfi", "h5py"):
        importlib.import_module(package)  # what is loaded in any case is no delay
    missing = [run for run in asked if not study.store.path(run).is_file()]
    together = min(study.settings.workers, len(missing))
    reference, seconds = in_time(lambda: (_references(missing, together, pace(study)), rest())) or (
        None,
        None,
    )
    return words(len(missing), together, reference, work(name, seconds, bound))


def work(name: str, seconds: float | None, bound: str = "about") -> str:
    """What is done after the runs of the reference, and how long it takes where that is known."""
    return name if seconds is None else f"{name}, {bound} {span(seconds)}"


def words(missing: int, together: int, reference: tuple[float, str] | None, after: str) -> str:
    """The line: runs ``missing``, so many ``together``, seconds of all and where they are from, and
    what comes ``after``."""
    if not missing:
        return f"no reference run to make; {after}"
    head = f"{missing} reference run{'s' if missing > 1 else ''} to make" + (
        f", {together} at a time" if together > 1 else ""
    )
    if reference is None:
        return f"{head}: how long is not known, nothing like them was run; then {after}"
    seconds, source = reference
    return f"{head}: about {span(seconds)}{source}{_COMPILED if _is_cold() else ''}; then {after}"


def span(seconds: float) -> str:
    """A time in words, to about a tenth."""
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
                else Pace(found.ns, source=f" (speed as measured in {path.parent.parent.name})")
            )
    try:
        rows = read_json(study.folder.parent / "bench" / "highfi.json")["rows"]
        nearest = min(
            rows, key=lambda row: abs(math.log(row["element_size_m"] / study.settings.element_size))
        )
        return Pace(float(nearest["ns_one_thread"]), source=" (speed as benchmarked)")
    except (OSError, ValueError, KeyError, TypeError):
        return Pace(_TYPICAL_NS, source=" (typical speed, none measured here yet)")


def in_time(work: Callable):
    """What ``work`` returns, or None where that takes longer than a second or fails: a forecast is
    worth no more."""
    found = []

    def attempt() -> None:
        # whatever it is, the runs themselves will meet it and say it better
        with contextlib.suppress(Exception):
            found.append(work())

    thread = threading.Thread(target=attempt, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return found[0] if found else None


def _references(missing: Sequence[Run], together: int, known: Pace) -> tuple[float, str] | None:
    """Seconds of all ``missing`` runs, so many ``together``, those of one mesh after those of
    another; None as for one of them."""
    found = [_reference(run, known) for run in missing]
    each = Counter(one for one in found if one is not None)
    if not each or None in found:
        return None
    return sum(
        math.ceil(count / together) * seconds for (seconds, _), count in each.items()
    ), known.source


def _reference(run: Run, known: Pace) -> tuple[float, str] | None:
    """Seconds of one run, and where its speed comes from; None for a mesh that cannot be
    counted."""
    size = run.numerics.element_size
    elements = _elements(run.scene, size, known)
    if elements is None:
        return None
    if known.steps is not None and known.element_size is not None:
        steps = known.steps * known.element_size / size
    else:
        material = run.scene.rail.material
        steps = run.scene.duration / (
            _STEP * size * math.sqrt(material.density / material.youngs_modulus)
        )
    return 1e-9 * elements * steps * known.ns, known.source


def _elements(scene: Scene, size: float, known: Pace) -> float | None:
    if isinstance(scene.rail, SectionTable):
        from tipoff.highfi.rail.scene_mesh import geometry
        from tipoff.meshes import l_rail

        section = geometry(scene)
        assert isinstance(section, l_rail.LRailGeometry)
        return l_rail.elements(section, size)
    if known.elements is None or known.element_size is None:
        return None
    return known.elements * (known.element_size / size) ** 3


def _stored(path: Path) -> Pace | None:
    """The cost a stored run kept, without its arrays."""
    import h5py

    try:
        require_whole(path)
        with h5py.File(path) as file:
            cost, numerics = json.loads(file.attrs["cost"]), json.loads(file.attrs["numerics"])
        return Pace(
            cost["ns_per_element_step"], numerics["element_size"], cost["elements"], cost["steps"]
        )
    except (OSError, KeyError, ValueError):
        return None


def _search(study: Study, conditions: int) -> float:
    """Seconds of the search over ``conditions``."""
    from tipoff.calibration import parameters, search

    return (
        search.evaluations(len(parameters.free(study.scene)))
        * conditions
        * _surrogate(study.folder)
    )


def _is_cold() -> bool:
    """Whether kernels have yet to be compiled."""
    return not any(Path(_numba_settings.CACHE_DIR).rglob("*.nbc"))


def _surrogate(folder: Path) -> float:
    """Seconds of one run of the surrogate on springs: the fastest of those stored last, since the
    first ones load kernels."""
    import h5py

    found = []
    springs = [path for path in (folder / "lowfi").glob("*.nc") if "-compliant-" not in path.name]
    for path in sorted(springs, key=_age)[:_LOOKED_AT]:
        try:
            require_whole(path)
            with h5py.File(path) as file:
                found.append(json.loads(file.attrs["cost"])["wall_s"])
        except (OSError, KeyError, ValueError):
            pass
    return min(found, default=_TYPICAL_RUN)


def _age(path: Path) -> float:
    return -path.stat().st_mtime
