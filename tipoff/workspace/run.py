"""A request for one run, and its execution."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

from tipoff import sources
from tipoff.files import content_hash
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.rail_compliance import model_of
from tipoff.scenes.scene import Scene
from tipoff.workspace.progress import say

_SAID: set[str] = set()  # warnings about meshes that this process has printed


@dataclass(frozen=True)
class Run:
    """A request for a run."""

    fidelity: str
    label: str  # unique in the study of the scene
    scene: Scene  # of one condition
    numerics: Any
    calibration: Calibration | None = None  # of a surrogate
    compliance: RailCompliance | None = None  # of a surrogate

    @property
    def model(self) -> str:
        """Name of its model."""
        return (
            FINITE_ELEMENTS if self.fidelity == "highfi" else model_of(self.scene, self.compliance)
        )

    @property
    def key(self) -> str:
        """Hexadecimal digest of everything that determines the result."""
        used = self.calibration.applied if self.calibration else None
        libraries = self.scene.rail.libraries() if self.fidelity == "highfi" else ()
        return content_hash(
            self.fidelity,
            self.scene.hash,
            asdict(self.numerics),
            used,
            self.compliance.hash if self.compliance else None,
            sources.of_runs(f"tipoff.{self.fidelity}", libraries=libraries),
        )


def with_modes_of(nominal: Trajectory, run: Run) -> Run:
    """``run`` with the rail modes, and the degree of patterns, that the ``nominal`` run chose. Two
    compared runs must have the same equations; otherwise a change of modes would appear as the effect
    of their difference."""
    chosen = {
        name: nominal.numerics[name]
        for name in ("modes", "degree")
        if f"{name}_why" in nominal.numerics
    }
    return replace(run, numerics=replace(run.numerics, **chosen)) if chosen else run


def execute(
    run: Run,
    progress: Callable[[float], None] | None = None,
    threads: int | None = None,
    **further: Any,
) -> Trajectory:
    """Make a run without a store. ``further`` are arguments of ``highfi.run`` for checkpoints. For
    the reference, ``threads`` is their number, None for the default."""
    if run.fidelity == "highfi":
        from tipoff import highfi

        return highfi.run(
            run.scene, numerics=run.numerics, progress=progress, threads=threads, **further
        )
    from tipoff import lowfi

    return lowfi.run(
        run.scene,
        run.model,
        compliance=run.compliance,
        calibration=run.calibration,
        numerics=run.numerics,
        progress=progress,
    )


def prepare(run: Run) -> None:
    """Do the part of a run that needs the main thread; call it before ``execute`` in another
    thread. Prints each warning about its mesh once."""
    if run.fidelity == "highfi":
        from tipoff import highfi

        for warning in highfi.prepare(run.scene, run.numerics).warnings:
            if warning not in _SAID:
                _SAID.add(warning)
                say(f"  mesh: {warning}")
