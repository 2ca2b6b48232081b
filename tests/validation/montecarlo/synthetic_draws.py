"""Draws with given settled rates, without runs."""

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.studies.populations.draws import Draws


def results(rates) -> columns.Columns:
    """Columns of cases with ``rates`` (n,3), deg/s; NaN did not settle."""
    rates = np.radians(np.asarray(rates, dtype=float))
    settled = np.where(np.isnan(rates).any(axis=1), np.nan, 1.0)
    return columns.Columns(
        *[
            rates
            if name == "rate"
            else np.zeros((len(rates), 3)) * settled[:, None]
            if name in columns.VECTORS
            else np.zeros(len(rates), dtype=int)
            if name in ("status", "steps")
            else settled
            for name in columns.Columns._fields
        ]
    )


def drawn(reference, surrogate, contacts) -> Draws:
    return Draws(
        results(reference), results(surrogate), results(reference[:2]), np.array(contacts), [],
        reference_cpu_s=1.0, fine_cpu_s=8.0, elements=1, fine_elements=8,
    )  # fmt: skip
