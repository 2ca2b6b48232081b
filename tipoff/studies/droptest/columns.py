"""The columns of a log in SI. Their names are in the sheet; their units are in the header of the log
or in the sheet."""

from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import read_input
from tipoff.scenes import instrument_table
from tipoff.scenes.instrument_table import Written
from tipoff.studies.droptest.sampling import SECTION
from tipoff.studies.droptest.sheet import Sheet, line
from tipoff.workspace.words import counted

_SI = {"time": "s", "rate": "rad/s", "acceleration": "m/s**2", "temperature": "K"}
_FEWEST = 100  # samples
_SHOWN = 300  # characters of a header in a message
_CLOCK = 1e6  # s: larger times count from the epoch of a clock


def read(path: Path, sheet: Sheet) -> tuple[dict[str, np.ndarray], list[str]]:
    """Time (n,1) s, rate (n,3) rad/s, and, if the sheet has them, acceleration (n,3) m/s2 and
    temperature (n,1) K, with NaN in empty cells; notes. Raises SceneError with every fault."""
    names = sheet.columns
    groups: dict[str, tuple[str, ...]] = {
        "time": (names.time,) if names.time else (),
        "rate": names.rate,
        "acceleration": names.acceleration or (),
        "temperature": (names.temperature,) if names.temperature else (),
    }
    table = _table(path, groups)
    source, faults, places = str(path), [], {}
    for group, wanted in groups.items():
        if group == "time" and not wanted:
            places[group], wrong = _times(table, source)
        elif wanted:
            places[group], wrong = _places(table, source, wanted, _SI[group])
        else:
            continue
        faults += wrong
    lines = {}
    for group, found in places.items():
        stated = getattr(sheet.units, group)
        lines[group], wrong = _units(table, source, group, (found, stated))
        faults += wrong
    columns, wrong = table.numbers(source, [k for found in places.values() for k in found], True)
    if faults + wrong:
        raise SceneError(faults + wrong)
    if len(table.rows) < _FEWEST:
        given = counted(len(table.rows), "sample")
        raise SceneError([Fault(source, "file", given, f"at least {_FEWEST}")])
    return _in_si(dict(zip(places, _split(columns, places))), lines)


def _table(path: Path, groups: dict[str, tuple[str, ...]]) -> Written:
    """The header is the line that has most of the wanted columns."""
    wanted = [(name, _SI[group]) for group, names in groups.items() for name in names]

    def likeness(cells: list[str]) -> float:
        table = Written(cells, [], [])
        return sum(bool(table.places(*each)) for each in wanted)

    try:
        data = read_input(path)
    except OSError as error:
        given = error.strerror or str(error)
        raise SceneError([Fault(str(path), "file", given, "a readable CSV file")]) from error
    return instrument_table.read(path, data, likeness)


def _places(
    table: Written, source: str, wanted: tuple[str, ...], si: str
) -> tuple[list[int], list[Fault]]:
    found, faults = [], []
    for name in wanted:
        places = table.places(name, si) if table.header else []
        found += places[:1]
        if len(places) != 1:
            given = "twice" if places else "no such column"
            expected = f"once in the header, which has {_shown(table)}; {SECTION}"
            faults.append(Fault(source, name, given, expected))
    return found, faults


def _times(table: Written, source: str) -> tuple[list[int], list[Fault]]:
    """The only column that is named like a time."""
    found = table.times()
    if len(found) == 1:
        return found, []
    cells = " or ".join(table.header[place] for place in found) or "no name of a time"
    expected = f"the name of the time in the header, which has {_shown(table)}; {SECTION}"
    return found[:1], [Fault(source, "columns.time", cells, expected)]


def _shown(table: Written) -> str:
    text = ", ".join(filter(None, table.header)) or "nothing"
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]} ..."


def _units(
    table: Written, source: str, group: str, asked: tuple[list[int], str | None]
) -> tuple[list[tuple[float, float]], list[Fault]]:
    """Zero and one in SI of each column, from the header and the unit of the sheet."""
    si, key, (places, stated) = _SI[group], f"units.{group}", asked
    lines, faults = [], []
    given = None if stated is None else line(stated, si)
    for place in places:
        name, unit = table.names()[place], table.unit(place, si)
        try:
            found = None if unit is None else line(unit, si, True)
        except ValueError as error:
            found = None
            if given is None:
                faults.append(Fault(source, name, repr(unit), f"{error}, or {key}; {SECTION}"))
                continue
        if found is None and given is None:
            expected = (
                f'the unit of {name} in the header or in the sheet, such as "{si}"; {SECTION}'
            )
            faults.append(Fault(source, key, "no unit", expected))
        elif found is not None and given is not None and not np.allclose(found, given, 1e-9, 0.0):
            expected = f"the unit {unit!r} of {name} in the header; {SECTION}"
            faults.append(Fault(source, key, repr(stated), expected))
        else:
            lines.append(given or found or (0.0, 1.0))
    return lines, faults


def _split(columns: list[np.ndarray], places: dict[str, list[int]]) -> list[np.ndarray]:
    """The columns of each group side by side."""
    ends = np.cumsum([len(found) for found in places.values()])
    return [
        np.column_stack(columns[end - len(found) : end])
        for end, found in zip(ends.tolist(), places.values())
    ]


def _in_si(
    raw: dict[str, np.ndarray], lines: dict[str, list[tuple[float, float]]]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Values in SI. Times of a clock count from the first sample: they have too many digits."""
    notes, ((_, second),) = [], lines["time"]
    first = raw["time"][0, 0]
    if abs(first * second) > _CLOCK:
        raw["time"] = raw["time"] - first
        notes.append(f"times count from the first sample, {first * second:.6f} s of its clock")
    values = {}
    for group, found in raw.items():
        zero, one = np.array(lines[group]).T
        values[group] = zero + (one - zero) * found
    return values, notes
