"""Contact constants changed one at a time, by the shares of Table 2 of the paper.

Deviations are absolute, w - w0, and relative, (w - w0)/w0. The relative deviation is left out if w0 is
below a twentieth of the total rate of its condition. For comparison, the clearance changes by one
micrometre, which is the floor of every agreement.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes.scene import Scene

# The changes of Table 2: 70,000 to 66,000 and 74,000; 60 to 50 and 70; 0.30 to 0.25 and 0.35.
# Compliant contact has the interface stiffness alone.
_STIFFNESS, _DAMPING = 4.0 / 70.0, 10.0 / 60.0
_MOVED = {
    "stiffness": ("k", _STIFFNESS),
    "damping": ("c", _DAMPING),
    "damping_depth": ("d", _DAMPING),
    "dissipation": ("a", _DAMPING),
}
_COMPLIANT = {"interface_stiffness": ("interface stiffness", _STIFFNESS)}
CLEARANCE = 1e-6  # m
_NEARLY_ZERO = 0.05


class Change(NamedTuple):
    """A changed constant: its ``symbol``, whether it is ``raised`` (None: the baseline without a
    change), the relative change ``share``, and the overrides of the scene (SI)."""

    symbol: str
    raised: bool | None
    share: float
    overrides: dict[str, float]


def changes(scene: Scene, model: str) -> list[Change]:
    """The changes of ``scene``, which has contact: the baseline, then each contact constant of
    ``model`` lowered and raised, then the clearance."""
    assert scene.contact is not None
    found = [Change("baseline", None, 0.0, {})]
    for name, (symbol, share) in (_COMPLIANT if model == COMPLIANT else _MOVED).items():
        if (value := getattr(scene.contact, name, None)) is not None:
            found += [
                Change(symbol, raised, share, {f"contact.{name}": value * (1.0 + sign * share)})
                for raised, sign in ((False, -1.0), (True, 1.0))
            ]
    narrowest = scene.contact.narrowest()
    share = CLEARANCE / narrowest if narrowest else 0.0
    return [*found, Change("clearance", True, share, scene.contact.widened(CLEARANCE))]


def conditions(scene: Scene) -> list[str]:
    """The fitted conditions, else all."""
    return list(scene.agreement.fitted or scene.conditions)


Axes = tuple[float | None, float | None, float | None]  # about x, y, z


@dataclass(frozen=True, kw_only=True)
class Deviations:
    """Deviations by axis; None if a case did not settle. A relative one is None if the rate of the
    baseline is below a twentieth of its total rate."""

    absolute_deg_s: Axes | None = None
    relative: Axes | None = None


@dataclass(frozen=True, kw_only=True)
class PerturbedRun(Deviations):
    """A ``Change`` of a ``condition``: the changed value, rates, and ``values`` of further
    quantities by name, with the change of each. None if a case did not settle."""

    condition: str
    symbol: str
    raised: bool | None
    share: float | None = None
    value_si: float | None = None
    rate_deg_s: tuple[float, float, float] | None
    values: dict[str, float] | None = None
    moved: dict[str, float] | None = None


def deviations(baseline: Sequence[float], rates: Sequence[float]) -> Deviations:
    """Deviations of ``rates`` (3,) from the ``baseline`` (3,), deg/s."""
    nominal = np.asarray(baseline, dtype=float)
    moved = np.asarray(rates, dtype=float) - nominal
    meaningful = (abs(nominal) >= _NEARLY_ZERO * np.linalg.norm(nominal)) & (nominal != 0.0)
    x, y, z = (float(d / w) if ok else None for d, w, ok in zip(moved, nominal, meaningful))
    return Deviations(absolute_deg_s=tuple(moved.tolist()), relative=(x, y, z))


def rows(
    condition: str,
    changed: Sequence[Change],
    rates: np.ndarray,
    others: Mapping[str, np.ndarray] | None = None,
) -> list[PerturbedRun]:
    """Rows of the table for one condition; ``rates`` (n,3) in deg/s, NaN where a case did not
    settle; ``others`` (n,), further quantities by name."""
    found, columns = [], others or {}
    for place, (change, rate) in enumerate(zip(changed, rates)):
        row = PerturbedRun(
            condition=condition,
            symbol=change.symbol,
            raised=change.raised,
            share=change.share,
            value_si=next(iter(change.overrides.values()), None),
            rate_deg_s=None,
        )
        if np.isfinite(rate).all() and np.isfinite(rates[0]).all():
            values = {name: float(column[place]) for name, column in columns.items()}
            row = replace(
                row,
                rate_deg_s=tuple(rate.tolist()),
                **vars(deviations(rates[0], rate)),
                values=values,
                moved={name: value - float(columns[name][0]) for name, value in values.items()},
            )
        found.append(row)
    return found


def largest(table: Sequence[PerturbedRun], symbols: Sequence[str] | None = None) -> Deviations:
    """Largest deviations by axis over the rows of a table, or over those of ``symbols``."""
    moved = [
        row
        for row in table
        if row.raised is not None
        and (row.symbol in symbols if symbols else row.symbol != "clearance")
    ]

    def most(found: Sequence[Axes | None]) -> Axes:
        known = [row for row in found if row]
        x, y, z = (
            max((abs(each) for row in known if (each := row[axis]) is not None), default=None)
            for axis in range(3)
        )
        return x, y, z

    return Deviations(
        absolute_deg_s=most([row.absolute_deg_s for row in moved]),
        relative=most([row.relative for row in moved]),
    )


def most_moved(table: Sequence[PerturbedRun]) -> dict[str, float]:
    """The largest change of each quantity over the rows of a table, without the clearance; empty
    where no row settled."""
    moved = [
        row.moved
        for row in table
        if row.moved and row.raised is not None and row.symbol != "clearance"
    ]
    return {name: max(abs(row[name]) for row in moved) for name in (moved[0] if moved else ())}
