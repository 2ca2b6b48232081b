"""The text files nodout and rbdout of LS-DYNA: motion of nodes and of rigid bodies, one block for each
time.

The layouts are those that the public translator of LSTC, ``l2a``, writes. Columns have the names of the
binary file. Rates are in global axes. Values are in the consistent units of the model, rates in rad per
unit of time.
"""

import io
import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tipoff.comparison.curve_files.table import SCENE, Table, chosen
from tipoff.scenes.faults import Fault, SceneError

NODOUT, RBDOUT = "nodout", "rbdout"
_XYZ = ("x", "y", "z")
_NODE = [
    f"{axis}_{name}"
    for name in ("displacement", "velocity", "acceleration", "coordinate")
    for axis in _XYZ
]
_NODE_TURN = [
    f"r{axis}_{name}" for name in ("displacement", "velocity", "acceleration") for axis in _XYZ
]


def _motion(kind: str, name: str) -> list[str]:
    """Columns of one line of a rigid body: three along, three about the axes."""
    return [f"{kind}_{turn}{name}{axis}" for turn in ("", "r") for axis in _XYZ]


_BODY_LINES = {
    "coordinates": ["global_x", "global_y", "global_z"],
    "displacements": _motion("global", "d"),
    "velocities": _motion("global", "v"),
    "accelerations": _motion("global", "a"),
}
_BODY = [column for columns in _BODY_LINES.values() for column in columns]
COLUMNS = {NODOUT: [*_NODE, *_NODE_TURN], RBDOUT: _BODY}
#: Default columns of the quantities of a curve.
DEFAULTS = {
    NODOUT: {
        "velocity_x": "x_velocity",
        "rate_x": "rx_velocity",
        "rate_y": "ry_velocity",
        "rate_z": "rz_velocity",
    },
    RBDOUT: {
        "velocity_x": "global_vx",
        "rate_x": "global_rvx",
        "rate_y": "global_rvy",
        "rate_z": "global_rvz",
    },
}
MARKS = {NODOUT: b"n o d a l   p r i n t   o u t", RBDOUT: b"r i g i d   b o d y   m o t i o n"}
_NODE_TIME = re.compile(r"n o d a l   p r i n t   o u t.*\( *at time *(\S+) *\)")
_BODY_TIME = re.compile(r"r i g i d   b o d y   m o t i o n.*time= *(\S+)")
_BODY_NUMBER = re.compile(r"\s*(nodal )?rigid body +(\d+)\s*$")
_SHORT_EXPONENT = re.compile(r"(?<=\d)(?=[+-]\d{3}$)")  # Fortran writes 1.0-100 for 1.0E-100
_MOST_STATES = 1_000_000


class _Block(NamedTuple):
    """Values of one node or body at one time."""

    time: float
    body: str
    columns: list[str]
    values: list[float]


def read(source: str, data: bytes, kind: str, body: str | None) -> Table:
    """The motion of one ``body`` in a file of a ``kind``. Raises SceneError."""
    text = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8", errors="replace")
    blocks = _nodes(source, text) if kind == NODOUT else _bodies(source, text)
    found: dict[str, dict[float, dict[str, float]]] = {}
    wanted = body and body.split()[-1]
    for block in blocks:
        states = found.setdefault(block.body, {})
        # numbers of all are collected, for a refusal, and values of one
        if (body is None and len(found) > 1) or wanted not in (None, block.body.split()[-1]):
            continue
        states.setdefault(block.time, {"time": block.time}).update(zip(block.columns, block.values))
        if len(states) > _MOST_STATES:
            raise SceneError([Fault(source, "file", "more times", f"{_MOST_STATES:,} at most")])
    states = found[chosen(source, body, list(found))]
    return table(source, kind, list(states.values()))


def table(source: str, kind: str, states: list[dict[str, float]]) -> Table:
    """The table of ``states``, each with values by column. The last one may lack values, if the run
    was stopped. Raises SceneError if another one does."""
    names = ["time", *(name for name in COLUMNS[kind] if states and name in states[0])]
    if len(states) > 1 and len(states[-1]) < len(states[0]):
        states = states[:-1]
    for state in states:
        if missing := [name for name in names if name not in state]:
            given = f"no {missing[0]} at time {state['time']:g}"
            raise SceneError([Fault(source, kind, given, "the same values at every time")])
    rows = np.array([[state[name] for name in names] for state in states])
    rows = rows.reshape(len(states), len(names))
    return Table(names, [None] * len(names), rows, DEFAULTS[kind], is_consistent=True, axes=SCENE)


def _nodes(source: str, text: Iterator[str] | io.TextIOWrapper) -> Iterator[_Block]:
    time, columns = None, None
    for number, line in enumerate(text, 1):
        if match := _NODE_TIME.search(line):
            time, columns = _number(source, number, match[1]), None
        elif line.lstrip().startswith("nodal point"):
            columns = _NODE_TURN if "x-rot" in line else _NODE
        elif time is not None and columns is not None and line.strip():
            node, *cells = line.split()
            values = [_number(source, number, cell) for cell in cells]
            if len(values) < len(columns) and not line.endswith("\n"):
                return  # the run was stopped in this line
            if not node.isdecimal() or len(values) != len(columns):
                given = f"{line.strip()[:40]!r} in line {number}"
                expected = f"a number of a node and {len(columns)} values"
                raise SceneError([Fault(source, NODOUT, given, expected)])
            yield _Block(time, node, columns, values)


def _bodies(source: str, text: Iterator[str] | io.TextIOWrapper) -> Iterator[_Block]:
    time, body, is_global = None, None, False
    for number, line in enumerate(text, 1):
        head, colon, rest = line.partition(":")
        if match := _BODY_TIME.search(line):
            time, body = _number(source, number, match[1]), None
        elif match := _BODY_NUMBER.match(line):
            body, is_global = f"{match[1] or ''}{match[2]}", True
        elif line.lstrip().startswith(("principal", "output in")):
            is_global = False
        elif colon and time is not None and body is not None and is_global:
            columns = _BODY_LINES.get(head.strip(), [])
            values = [_number(source, number, cell) for cell in rest.split()]
            if len(values) < len(columns) and not line.endswith("\n"):
                return  # the run was stopped in this line
            if len(values) != len(columns):
                given = f"{len(values)} values of {head.strip()[:40]!r} in line {number}"
                raise SceneError([Fault(source, RBDOUT, given, f"{len(columns)} values")])
            yield _Block(time, body, columns, values)


def _number(source: str, line: int, cell: str) -> float:
    try:
        return float(_SHORT_EXPONENT.sub("E", cell))
    except ValueError:
        given = f"{cell[:40]!r} in line {line}"
        raise SceneError([Fault(source, "file", given, "a number")]) from None
