"""Result of the cost study: measured points, and how the time of a run grows."""

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
    numerics: Annotated[str, Column("numerics")]
    error_deg_s: Annotated[float, _ERROR]
    wall_s: Annotated[float, Column("wall time", "ms", scale=1e3)]
    mesh: Annotated[str, Column("mesh")]
    mesh_error_deg_s: float | None
    mesh_is_reference: bool
    mesh_wall_s: Annotated[float, _WALL]
    ratio: Annotated[float, Column("ratio of wall times", form=",.0f")]


@dataclass(frozen=True)
class PowerLaw:
    """t = c n^p: ``exponent`` p, None for a single size, and its standard error, None for two points."""

    exponent: float | None  # p of t = c n^p
    standard_error: float | None


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Time of a run with ``n`` elements or pads: medians over ``repeats``."""

    n: Annotated[int, Column("elements")]
    steps: Annotated[float, Column("steps", form=",.0f")]
    repeats: Annotated[int, Column("runs")]
    time_s: Annotated[float, Column("time of a run", "s")]  # of one processor
    wall_s: float
    step_s: Annotated[float, Column("time of a step", "µs", scale=1e6)]
    element_size_m: Annotated[float | None, Column("element size", "mm", "g", 1e3)] = None
    status: str | None = None


@dataclass(frozen=True, kw_only=True)
class Growth:
    """Timings of a model over sizes, with the power law of a ``run`` and that of a ``step``."""

    model: str
    points: tuple[Timing, ...]
    run: PowerLaw
    step: PowerLaw


@dataclass(frozen=True)
class Laws:
    """Power laws of the two finest meshes."""

    run: PowerLaw
    step: PowerLaw


@dataclass(frozen=True, kw_only=True)
class MeshGrowth(Growth):
    """The growth over meshes, and between the two finest; time of a step on any mesh (``fixed_s``) and
    its increase by each element (``element_s``), None for a single mesh."""

    finest: Laws
    fixed_s: float | None
    element_s: float | None


@dataclass(frozen=True)
class Rung:
    """Time with a set of effects; ``on``: their number; ``added``: the effects that the set before
    lacks."""

    added: str
    on: int
    time_s: float


@dataclass(frozen=True)
class EffectTime:
    """Time of an effect: time with all effects minus time without this one; ``of_none``: relative
    to the time without any effect."""

    effect: str
    time_s: float
    of_none: float  # relative to the time without any effect


@dataclass(frozen=True, kw_only=True)
class EffectTimes:
    """Times of a model without effects, with all, and their ``ratio``; ``asked``: number and time
    (s) of the effects of the scene itself."""

    model: str
    none_s: float
    all_s: float
    ratio: float
    ladder: tuple[Rung, ...]
    asked: tuple[int, float]  # number of effects of the scene, and time (s)
    effects: tuple[EffectTime, ...]


@dataclass(frozen=True, kw_only=True)
class Trend:
    """Times of a task over a size, their power law, and the exponent ``expected`` of the method."""

    task: str
    size: str
    sizes: tuple[float, ...]
    times_s: tuple[float, ...]
    law: PowerLaw
    expected: float


@dataclass(frozen=True, kw_only=True)
class Scaling:
    """Growth of the time with elements, with pads of each model, with effects of each model, and
    with length of the rails, cases and threads (``trends``)."""

    elements: MeshGrowth
    pads: tuple[Growth, ...]
    effects: tuple[EffectTimes, ...]
    trends: tuple[Trend, ...]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """``band_deg_s``: uncertainty of the finest mesh, None if not known."""

    condition: str
    scene_hash: str
    band_deg_s: float | None
    points: tuple[Point, ...]
    matched: tuple[Match, ...]
    scaling: Scaling
    hardware: dict
