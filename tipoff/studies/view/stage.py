"""Stage ``view``: one condition of the reference as VTK files for ParaView and, with pyvista, as
pictures.

The run is repeated with an observer that writes each frame at once, so that only one frame is in
memory. Its result must equal the stored run to the bit, which is checked.
"""

import importlib.metadata
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tipoff.results.trajectory import Trajectory
from tipoff.scenes.names import NOMINAL
from tipoff.studies.view.options import ViewOptions
from tipoff.workspace.progress import Board, say
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, require_success
from tipoff.workspace.words import counted

if TYPE_CHECKING:
    from tipoff.studies.view.frames import Camera

_SHOWN = 8e-3  # m, size of the largest deformation in a picture
_HOW = "pictures need pyvista (0.6 GB): pip install pyvista; in a clone, make pictures"


Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Instant:
    """A frame: its files, and largest values."""

    time_s: float
    rails: str
    bodies: str
    largest_stress_pa: float
    largest_mean_stress_pa: float  # largest mean over the elements that meet at a node
    largest_displacement_m: float
    largest_pressure_pa: float


@dataclass(frozen=True, kw_only=True)
class Peak:
    """The peak stress of the run, and the number of the frame nearest to it."""

    stress_pa: float
    place_m: Vector
    rail: str
    time_s: float
    frame: int


@dataclass(frozen=True, kw_only=True)
class View:
    """Frames of a ``condition`` in a ``folder``; ``collection``: the list for ParaView; ``factor``: the
    exaggeration; ``pictures`` by name, or why there are none."""

    scene: str
    condition: str
    folder: str
    collection: str
    frames: tuple[Instant, ...]
    peak: Peak
    bounds_m: tuple[Vector, Vector]
    element_size_m: float
    factor: float  # of the deformation in pictures
    title: str
    pictures: dict[str, str]
    without_pictures: str


def run(study: Study, options: ViewOptions = ViewOptions()) -> Made[View]:
    """Files of stress and motion. Raises SceneError for an unknown condition or fewer than two frames,
    StudyError where the run fails."""
    name = options.condition or (study.scene.agreement.refined or tuple(study.conditions))[0]
    options = replace(options, condition=name)
    request = study.highfi(name)

    def make() -> tuple[View, list[Path]]:
        original = study.store.get(request)
        require_success({name: original}, "show the run")
        folder = study.folder / "view" / name
        taken = _take(study, request, original, folder, options.frames)
        found, files = _view(study, request, original, folder, taken)
        drawn, why = draw_pictures(found, folder)
        if why:
            say(f"view: {why}")
        pictures = {Path(picture).stem: study.relative(folder / picture) for picture in drawn}
        found = replace(found, pictures=pictures, without_pictures=why)
        return found, [*files, *(folder / picture for picture in drawn)]

    return stage_of(name).run(study, options, make)


def stage_of(condition: str) -> Stage:
    """The stage of a condition."""

    def inputs(study: Study, _: ViewOptions) -> list:
        return [study.highfi(condition).key, pyvista_version()]

    return Stage(f"view/{condition}", __name__, options=ViewOptions, inputs=inputs, result=View)


def stored(study: Study) -> list[View]:
    """The stored results of the present scene, code and settings."""
    again = "the report does without it until tipoff view makes it again"
    found = [stage_of(name).stored(study) for name in sorted([*study.scene.conditions, NOMINAL])]
    return [item.result for item in found if item and study.whole(item.document, again)]


def pyvista_version() -> str | None:
    """The installed version of pyvista, or None."""
    try:
        return importlib.metadata.version("pyvista")
    except importlib.metadata.PackageNotFoundError:
        return None


def chosen(frames: int, original: Trajectory) -> list[int]:
    """Samples of the frames: evenly spread over the run; the one nearest to the peak stress is
    moved there."""
    assert original.stress is not None  # every successful run of the reference has it
    last = original.time.size - 1
    samples = sorted({round(place) for place in np.linspace(0, last, min(frames, last + 1))})
    peak = int(np.abs(original.time - original.stress["peak_stress_time_s"]).argmin())
    inner = samples[1:-1] or samples
    nearest = min(inner, key=lambda sample: abs(sample - peak))
    return sorted({peak if sample == nearest else sample for sample in samples})


class _Observer:
    """Observer that writes the chosen samples of a run."""

    def __init__(self, folder: Path, samples: list[int]):
        self.folder, self.samples = folder, set(samples)
        self.shared: tuple[Camera, np.ndarray, np.ndarray] | None = None
        self.frames: list[Instant] = []
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)

    def __call__(self, loop) -> None:
        from tipoff.studies.view import frames as views
        from tipoff.studies.view import vtk_files

        if len(loop.recorded.rows) - 1 not in self.samples:
            return
        if self.shared is None:
            self.shared = (
                views.Camera(loop),
                *views.bodies(loop.setup.scene, loop.setup.system.model),
            )
        camera, boxes, pads = self.shared
        frame, mesh = camera.take(loop), loop.setup.system.mesh
        paths = vtk_files.write_frame(self.folder, len(self.frames), frame, mesh, boxes, pads)
        self._widen(mesh.points)
        self._widen((boxes @ frame.turn.T + frame.centre).reshape(-1, 3))
        self.frames.append(
            Instant(
                time_s=frame.time,
                rails=paths[0].name,
                bodies=paths[1].name,
                largest_stress_pa=float(frame.worst.max()),
                largest_mean_stress_pa=float(frame.von_mises.max()),
                largest_displacement_m=float(np.linalg.norm(frame.displacement, axis=1).max()),
                largest_pressure_pa=float(frame.pressure.max()),
            )
        )

    def _widen(self, points: np.ndarray) -> None:
        self.low, self.high = (
            np.minimum(self.low, points.min(axis=0)),
            np.maximum(self.high, points.max(axis=0)),
        )


