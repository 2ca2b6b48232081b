"""A table of the force of a pusher over its travel."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tipoff.faults import SceneError
from tipoff.files import read_input
from tipoff.formats import instrument_table
from tipoff.formats.instrument_table import Written, name_and_unit

_COLUMNS = {"travel": "m", "force": "N"}


class Push(NamedTuple):
    """Force of one pusher over its travel, at k knots."""

    travel: np.ndarray  # (k,) m, rising from zero
    force: np.ndarray  # (k,) N

    def energy(self) -> np.ndarray:
        """Energy (k,) J that is given up from zero travel to each knot."""
        steps = 0.5 * (self.force[1:] + self.force[:-1]) * np.diff(self.travel)
        return np.concatenate([[0.0], np.cumsum(steps)])


def read_push(path: str) -> Push:
    """Read a table with the columns ``travel`` and ``force`` and their units, as a spreadsheet of any
    country writes it (``formats.instrument_table``). Raises ValueError with every fault of the table."""
    try:
        data = read_input(path)
    except OSError as error:
        raise ValueError(f"a readable CSV file ({error.strerror or error})") from error
    return Push(*(values.copy() for values in _parsed(path, data)))


# Each condition and each variation of a scene reads its table. Equal bytes give an equal table.
@lru_cache(maxsize=4)
def _parsed(path: str, data: bytes) -> Push:
    try:
        table = instrument_table.read_table(path, data, _likeness)
    except SceneError as error:
        raise ValueError(f"{error.faults[0].expected} ({error.faults[0].given})") from error
    columns, wrong = _columns(path, table)
    travel, force = columns.get("travel"), columns.get("force")
    if travel is not None:
        if travel.size < 2:
            wrong.append("at least two points")
        elif travel[0] != 0.0:
            wrong.append(f"a travel that begins at 0 (it begins at {travel[0]:g} m)")
        if falls := np.flatnonzero(np.diff(travel) <= 0.0).tolist():
            wrong.append(f"a travel that rises from point to point (point {falls[0] + 2} does not)")
    if force is not None and (force < 0.0).any():
        wrong.append("forces that are not negative, because a pusher does not pull")
    if force is not None and force.size and not force[0] > 0.0:
        wrong.append("a force above 0 at zero travel, without which nothing starts")
    if wrong:
        raise ValueError("a table with " + ", ".join(wrong))
    assert travel is not None and force is not None
    return Push(travel, force)


def _likeness(cells: list[str]) -> float:
    """Share of the columns that a header has."""
    names = [name_and_unit(cell, si)[0] for cell in cells for si in _COLUMNS.values()]
    return sum(name in names for name in _COLUMNS) / len(_COLUMNS)


def _columns(path: str, table: Written) -> tuple[dict[str, np.ndarray], list[str]]:
    """Both columns (n,) in SI by name, without those that have a fault, and what is wrong with the
    table."""
    if not table.header and not table.rows:
        return {}, ["travel and force, each once in the header (no line)"]
    found, wrong = {}, []
    for name, si in _COLUMNS.items():
        places = table.places(name, si) if table.header else []
        if len(places) != 1:
            count = "twice" if places else "no such column"
            wrong.append(f"{name} once in the header ({count}; {table.shown()})")
            continue
        (values,), faults = table.numbers(path, places)
        wrong += [f"{fault.expected} ({fault.key}: {fault.given})" for fault in faults]
        if (unit := table.unit(places[0], si)) is None:
            wrong.append(f'the unit of the column {name}, such as "{si}"')
            continue
        try:
            factor = instrument_table.scale(unit, si)
        except ValueError as error:
            wrong.append(f"{error} ({name}: {unit!r})")
            continue
        if not faults:
            found[name] = values * factor
    width = len(table.header)
    wide = [number for number, row in table.rows if width and any(row[width:])]
    if wide:
        wrong.append(f"{width} cells in each line, as in the header (more in line {wide[0]})")
    return found, wrong
