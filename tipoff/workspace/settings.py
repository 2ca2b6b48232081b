"""Numerical settings of the studies: element sizes, tolerances, repeats. A scene may state some of them
in ``[studies]``; options of a command replace these.

The reference mesh of 2 mm is the finest with which `make report` takes half an hour on two cores.
Effects of a change of clearance, interface stiffness or step are differences of two runs; these
runs, and the coarser mesh of the refinement check, have twice the element size. Finer meshes belong
to the convergence study."""

import os
from dataclasses import asdict, dataclass

from tipoff.files import content_hash
from tipoff.scenes.scene import Scene, load
from tipoff.scenes.studies import ELEMENT_SIZE

_BESIDE_RESULTS = ("workers", "checkpoint_every", "resume")  # these do not change a result

COARSER = 2.0  # times the element size, where many runs are needed


@dataclass(frozen=True)
class Settings:
    """``element_size`` (m) of the reference; ``tolerances`` of the surrogate in the cost study;
    repeats of timed runs; ``clearance_change`` (m) that defines the floor, and the number of
    ``neighbours`` within it that judge a chaotic condition; ``rail_modes`` of the
    surrogate whose rails vibrate; ``workers`` side by side; ``checkpoint_every`` seconds (wall
    clock) of a run of the reference, and whether one that was interrupted may ``resume``;
    ``step_everything``: also rails of the reference that rest. What the
    convergence study compares, coarsest first: meshes by ``mesh_ratios`` to ``element_size``, one
    of them 1; ``safeties`` of the step, from that of every other stage down; ``contact_cells``; and
    factors of the scene's interface stiffness."""

    element_size: float = ELEMENT_SIZE
    tolerances: tuple[float, ...] = (1e-2, 1e-4, 1e-6, 1e-8)
    highfi_repeats: int = 3
    lowfi_repeats: int = 20
    clearance_change: float = 1e-6
    neighbours: int = 32
    rail_modes: int = 4
    mesh_ratios: tuple[float, ...] = (4.0, 2.0, 1.0, 0.5)
    safeties: tuple[float, ...] = (0.9, 0.45, 0.225)
    contact_cells: tuple[int, ...] = (8, 16, 32)
    interface_stiffness_factors: tuple[float, ...] = (0.25, 1.0, 4.0, 16.0)
    step_everything: bool = False
    workers: int = os.cpu_count() or 1
    checkpoint_every: float = 60.0
    resume: bool = True

    @property
    def coarse_size(self) -> float:
        """Element size (m) of the runs whose differences are measured."""
        return COARSER * self.element_size

    @property
    def mesh_sizes(self) -> tuple[float, ...]:
        """Element sizes (m) of the convergence study, coarsest first."""
        return tuple(ratio * self.element_size for ratio in self.mesh_ratios)

    @property
    def judged_sizes(self) -> tuple[float, ...]:
        """Element sizes (m) from which the reference is judged: those of the convergence study that
        are no smaller than its own, which is the last."""
        return tuple(ratio * self.element_size for ratio in self.mesh_ratios if ratio >= 1.0)

    @property
    def hash(self) -> str:
        """Digest of the settings that can change a result: all but ``_BESIDE_RESULTS``."""
        return content_hash(
            {name: value for name, value in asdict(self).items() if name not in _BESIDE_RESULTS}
        )


def defaults(scene: Scene | str) -> Settings:
    """Settings of a ``scene``, or of the one of this name in the catalogue: those that its ``[studies]``
    states, else the defaults. Its name does not count."""
    stated = (load(scene) if isinstance(scene, str) else scene).studies
    return Settings(**(stated.model_dump(exclude_none=True, exclude={"errors"}) if stated else {}))
