"""Result of the study of growth: how the time of a run grows."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.studies.render.column import Column


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

    condition: str
    elements: MeshGrowth
    pads: tuple[Growth, ...]
    effects: tuple[EffectTimes, ...]
    trends: tuple[Trend, ...]
    hardware: dict