def _take(study: Study, request: Run, original: Trajectory, folder: Path, frames: int) -> _Observer:
    from tipoff import highfi

    observer = _Observer(folder, chosen(frames, original))
    highfi.prepare(request.scene, request.numerics)
    with Board("view", 1) as board:
        again = highfi.run(
            request.scene,
            request.numerics,
            progress=board.callback(request.label),
            observer=observer,
        )
        board.finished(
            request.label,
            f"{counted(len(observer.frames), 'frame')} in {again.cost['wall_s']:.3g} s",
        )
    if not (np.array_equal(again.rate, original.rate) and again.stress == original.stress):
        say(
            "view: the run shown differs from the stored run in its last bits, as on another "
            "kind of processor"
        )
    return observer


def _view(
    study: Study,
    request: Run,
    original: Trajectory,
    folder: Path,
    taken: _Observer,
) -> tuple[View, list[Path]]:
    """The result without pictures, and its files."""
    from tipoff.studies.view import vtk_files

    paths = [[folder / frame.rails, folder / frame.bodies] for frame in taken.frames]
    files = [path for pair in paths for path in pair]
    files.append(vtk_files.write_collection(folder, [each.time_s for each in taken.frames], paths))
    vtk_files.discard_others(folder, files)
    stress = original.stress
    assert stress is not None  # the frames depend on it
    apart = [abs(frame.time_s - stress["peak_stress_time_s"]) for frame in taken.frames]
    peak = Peak(
        stress_pa=stress["peak_stress_pa"],
        place_m=tuple(stress["peak_stress_place_m"]),
        rail=stress["peak_stress_rail"],
        time_s=stress["peak_stress_time_s"],
        frame=int(np.argmin(apart)),
    )
    found = View(
        scene=study.scene.name,
        condition=request.label,
        folder=study.relative(folder),
        collection=study.relative(files[-1]),
        frames=tuple(taken.frames),
        peak=peak,
        bounds_m=(tuple(taken.low.tolist()), tuple(taken.high.tolist())),
        element_size_m=request.numerics.element_size,
        factor=exaggeration(taken.frames),
        title=f"{study.scene.name} / {request.label}",
        pictures={},
        without_pictures="",
    )
    return found, files


def exaggeration(frames: Sequence[Instant]) -> float:
    """Factor, 1, 2 or 5 times a power of ten, that shows the largest deformation with about the
    size ``_SHOWN``; 1 without deformation."""
    largest = max(frame.largest_displacement_m for frame in frames)
    if largest <= 0.0:
        return 1.0
    ratio = max(1.0, _SHOWN / largest)
    power = 10.0 ** math.floor(math.log10(ratio))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= ratio)


def rounded_up(value: float) -> float:
    """The end of a scale of five parts: the next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of
    ten; 1 for zero."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0.0 else 1.0
    steps = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return next(step * power for step in steps if value <= step * power * (1.0 + 1e-9))


def draw_pictures(found: View, folder: Path) -> tuple[list[str], str]:
    """Names of the pictures, or the reason if there are none."""
    if pyvista_version() is None:
        return [], _HOW
    order = {
        "folder": str(folder.resolve()),
        "frames": [asdict(frame) for frame in found.frames],
        "factor": found.factor,
        "bounds": found.bounds_m,
        "peak": asdict(found.peak),
        "title": found.title,
        "mesh": f"elements of {1e3 * found.element_size_m:g} mm",
        "scale_pa": rounded_up(max(frame.largest_mean_stress_pa for frame in found.frames)),
    }
    # Messages go to a file: a full pipe without a reader would stop the child.
    with Board("view", 1) as board, tempfile.TemporaryFile("w+") as complaints:
        report = board.callback("pictures")
        report(0.0)
        child = subprocess.Popen(
            [sys.executable, "-m", "tipoff.studies.view.pictures"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=complaints,
            text=True,
            cwd=Path(__file__).resolve().parents[3],
        )
        assert child.stdin is not None and child.stdout is not None  # both are pipes
        child.stdin.write(json.dumps(order))
        child.stdin.close()
        said = {}
        for line in child.stdout:
            if line.startswith("{"):
                said = json.loads(line)
                report(said.get("done", 1.0))
        child.wait()
        complaints.seek(0)
        complaint = complaints.read().strip().splitlines()
        if child.returncode or "pictures" not in said:
            why = complaint[-1] if complaint else f"exit code {child.returncode}"
            return [], f"no pictures: pyvista failed ({why})"
        board.finished("pictures", ", ".join(said["pictures"]))
    return said["pictures"], ""
