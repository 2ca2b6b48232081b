"""Growth of a disturbance of one micrometre, and the time up to which two curves can be compared.

    s(t) = largest of |w'(t) - w(t)| over the axes and over the twins w', which start with every
           wall 1 um farther off or nearer
    d_k  = mean of s over the free flight after contact k
    factor d_k / d_(k-1),   exponent ln(d_k / d_(k-1)) / (t_k - t_(k-1)),   t_k the end of contact k

The walls are moved, as for the floor, because this affects every face and exists in both models. Before
the first contact there is no difference. The first contact converts the distance into a rate d_1. Every
later contact adds a similar part, so only d_k above k d_1 is growth.

**Horizon**: the first instant at which s passes the gate of the settled rates and is not back below it
after the same contact. Twins touch at different instants, so s peaks while only one of them is in
contact. A peak that ends with the contact is only a shift of time. Curves can be compared up to the
horizon of the reference. **Sensitive**: 1 um changes a settled rate by more than the gate. **Chaotic**:
sensitive, and d after the last of n contacts is above n d_1, so growth from contact to contact is the
cause. **Not known**: a run did not settle.
"""

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from tipoff.comparison.metrics import common_time
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement.verdicts import largest_known, settled_change
from tipoff.studies.render.column import Column

STABLE, SENSITIVE, CHAOTIC = "stable", "sensitive, not chaotic", "chaotic"
UNKNOWN = "not known: a run did not settle"
_BOUNCE = 1e-3  # s: contacts closer than this count as one
_DRAWN = 300  # points of a curve in a result file


@dataclass(frozen=True)
class Contact:
    """One contact of any of the twins: its begin and end (s), the separation after it (deg/s), and
    the factor and exponent (1/s) since the contact before, None for the first."""

    start_s: float
    end_s: float
    separation_deg_s: float
    factor: float | None = None
    exponent_per_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class Growth:
    """Separation of one model from its twins on one condition, settled in deg/s (None where a run
    did not settle) and per um of the disturbance; factor and exponent (1/s) from the first contact
    to the last, None with fewer than two; horizon (s), None if s never passes the gate; the
    verdicts above; and the curve, thinned to the largest value of each interval."""

    condition: Annotated[str, Column("condition")]
    model: Annotated[str, Column("model")]
    disturbance_m: float
    gate_deg_s: float
    contacts: list[Contact]
    factor: Annotated[float | None, Column("factor, first to last")]
    exponent_per_s: Annotated[float | None, Column("exponent", "1/s")]
    settled_separation_deg_s: float | None
    settled_growth_deg_s_um: Annotated[float | None, Column("settled", "deg/s per µm")]
    horizon_s: float | None
    end_s: float
    sensitive: bool | None
    chaotic: bool | None
    time_s: list[float]
    separation_deg_s: list[float]

    @property
    def verdict(self) -> str:
        """One word for whether 1 um grows: ``STABLE``, ``SENSITIVE``, ``CHAOTIC`` or ``UNKNOWN``."""
        if self.sensitive is None:
            return UNKNOWN
        return CHAOTIC if self.chaotic else SENSITIVE if self.sensitive else STABLE


def growth(
    condition: str,
    model: str,
    nominal: Trajectory,
    twins: list[Trajectory],
    disturbance: float,
    gate: float,
) -> Growth:
    """Growth of a ``disturbance`` (m) in one model, from runs that differ by it; ``gate`` (deg/s)
    of the settled rates."""
    time = min((common_time(nominal, twin) for twin in twins), key=lambda each: each[-1])
    apart = separation(time, nominal, twins)
    spans = contacts(time, np.any([_loaded(run, time) for run in (nominal, *twins)], axis=0))
    touched = _after(time, apart, spans)
    factor, exponent = _rate(touched[0], touched[-1]) if len(touched) > 1 else (None, None)
    settled = largest_known(settled_change(nominal, twin) for twin in twins)
    sensitive = None if settled is None else settled > gate
    times, separations = _drawn(time, apart)
    return Growth(
        condition=condition,
        model=model,
        disturbance_m=disturbance,
        gate_deg_s=gate,
        contacts=touched,
        factor=factor,
        exponent_per_s=exponent,
        settled_separation_deg_s=settled,
        settled_growth_deg_s_um=None if settled is None else settled / (1e6 * disturbance),
        horizon_s=horizon(time, apart, spans, gate),
        end_s=float(time[-1]),
        sensitive=sensitive,
        chaotic=sensitive and factor is not None and factor > len(touched),
        time_s=times,
        separation_deg_s=separations,
    )


