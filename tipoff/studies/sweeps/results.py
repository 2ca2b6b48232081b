"""Result of ``tipoff sensitivity --sweep``."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.studies.populations.population import Answering
from tipoff.studies.render.column import Column
from tipoff.studies.sensitivity.options import SensitivityOptions
from tipoff.studies.sweeps.knee import Growth

Curve = tuple[float | None, ...]  # over the sizes; None if no case settled


@dataclass(frozen=True, kw_only=True)
class Sides:
    """Numbers of the face that touched ``first`` and of the face with the ``most`` impulse, over
    sizes and directions, -1 without contact; median change of the rates between neighbours with
    another face of most impulse, and between other neighbours."""

    angles_deg: tuple[float, ...]
    first: tuple[tuple[int, ...], ...]
    most: tuple[tuple[int, ...], ...]
    jumps_deg_s: tuple[float | None, float | None]


@dataclass(frozen=True, kw_only=True)
class Swept:
    """An error over ``sizes`` in its ``unit`` and directions: ``values`` of ``answers.ALL`` by
    name, the ``largest`` over all directions, the same of a ``free`` payload, and the ``growth`` of
    the largest rates, None if too few cases settled; ``sides``: None without contact, and for a
    stretched thrust."""

    name: str
    label: str
    unit: str
    sizes: tuple[float, ...]
    angles_deg: tuple[float, ...]
    values: dict[str, tuple[Curve, ...]]
    largest: dict[str, Curve]
    free: dict[str, Curve]
    departs_from_free_at: float | None
    growth: dict[str, Growth | None]
    sides: Sides | None = None

    @property
    def title(self) -> str:
        """Label with unit."""
        return f"{self.label} ({self.unit})"


@dataclass(frozen=True, kw_only=True)
class Launch:
    """All sweeps with a thrust ``stretch`` times as long; exit and impulse are None if the payload
    does not leave; ``cases`` by status; ``faces``: names of the faces by the numbers in ``sides``.
    """

    stretch: Annotated[float, Column("thrust, times as long", form="g")]
    cases: dict[str, int]
    not_settled: Annotated[int, Column("did not settle")]
    exit_s: Annotated[float | None, Column("exit", "ms", scale=1e3)]
    share_after_exit: Annotated[float | None, Column("impulse after the exit", "%", ".2g", 100.0)]
    store: str
    factors: tuple[Swept, ...]
    faces: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Sweeps(Answering):
    """``launches``: the scene as given, and with a stretched thrust if this changes the impulse
    after the exit; ``held``: sizes by name of the tolerances of a file of errors that are not swept."""

    asked: SensitivityOptions
    held: dict[str, str]
    launches: tuple[Launch, ...]
