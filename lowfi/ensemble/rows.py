"""Sources of the cases of an ensemble: drawn by number, or listed by a program;
``lowfi.ensemble.table`` reads them from a file.

Every source has ``asked``, the number of its cases, their ``keys``, an ``identity`` (JSON) that
distinguishes ensembles, and ``rows(begin, end)``, a list of dotted overrides as ``Scene.replace``
takes them. Cases are drawn by ``rows``, so that they are never all in memory.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from tipoff import units
from tipoff.lowfi.ensemble.sampling import Points
from tipoff.scenes import overrides as keys
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty


class Drawn:
    """Cases of ``uncertainty``."""

    def __init__(self, uncertainty: Uncertainty):
        self.uncertainty = uncertainty
        self.asked, self.keys, self.identity = (
            uncertainty.cases,
            list(uncertainty.overrides({key: [0.0] for key in uncertainty.vary})),
            uncertainty.resolved(),
        )
        self._points = Points(uncertainty)

    def rows(self, begin: int, end: int) -> list[dict[str, float]]:
        """Overrides of the cases ``begin`` to ``end`` - 1, SI."""
        points = self._points.draw(begin, end)
        drawn = {
            key: item.ppf(column).tolist()
            for (key, item), column in zip(self.uncertainty.vary.items(), points.T)
        }
        columns = self.uncertainty.overrides(drawn)
        return [dict(zip(columns, values)) for values in zip(*columns.values())]


class Listed:
    """Cases that a program lists."""

    def __init__(self, table: Sequence[Mapping[str, Any]]):
        self._table, self.asked = list(table), len(table)

    @cached_property
    def keys(self) -> list[str]:
        """All dotted keys of all rows."""
        return list(dict.fromkeys(key for row in self._table for key in row))

    @cached_property
    def identity(self) -> dict:
        """Digest of the table."""
        digest = hashlib.sha256()
        for row in self._table:
            digest.update(json.dumps(list(row.items()), default=repr).encode())
        return {"table": digest.hexdigest(), "cases": self.asked}

    def rows(self, begin: int, end: int) -> list[Mapping[str, Any]]:
        """Overrides of the cases ``begin`` to ``end`` - 1."""
        return self._table[begin:end]


def numbers(names: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Numbers (n, k) in SI under the k keys ``names`` of n rows; NaN for a missing value and for a
    value that is not a number."""
    wanted = [(name, keys.unit(Scene, name)) for name in names]
    found = [
        [
            value if type(value := row.get(name)) is float else _si(value, unit)
            for name, unit in wanted
        ]
        for row in rows
    ]
    return np.array(found, dtype=float).reshape(len(rows), len(names))


def _si(value: Any, unit: str | None) -> float:
    try:
        return units.parse(value, unit or "dimensionless", bare_numbers_are_si=True)
    except ValueError:
        return np.nan