def separation(time: np.ndarray, nominal: Trajectory, twins: list[Trajectory]) -> np.ndarray:
    """s (n,) deg/s at ``time`` (n,) s."""

    def rate(run):
        return np.column_stack(
            [np.interp(time, run.time, column) for column in np.degrees(run.rate).T]
        )

    return np.max([np.abs(rate(twin) - rate(nominal)).max(axis=1) for twin in twins], axis=0)


def contacts(time: np.ndarray, loaded: np.ndarray) -> list[tuple[int, int]]:
    """First sample of each contact and the one after its last; ``loaded`` (n,): a pad bears a
    force."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], loaded, [False]]).astype(int)))
    spans: list[tuple[int, int]] = []
    for first, after in zip(edges[::2].tolist(), edges[1::2].tolist()):
        if spans and time[first] - time[spans[-1][1] - 1] < _BOUNCE:
            first = spans.pop()[0]
        spans.append((first, after))
    return spans


def horizon(
    time: np.ndarray, apart: np.ndarray, spans: list[tuple[int, int]], gate: float
) -> float | None:
    """First instant (s) at which ``apart`` (n,) passes ``gate`` and stays above it after the
    contact; ``spans`` as from ``contacts``; None without such an instant. Between samples s is
    assumed to grow exponentially."""
    free = np.ones(time.size, dtype=bool)
    for first, after in spans:
        free[first : min(after, time.size - 1)] = False
    beyond = np.flatnonzero(free & (apart > gate))
    if not beyond.size:
        return None
    begin = next(
        (first for first, after in spans if after == beyond[0] or first <= beyond[0] < after),
        beyond[0],
    )
    at = begin + int(np.argmax(apart[begin:] > gate))
    if at == 0 or not 0.0 < apart[at - 1] < gate:
        return float(time[at])
    share = math.log(gate / apart[at - 1]) / math.log(apart[at] / apart[at - 1])
    return float(time[at - 1] + share * (time[at] - time[at - 1]))


def _after(time: np.ndarray, apart: np.ndarray, spans: list[tuple[int, int]]) -> list[Contact]:
    found: list[Contact] = []
    for (first, after), following in zip(spans, [*(first for first, _ in spans[1:]), time.size]):
        free = apart[after:following] if following > after else apart[-1:]
        contact = Contact(float(time[first]), float(time[after - 1]), float(free.mean()))
        if found:
            factor, exponent = _rate(found[-1], contact)
            contact = replace(contact, factor=factor, exponent_per_s=exponent)
        found.append(contact)
    return found


def _rate(first: Contact, last: Contact) -> tuple[float | None, float | None]:
    """Factor and exponent (1/s) of the separation between two contacts."""
    if not (first.separation_deg_s > 0.0 and last.separation_deg_s > 0.0):
        return None, None
    factor = last.separation_deg_s / first.separation_deg_s
    return factor, math.log(factor) / (last.end_s - first.end_s)


def _loaded(run: Trajectory, time: np.ndarray) -> np.ndarray:
    """Whether a pad bears a force at the sample before ``time`` or after it."""
    bears = np.abs(run.pad_force).max(axis=(1, 2)) > 0.0
    return np.interp(time, run.time, bears.astype(float)) > 0.0


def _drawn(time: np.ndarray, apart: np.ndarray) -> tuple[list[float], list[float]]:
    starts = np.unique(
        np.linspace(0, time.size, min(_DRAWN, time.size), endpoint=False).astype(int)
    )
    largest_of_each = np.maximum.reduceat(apart, starts)
    return [round(float(value), 7) for value in time[starts]], [
        float(f"{value:.4g}") for value in largest_of_each
    ]
