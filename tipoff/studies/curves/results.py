"""Result of ``tipoff curves``: each curve, its ratings, and its samples for the figure."""

from dataclasses import dataclass
from typing import Annotated

from tipoff.studies.curves.options import CurvesOptions
from tipoff.studies.render.column import Column

Rates = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class CurveDifference:
    """One curve; the differences are from the reference, None in its own row. Magnitude and phase
    are those of Sprague and Geers."""

    curve: Annotated[str, Column("curve")]
    settled_rate_deg_s: Annotated[Rates, Column("settled x, y, z", "deg/s")]
    settled_from_s: Annotated[float, Column("settled from", "ms", ".4g", 1e3)]
    settled_rate_error_deg_s: Annotated[float | None, Column("settled error", "deg/s")] = None
    rate_relative_l2: Annotated[float | None, Column("rates L2", "%", scale=100.0)] = None
    velocity_relative_l2: Annotated[float | None, Column("v_x L2", "%", scale=100.0)] = None
    iso18571: Annotated[float | None, Column("ISO 18571")] = None
    sprague_geers_magnitude: Annotated[float | None, Column("magnitude", "%", "+.3g", 100.0)] = None
    sprague_geers_phase: Annotated[float | None, Column("phase", "%", scale=100.0)] = None


@dataclass(frozen=True, kw_only=True)
class Channel:
    """The rating of each channel of a curve by ISO/TS 18571; None where v_x is not known."""

    curve: Annotated[str, Column("curve")]
    velocity_x: Annotated[float | None, Column("v_x")] = None
    rate_x: Annotated[float, Column("rate x")]
    rate_y: Annotated[float, Column("rate y")]
    rate_z: Annotated[float, Column("rate z")]


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A curve, thinned; ``velocity_m_s`` is None if not known."""

    source: str
    time_s: tuple[float, ...]
    velocity_m_s: tuple[float, ...] | None
    rate_deg_s: tuple[Rates, ...]


@dataclass(frozen=True, kw_only=True)
class Compared:
    """Curves by name, the first of them the ``reference``; ``condition`` of the runs of tipoff."""

    scene: str
    asked: CurvesOptions
    condition: str | None
    reference: str
    rows: tuple[CurveDifference, ...]
    ratings: tuple[Channel, ...]
    drawn: dict[str, Drawn]
    failed: tuple[str, ...] = ()
