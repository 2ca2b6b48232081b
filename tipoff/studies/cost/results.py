"""Result of the cost study: measured points."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.mechanics.model_names import COMPLIANT
from tipoff.studies.render.column import Column

BY_MODES, BY_PATTERNS = f"{COMPLIANT}, modes varied", f"{COMPLIANT}, patterns varied"
_ERROR = Column("error", "deg/s", ".2g")
_WALL = Column("wall time", "s")


@dataclass(frozen=True, kw_only=True)
class Point:
    """A run of one model. ``setting``: element size (m) or relative tolerance; ``modes`` and the
    ``degree`` of patterns: None if they are not varied; errors: None if a run did not settle, and for the
    reference; ``reference``: whether it is the finest mesh and settled; ``pareto``: whether no
    faster point has an error bound as small."""

    model: Annotated[str, Column("model")]
    rung: str
    setting: float
    modes: int | None
    numerics: Annotated[str, Column("numerics")]
    wall_s: Annotated[float, _WALL]
    error_deg_s: Annotated[float | None, _ERROR]  # of the settled rates
    curve_error: Annotated[float | None, Column("rate L2", "%", ".2g", 100.0)]
    integration_error_deg_s: Annotated[float | None, Column("error of time integration", "deg/s")]
    status: str
    reference: bool
    pareto: bool = False
    degree: int | None = None


@dataclass(frozen=True, kw_only=True)
class Match:
    """A surrogate, and the fastest mesh with an error that is not larger."""

    model: Annotated[str, Column("surrogate")]
    numerics: Annotated[str, Column("numerics", detail=True)]
    error_deg_s: Annotated[float, _ERROR]
    wall_s: Annotated[float, Column("wall time", "ms", scale=1e3)]
    mesh: Annotated[str, Column("mesh")]
    mesh_error_deg_s: float | None
    mesh_is_reference: bool
    mesh_wall_s: Annotated[float, Column("wall time", "s", detail=True)]
    ratio: Annotated[float, Column("ratio of wall times", form=",.0f")]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """``band_deg_s``: uncertainty of the finest mesh, None if not known."""

    condition: str
    scene_hash: str
    band_deg_s: float | None
    points: tuple[Point, ...]
    matched: tuple[Match, ...]
    hardware: dict
