"""The verdict on a hard case: the measured value and that of a weaker method."""

import math
from dataclasses import dataclass
from functools import partial
from typing import Annotated, NamedTuple

from tipoff.results.trajectory import Trajectory
from tipoff.studies.render.column import Column

_INFINITE = "infinite"
_step = partial(Column, unit="µs", scale=1e6, detail=True)


class Stability(NamedTuple):
    """``largest_step_s``: the smallest value of the proven limit, which no step exceeds (rigid
    surrogate), or the time step (reference); ``critical_step_s``: 2 / omega of the linearised case,
    above which central differences diverge; ``energy_drift``: largest residual of the total ledger
    over its scale. None if nothing touches or vibrates."""

    largest_step_s: float | None = None
    critical_step_s: float | None = None
    energy_drift: float | None = None


@dataclass(frozen=True)
class Verdict:
    """One line of the stability table. ``figure`` is the measured value, to be at most ``limit``
    (dimensionless unless ``measure`` states a unit); ``control_figure`` is the same measure of the
    weaker method. An infinite value is None. The last three fields are those of ``Stability``."""

    name: Annotated[str, Column("case")]
    fidelity: Annotated[str, Column("model")]
    measure: str
    figure: Annotated[float | None, Column("measured", nothing=_INFINITE)]
    limit: Annotated[float, Column("limit")]
    held: bool
    control: Annotated[str, Column("simpler method")]
    control_figure: Annotated[float | None, Column("its figure", nothing=_INFINITE, detail=True)]
    control_failed: bool
    note: str = ""
    largest_step_s: Annotated[float | None, _step("largest step")] = None
    critical_step_s: Annotated[float | None, _step("critical step")] = None
    energy_drift: Annotated[float | None, Column("energy drift", form=".2g", detail=True)] = None


def stability(run: Trajectory, stiffness: float = 0.0, mass: float = 1.0) -> Stability:
    """Step limit and energy drift of ``run``, and the critical step 2 sqrt(m / k) of a ``mass`` (kg)
    on the largest ``stiffness`` (N/m)."""
    critical = 2.0 * math.sqrt(mass / stiffness) if stiffness else None
    return Stability(run.cost.get("dt_limit_s"), critical, run.checks["energy_error"])


class Measure(NamedTuple):
    """The measured value of a case, and its limit."""

    words: str
    figure: float
    limit: float


class Control(NamedTuple):
    """A weaker method, and its value of the same measure."""

    words: str
    figure: float


def verdict(
    name: str,
    fidelity: str,
    measure: Measure,
    control: Control,
    note: str = "",
    holds: bool = True,
    stable: Stability = Stability(),
) -> Verdict:
    """The verdict from both figures; ``holds`` is a further condition without a number, such as a
    status."""
    return Verdict(
        name=name,
        fidelity=fidelity,
        measure=measure.words,
        figure=_finite(measure.figure),
        limit=measure.limit,
        held=bool(holds and measure.figure <= measure.limit),
        control=control.words,
        control_figure=_finite(control.figure),
        control_failed=not bool(control.figure <= measure.limit),
        note=note,
        **stable._asdict(),
    )


def _finite(value: float) -> float | None:
    return float(value) if abs(value) < float("inf") else None
