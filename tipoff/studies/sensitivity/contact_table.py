"""Contact constants changed one at a time, in the form of Table 2 of the paper
(``studies.published``).

A deviation is absolute, w - w0, and relative, (w - w0)/w0. The relative one is left out where w0 is
below a twentieth of the total rate of its condition. A change of the clearance by one micrometre is
added for comparison: it is the floor of every agreement.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.models import COMPLIANT
from tipoff.scenes.scene import Scene
from tipoff.studies import published

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
    share = CLEARANCE / scene.contact.clearance if scene.contact.clearance else 0.0
    return [
        *found,
        Change("clearance", True, share, scene.contact.widened(CLEARANCE)),
    ]


def conditions(scene: Scene) -> list[str]:
    """The conditions of Table 2 if the scene has them all, else the fitted ones, else all."""
    names = [name for name in published.CONDITIONS if name in scene.conditions]
    return (
        names
        if len(names) == len(published.CONDITIONS)
        else list(scene.agreement.fitted or scene.conditions)
    )


def deviations(baseline: Sequence[float], rates: Sequence[float]) -> dict:
    """Absolute (deg/s) and relative deviations by axis; a relative one is None where the rate of
    the ``baseline`` is below a twentieth of its total rate."""
    nominal = np.asarray(baseline, dtype=float)
    moved = np.asarray(rates, dtype=float) - nominal
    meaningful = (abs(nominal) >= _NEARLY_ZERO * np.linalg.norm(nominal)) & (nominal != 0.0)
    return {
        "absolute_deg_s": moved.tolist(),
        "relative": [float(d / w) if ok else None for d, w, ok in zip(moved, nominal, meaningful)],
    }


def rows(
    condition: str,
    changed: Sequence[Change],
    rates: np.ndarray,
    others: Mapping[str, np.ndarray] | None = None,
) -> list[dict]:
    """Rows of the table for one condition; ``rates`` (n,3) in deg/s, NaN where a case did not
    settle. For ``others`` (n,) by name: their ``values``, and the change ``moved`` of each."""
    found, columns = [], others or {}
    for place, (change, rate) in enumerate(zip(changed, rates)):
        settled = bool(np.isfinite(rate).all() and np.isfinite(rates[0]).all())
        values = {name: float(column[place]) for name, column in columns.items()}
        found.append(
            {
                "condition": condition,
                "symbol": change.symbol,
                "raised": change.raised,
                "share": change.share,
                "value_si": next(iter(change.overrides.values()), None),
                "rate_deg_s": rate.tolist() if settled else None,
                **(
                    deviations(rates[0], rate)
                    if settled
                    else {"absolute_deg_s": None, "relative": None}
                ),
                "values": values if settled else None,
                "moved": {name: value - float(columns[name][0]) for name, value in values.items()}
                if settled
                else None,
            }
        )
    return found


def of_paper() -> list[dict]:
    """Table 2 of the paper with the deviations that follow from its rates."""
    names = {number: name for name, number in published.CONDITIONS.items()}
    found = []
    baseline: tuple[float, float, float] | None = None
    for row in published.table_2():
        baseline = row.rates if row.raised is None else baseline
        assert baseline is not None  # the first row of each condition
        found.append(
            {
                "condition": names[row.condition],
                "symbol": row.symbol,
                "raised": row.raised,
                "rate_deg_s": list(row.rates),
                **deviations(baseline, row.rates),
            }
        )
    return found


def largest(table: Sequence[dict], symbols: Sequence[str] | None = None) -> dict:
    """Largest deviations by axis over the rows of a table, or over those of ``symbols``: absolute
    (deg/s) and relative."""
    moved = [
        row
        for row in table
        if row["raised"] is not None
        and row["rate_deg_s"] is not None
        and (row["symbol"] in symbols if symbols else row["symbol"] != "clearance")
    ]

    def most(name: str) -> list[float | None]:
        columns = [
            [abs(row[name][axis]) for row in moved if row[name][axis] is not None]
            for axis in range(3)
        ]
        return [max(column, default=None) for column in columns]

    return {"absolute_deg_s": most("absolute_deg_s"), "relative": most("relative")}


def most_moved(table: Sequence[dict]) -> dict[str, float]:
    """The largest change of each quantity over the rows of a table, without the clearance; empty
    where no row settled."""
    moved = [
        row["moved"]
        for row in table
        if row["moved"] and row["raised"] is not None and row["symbol"] != "clearance"
    ]
    return {name: max(abs(row[name]) for row in moved) for name in (moved[0] if moved else ())}
