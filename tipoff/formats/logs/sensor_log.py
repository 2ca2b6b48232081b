"""The columns of a log in SI. Their names are given; their units are in the header of the log or
given too."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import read_input
from tipoff.formats.declared import Format
from tipoff.formats.instrument_table import PAGE, Written, read_table, scale, stated
from tipoff.units import to_si

SECTION = f"see {PAGE}, section Sensor logs"
_SI = {"time": "s", "rate": "rad/s", "acceleration": "m/s**2", "temperature": "K"}
_SHOWN = 300  # characters of a header in a message
_CLOCK = 1e6  # s: larger times count from the epoch of a clock


def read_sensor_log(
    path: Path, names: Mapping[str, tuple[str, ...]], units: Mapping[str, str | None]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Time (n,1) s, rate (n,3) rad/s, and, if they have ``names`` of columns, acceleration (n,3) m/s2 and
    temperature (n,1) K, with NaN in empty cells; notes. A time without a name is the only column that is
    named like one. ``units``: those that are given, None for others. Raises SceneError with every fault."""
    table = _table(path, names)
    source, faults, places = str(path), [], {}
    for group, wanted in names.items():
        if group == "time" and not wanted:
            places[group], wrong = _times(table, source)
        elif wanted:
            places[group], wrong = _places(table, source, wanted, _SI[group])
        else:
            continue
        faults += wrong
    lines = {}
    for group, found in places.items():
        lines[group], wrong = _units(table, source, group, (found, units[group]))
        faults += wrong
    columns, wrong = table.numbers(source, [k for found in places.values() for k in found], True)
    if faults + wrong:
        raise SceneError(faults + wrong)
    return _in_si(dict(zip(places, _split(columns, places))), lines)


def zero_and_one(unit: str, si: str, is_header: bool = False) -> tuple[float, float]:
    """Zero and one of a column in ``si``; a unit that is not in a header may have a number
    (``instrument_table.stated``). Raises ValueError."""
    if si != "K":
        return 0.0, scale(unit, si) if is_header else stated(unit, si)
    # degC has an offset
    return to_si(f"0 {unit}", si, absolute=True), to_si(f"1 {unit}", si, absolute=True)


def _table(path: Path, groups: Mapping[str, tuple[str, ...]]) -> Written:
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
    return read_table(path, data, likeness)


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
    si, key, (places, unit_given) = _SI[group], f"units.{group}", asked
    lines, faults = [], []
    given = None if unit_given is None else zero_and_one(unit_given, si)
    for place in places:
        name, unit = table.names()[place], table.unit(place, si)
        try:
            found = None if unit is None else zero_and_one(unit, si, True)
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
            faults.append(Fault(source, key, repr(unit_given), expected))
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
    first = raw["time"][:1, 0].sum()  # 0 without a sample
    if abs(first * second) > _CLOCK:
        raw["time"] = raw["time"] - first
        notes.append(f"times count from the first sample, {first * second:.6f} s of its clock")
    values = {}
    for group, found in raw.items():
        zero, one = np.array(lines[group]).T
        values[group] = zero + (one - zero) * found
    return values, notes


FORMATS = (
    Format(
        "table of text",
        read_sensor_log,
        [
            (
                "EuRoC, `#timestamp [ns],w_RS_S_x [rad s^-1],...`",
                '`rate = ["w_RS_S_x", ...]`, `acceleration = ["a_RS_S_x", ...]`',
                "in the header",
            ),
            (
                "Betaflight blackbox",
                '`time = "time"`, `rate = ["gyroADC[0]", ...]`, `acceleration = ["accSmooth[0]", ...]`',
                '`time = "us"`, `rate = "deg/s"`; counts of 1/2048 g are '
                '`acceleration = "0.00478840332 m/s**2"`',
            ),
            (
                "PX4, `ulog2csv`",
                '`time = "timestamp"`, `rate = ["gyro_rad[0]", ...]`, '
                '`acceleration = ["accelerometer_m_s2[0]", ...]`',
                '`time = "us"`, `rate = "rad/s"`, `acceleration = "m/s**2"`',
            ),
            (
                'phyphox and other apps, `"Time (s)","Gyroscope x (rad/s)",...`',
                '`rate = ["Gyroscope x", ...]`, `acceleration = ["Acceleration x", ...]`',
                "in the header",
            ),
        ],
        is_any_other=True,
    ),
)
