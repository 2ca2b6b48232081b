"""``[studies]``: settings of the studies of a scene; ``--set`` of commands and arguments replace
them. Solvers do not read this table, so it is not part of the physics. It is inherited like other
tables."""

import math
from typing import Annotated

from pydantic import Field, field_validator

from tipoff.scenes.table import Table, limited
from tipoff.scenes.units import ElementSize, PositiveNumber

ELEMENT_SIZE = 2e-3  # m, default of all but long rails
# Default (m) of rails up to a length (m). Statics of longer ones with the elements of shorter ones take
# more memory or time than a laptop has.
_BY_LENGTH = ((2.1, ELEMENT_SIZE), (4.0, 10e-3), (math.inf, 20e-3))
_Count = Annotated[int, Field(strict=True, ge=1, le=10_000)]
_Modes = Annotated[int, Field(strict=True, ge=1, le=20)]  # as many as a rail compliance has
_Neighbours = Annotated[int, Field(strict=True, ge=5, le=10_000)]


class StudiesTable(Table):
    """``[studies]``: element size (m) of the reference and of the rail compliance, random errors of
    a launch, and numbers that make the studies of a small scene short."""

    #: Element size of the reference and of the rail compliance. Studies with many runs, or with
    #: differences of runs, use twice this size. Where absent: 2 mm; 10 mm for rails
    #: longer than 2.1 m, 20 mm for those longer than 4 m.
    element_size: ElementSize | None = None
    #: Random errors of a launch: a file of distributions (.toml), relative to the scene file, or a name
    #: of the catalogue. The report states the 95 % range of the rates under them.
    errors: str | None = None
    #: Meshes of the convergence study, coarsest first: their element sizes divided by
    #: element_size, one of them 1.
    mesh_ratios: Annotated[tuple[PositiveNumber, ...], limited] | None = None
    #: Neighbours within 1 um that judge a chaotic condition.
    neighbours: _Neighbours | None = None
    #: Modes of each rail, of the surrogate that is compared with a fixed number of them; 4 where absent.
    rail_modes: _Modes | None = None
    #: Repeats of timed runs of the reference.
    highfi_repeats: _Count | None = None
    #: Repeats of timed runs of the surrogate.
    lowfi_repeats: _Count | None = None

    @field_validator("mesh_ratios")
    @classmethod
    def _coarsest_first(cls, ratios: tuple[float, ...] | None):
        if ratios is not None and (
            list(ratios) != sorted(set(ratios), reverse=True) or 1.0 not in ratios
        ):
            raise ValueError("falling ratios, one of them 1")
        return ratios


def element_size(table: StudiesTable | None, rail: float) -> float:
    """Element size (m) of the reference and of the rail compliance of a scene with this ``table`` and
    length of its ``rail`` (m), unless an option or argument gives another."""
    return (table and table.element_size) or usual_size(rail)


def usual_size(rail: float) -> float:
    """Element size (m) of a ``rail`` of this length (m) if the scene states none."""
    return next(size for most, size in _BY_LENGTH if rail <= most)
