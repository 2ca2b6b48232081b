"""Cases of an ensemble from a CSV file, held as columns of numbers."""

import hashlib
import json
from array import array
from collections.abc import Callable
from functools import partial
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import numpy as np

from tipoff import units
from tipoff.faults import Fault, SceneError
from tipoff.formats import csv_file
from tipoff.scenes import overrides as keys
from tipoff.scenes.scene import Scene

_TOO_MANY, _TOO_FEW = "cells beyond the header", "a missing cell"


class TableFile:
    """Cases of a CSV file: dotted keys in its header, units in the second line or in each cell, one
    case a line. An empty cell of a key that is no number, such as ``friction``, leaves the scene's
    value. A cell that is no number of its unit stays text; the scene then refuses that case.

    Raises SceneError for a file that cannot be read, for keys and units that do not fit a scene,
    and for cells of numbers that are empty.
    """

    def __init__(self, path: str | Path):
        self._odd: dict[int, dict[str, str]] = {}
        self._empty: dict[str, list[int]] = {}
        rows = csv_file.lines(path)
        self.keys = _header(str(path), next(rows, (0, []))[1])
        self._columns = [array("d") for _ in self.keys]
        wanted = [keys.unit(Scene, key) for key in self.keys]
        self._numbers = {key for key, unit in zip(self.keys, wanted) if unit is not None}
        line, second = next(rows, (0, []))
        readers: list[Callable[[str], float]]
        if units.are_units(second):
            factors = _factors(str(path), self.keys, wanted, second)
            readers = [partial(_number, factor) for factor in factors]
        else:
            readers = [partial(_quantity, unit) for unit in wanted]
            rows = chain([(line, second)] if second else [], rows)
        for line, row in rows:
            self._append(line, row, readers)
        if self._empty:
            words = "a value in each line"
            raise SceneError(
                [
                    Fault(str(path), key, f"nothing in {csv_file.listed_lines(lines)}", words)
                    for key, lines in self._empty.items()
                ]
            )
        self.asked = len(self._columns[0])
        if not self.asked:
            raise SceneError([Fault(str(path), "file", "no case", "one in each line")])
        digest = hashlib.sha256(json.dumps([self.keys, list(self._odd.items())]).encode())
        for column in self._columns:
            digest.update(column)
        self.identity = {"table": digest.hexdigest(), "cases": self.asked}

    def _append(self, line: int, row: list[str], readers: list[Callable[[str], float]]) -> None:
        number, odd = len(self._columns[0]), {}
        for key, column, read, text in zip(
            self.keys, self._columns, readers, chain(row, repeat(_TOO_FEW))
        ):
            column.append(value := read(text))
            if value != value and text.strip():
                odd[key] = text.strip()
            if key in self._numbers and (text is _TOO_FEW or not text.strip()):
                self._empty.setdefault(key, []).append(line)
        if len(row) > len(self.keys):
            odd[_TOO_MANY] = ", ".join(row[len(self.keys) :])
        if odd:
            self._odd[number] = odd

    def rows(self, begin: int, end: int) -> list[dict[str, Any]]:
        """Overrides of the cases ``begin`` to ``end`` - 1."""
        # NaN marks an empty cell or text
        found = [
            {key: value for key, value in zip(self.keys, values) if value == value}
            for values in zip(*(column[begin:end] for column in self._columns))
        ]
        for number, row in enumerate(found, begin):
            row.update(self._odd.get(number, {}))
        return found


def _header(path: str, header: list[str]) -> list[str]:
    names = [name.strip() for name in header]
    faults = [
        Fault(
            path,
            name or "header",
            "twice" if keys.is_key(Scene, name) else repr(name),
            "a dotted key of a scene, once",
        )
        for place, name in enumerate(names)
        if not keys.is_key(Scene, name) or name in names[:place]
    ]
    if faults or not names:
        raise SceneError(faults or [Fault(path, "header", "nothing", "dotted keys of a scene")])
    return names


def _factors(
    path: str, names: list[str], wanted: list[str | None], units_given: list[str]
) -> list[float]:
    """Factors to SI, NaN for a key that is not a number."""
    faults: list[Fault] = []
    factors = []
    for name, unit, text in zip(names, wanted, chain(units_given, repeat(""))):
        factor = np.nan
        if unit is not None:
            factor, wrong = csv_file.factor_to_si(path, name, text, unit or "dimensionless")
            faults += wrong
        factors.append(factor)
    if faults:
        raise SceneError(faults)
    return factors


def _number(factor: float, text: str) -> float:
    try:
        return float(text) * factor
    except ValueError:
        return np.nan


def _quantity(unit: str | None, text: str) -> float:
    """SI value of a cell such as "0.1 deg"; the same bits as ``units.to_si``, which parses the unit
    for every number."""
    number, _, given = text.strip().partition(" ")
    try:
        return (
            np.nan
            if unit is None
            else float(number) * units.to_si(f"1 {given}", unit or "dimensionless")
        )
    except ValueError:
        return np.nan
