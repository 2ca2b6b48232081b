"""Sensitivity of each case of an ensemble: the change of its settled rates due to small
disturbances.

Each disturbance has a twin of the ensemble, with the same cases: one with every clearance 1 um
larger, one with a tighter tolerance. The change of a case is the largest change of a settled rate
over the axes::

    max over x, y, z of |w' - w|   (rad/s), w of the case, w' of its twin

It is NaN if one of both has no settled rate, and zero for the clearance of a case without contact.
In a store the twins are stores of their own, in the folder ``twins``, so that they can be continued
too.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from tipoff.lowfi.ensemble.store import Store
from tipoff.lowfi.numerics import Numerics

if TYPE_CHECKING:
    from tipoff.lowfi.ensemble.request import Ensemble

CLEARANCE_CHANGE = 1e-6  # m
TOLERANCE = 1e-10  # relative, of a step


def of_ensemble(ensemble: "Ensemble") -> "dict[str, Ensemble]":
    """The twins of ``ensemble`` by the cause of the difference."""
    return {
        "clearance": ensemble._replace(widening=CLEARANCE_CHANGE),
        "tolerance": ensemble._replace(numerics=tight(ensemble.numerics)),
    }


def tight(numerics: Numerics) -> Numerics:
    """``numerics`` at ``TOLERANCE``, or at a tenth of their own tolerance if that is less;
    unchanged at the finest tolerance."""
    finer = min(TOLERANCE, numerics.tightened().relative_tolerance)
    return replace(numerics, relative_tolerance=finer)


def change(rate: np.ndarray, disturbed: np.ndarray) -> np.ndarray:
    """Largest change over the axes (n,) of settled rates (n, 3), rad/s; NaN if a rate is NaN."""
    return np.abs(disturbed - rate).max(axis=1)


def column(cause: str) -> str:
    """Name of the column of changes."""
    return f"rate_change_by_{cause}"


def attributes(cause: str, twin: "Ensemble") -> dict[str, str]:
    """Unit and meaning of the column of changes."""
    causes = {
        "clearance": f"{twin.widening:g} m more of every clearance",
        "tolerance": f"a tolerance of {twin.numerics.relative_tolerance:g}",
    }
    return {"units": "rad/s", "long_name": f"largest change of a settled rate by {causes[cause]}"}


def opened(twin: "Ensemble", cause: str, store: Store) -> Store:
    """The store of a twin of ``store``, created if it does not exist. Raises StoreError."""
    return twin.store(store.path / "twins" / cause)


def add(store: Store, cause: str, twin: "Ensemble", disturbed: Store) -> None:
    """Add the column of changes to a complete ``store``; ``disturbed`` is the store of its
    ``twin``. Raises StoreError."""
    store.add(column(cause), attributes(cause, twin), changes(store, disturbed))


def changes(store: Store, twin: Store) -> Iterator[np.ndarray]:
    """The column of changes (rad/s), chunk by chunk."""
    for number in range(len(store)):
        bounds = store.bounds(number)
        yield change(store.column("rate", *bounds), twin.column("rate", *bounds))
