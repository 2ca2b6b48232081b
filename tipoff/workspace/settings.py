"""Numerical settings of the studies: element sizes, tolerances, repeats. A scene may state some of
them in ``[studies]``; options of a command replace these.

The reference mesh of 2 mm is the finest for which `make report` takes half an hour on two cores.
Effects of a change of clearance, interface stiffness or step are differences of two runs. These
runs, and the coarser mesh of the refinement check, have twice the element size. Finer meshes are
for the convergence study."""

import os
from dataclasses import asdict, dataclass

from tipoff.files import content_hash
from tipoff.scenes.scene import Scene, load
from tipoff.scenes.studies import ELEMENT_SIZE, element_size

_BESIDE_RESULTS = ("workers", "checkpoint_every", "resume")  # these do not change a result

COARSER = 2.0  # times the element size, if many runs are needed


@dataclass(frozen=True)
class Settings:
    """Settings of all studies."""

    element_size: float = ELEMENT_SIZE  # m, of the reference
    tolerances: tuple[float, ...] = (1e-2, 1e-4, 1e-6, 1e-8)  # of the surrogate in the cost study
    highfi_repeats: int = 3  # of timed runs
    lowfi_repeats: int = 20  # of timed runs
    clearance_change: float = 1e-6  # m, defines the floor
    neighbours: int = 32  # within this change, to judge a chaotic condition
    rail_modes: int = 4  # of the surrogate with vibrating rails
    # of the convergence study, coarsest first:
    mesh_ratios: tuple[float, ...] = (4.0, 2.0, 1.0, 0.5)  # to ``element_size``, one of them 1
    safeties: tuple[float, ...] = (0.9, 0.45, 0.225)  # of the step; other stages use the first
    contact_cells: tuple[int, ...] = (8, 16, 32)
    interface_stiffness_factors: tuple[float, ...] = (0.25, 1.0, 4.0, 16.0)
    workers: int = os.cpu_count() or 1  # parallel runs
    checkpoint_every: float = 60.0  # s, wall clock, of a run of the reference
    resume: bool = True  # continue interrupted runs of the reference

    @property
    def coarse_size(self) -> float:
        """Element size (m) of the runs for differences."""
        return COARSER * self.element_size

    @property
    def mesh_sizes(self) -> tuple[float, ...]:
        """Element sizes (m) of the convergence study, coarsest first."""
        return tuple(ratio * self.element_size for ratio in self.mesh_ratios)

    @property
    def judged_sizes(self) -> tuple[float, ...]:
        """Element sizes (m) by which the reference is judged: those of the convergence study down
        to its own size, which is the last; at least the coarse mesh before it, whose runs other
        stages need anyway."""
        coarser = tuple(ratio for ratio in self.mesh_ratios if ratio > 1.0) or (COARSER,)
        return tuple(ratio * self.element_size for ratio in (*coarser, 1.0))

    @property
    def hash(self) -> str:
        """Digest of the settings that can change a result: all except ``_BESIDE_RESULTS``."""
        return content_hash(
            {name: value for name, value in asdict(self).items() if name not in _BESIDE_RESULTS}
        )


def defaults(scene: Scene | str) -> Settings:
    """Settings of a ``scene``, or of the scene with this name in the catalogue: those of its
    ``[studies]``, else the defaults. The name itself has no effect."""
    found = load(scene) if isinstance(scene, str) else scene
    own = found.studies.model_dump(exclude_none=True, exclude={"errors"}) if found.studies else {}
    return Settings(**{"element_size": element_size(None, found.rail.length)} | own)
