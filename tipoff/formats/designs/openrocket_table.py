"""Tables that OpenRocket exports from a simulation: comma, semicolon or tab between the cells, names with
their units in a comment line, ``# Time (s),Mass (g),...``, and comment lines with events. The user
chooses columns and units there, so each unit is read.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tipoff.faults import SceneError
from tipoff.formats.instrument_table import Written, read_table, scale

COLUMNS = {
    "mass": ("Mass", "kg"),
    "mass_centre": ("CG location", "m"),
    "across": ("Longitudinal moment of inertia", "kg*m**2"),
    "along": ("Rotational moment of inertia", "kg*m**2"),
}
_CURVE = {"time": ("Time", "s"), "thrust": ("Thrust", "N")}


class Simulation(NamedTuple):
    """State at launch and thrust of a simulation, in SI; ``sources`` names the field of each value."""

    mass: float
    mass_centre: float  # behind the tip of the nose
    across: float  # kg m2
    along: float
    curve: tuple[tuple[float, float], ...]  # time and thrust
    sources: dict[str, str]


# in place of a refused table, so that a design is refused for its own faults only
REFUSED = Simulation(1.0, 1.0, 1.0, 1.0, (), {})


def sources(place: str, fields: dict[str, str], curve: str) -> dict[str, str]:
    """The field of each value: those of the state at a ``place``, and the ``curve``."""
    return {
        "payload.mass": f"{place}, {fields['mass']}",
        "payload.mass_centre": f"{place}, {fields['mass_centre']}",
        "payload.inertia": f"{place}, {fields['along']} and {fields['across']}",
        "thrust": curve,
    }


def read_simulation(data: bytes, file: str) -> Simulation:
    """The simulation in the bytes of a ``file``. Raises ValueError with every fault."""

    def likeness(cells: list[str]) -> float:
        table = Written(cells, [], [])
        return sum(len(table.places(*column)) == 1 for column in _ALL.values()) / len(_ALL)

    try:
        table = read_table(file, data, likeness)
    except SceneError as error:
        raise ValueError("; ".join(f"{f.expected} ({f.given})" for f in error.faults)) from error
    faults, factors, places = [], {}, {}
    for key, (name, si) in _ALL.items():
        found = table.places(name, si)
        if len(found) != 1:
            faults.append(f"the column {name} {'once' if found else ''}".strip())
            continue
        places[key] = found[0]
        unit = table.unit(found[0], si)
        try:
            factors[key] = scale(unit or "", si)
        except ValueError:
            faults.append(f"{name} in a unit of {si} (given {unit or 'none'})")
    if faults:
        raise ValueError(f"a table of OpenRocket with {'; '.join(faults)}; {table.shown()}")
    columns, wrong = table.numbers(file, places.values(), gaps=True)
    if wrong or not table.rows:
        words = [f"{fault.key}: {fault.expected} ({fault.given})" for fault in wrong]
        raise ValueError("; ".join(words) or "a table with lines of numbers")
    values = {key: column * factors[key] for key, column in zip(places, columns)}
    if faults := list(_unusable(values)):
        raise ValueError(f"a table of OpenRocket with {'; '.join(faults)}")
    names = {key: table.names()[place].lstrip("#%! ") for key, place in places.items()}
    line = f"{file}: line {table.rows[0][0]}"
    rows = np.column_stack([values["time"], values["thrust"]])
    return Simulation(
        **{key: float(values[key][0]) for key in COLUMNS},
        curve=tuple(map(tuple, rows[np.isfinite(rows).all(axis=1)].tolist())),
        sources=sources(line, names, f"{file}: {names['time']} and {names['thrust']}"),
    )


_ALL = COLUMNS | _CURVE


def _unusable(values: dict[str, np.ndarray]) -> Iterator[str]:
    """What the numbers lack."""
    for key, (name, _) in COLUMNS.items():
        if not values[key][0] > 0.0:
            yield f"{name} above zero in its first line (given {values[key][0]:g})"
    time = values["time"]
    if abs(time[0]) > 0.1:
        yield f"the launch in its first line (given {time[0]:g} s)"
    if not (np.diff(time[np.isfinite(time)]) >= 0.0).all():
        yield "times in increasing order"
    if not (values["thrust"] > 0.0).any():
        yield "a thrust above zero"
