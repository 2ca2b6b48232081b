"""The text files nodout and rbdout of LS-DYNA: motion of nodes and of rigid bodies, one block for each
time.

The layouts are those that the public translator of LSTC, ``l2a``, writes: numbers have twelve columns
and may fill them, so that nothing is between two. A last line without its end is left out where it
may be cut: a number without its exponent is another one. Columns have the names of the
binary file. Rates are in global axes. Values are in the consistent units of the model, rates in rad per
unit of time.
"""

import io
import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.formats.curves.record import (
    SCENE,
    Asked,
    CurveFile,
    CurveFormat,
    CurveTable,
    chosen_body,
)

NODOUT, RBDOUT = "nodout", "rbdout"
_XYZ = ("x", "y", "z")
_SPEED, _GAIN = "{length}/{time}", "{length}/{time}**2"
_RATE, _SPIN = "rad/{time}", "rad/{time}**2"
# Columns of each line in groups of three, with the pattern of their units.
_NODE = {"displacement": "{length}", "velocity": _SPEED, "acceleration": _GAIN}
_NODE |= {"coordinate": "{length}"}
_NODE_TURN = {"displacement": "rad", "velocity": _RATE, "acceleration": _SPIN}
_BODY = {
    "coordinates": {"": "{length}"},
    "displacements": {"d": "{length}", "rd": "rad"},
    "velocities": {"v": _SPEED, "rv": _RATE},
    "accelerations": {"a": _GAIN, "ra": _SPIN},
}


def _columns(groups: dict[str, str], pattern: str) -> dict[str, str]:
    """The unit of each column of some groups; the ``pattern`` makes the names."""
    return {
        pattern.format(axis=axis, name=name): unit for name, unit in groups.items() for axis in _XYZ
    }


_OF_NODE = _columns(_NODE, "{axis}_{name}")
_OF_NODE_TURN = _columns(_NODE_TURN, "r{axis}_{name}")
_OF_BODY = {line: _columns(groups, "global_{name}{axis}") for line, groups in _BODY.items()}
UNITS = {
    NODOUT: _OF_NODE | _OF_NODE_TURN,
    RBDOUT: {name: unit for line in _OF_BODY.values() for name, unit in line.items()},
}
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
_NODOUT_MARK, _RBDOUT_MARK = b"n o d a l   p r i n t   o u t", b"r i g i d   b o d y   m o t i o n"
_NODE_TIME = re.compile(r"n o d a l   p r i n t   o u t.*\( *at time *(\S+) *\)")
_BODY_TIME = re.compile(r"r i g i d   b o d y   m o t i o n.*time= *(\S+)")
_BODY_NUMBER = re.compile(r"\s*(nodal )?rigid body +(\d+)\s*$")
_SHORT_EXPONENT = re.compile(r"(?<=\d)(?=[+-]\d{3}$)")  # Fortran writes 1.0-100 for 1.0E-100
_MOST_STATES = 1_000_000
_WIDTH = 12  # columns of a number
WITHOUT_RATES = (
    "rotations, which nodes of solid elements do not have: write rbdout for a rigid body"
)


class _Block(NamedTuple):
    """Values of one node or body at one time."""

    time: float
    body: str
    columns: list[str]
    values: list[float]


def read_nodout(file: CurveFile, asked: Asked) -> CurveTable:
    """The motion of one node. Raises SceneError."""
    return _motion(file, NODOUT, asked.body)


def read_rbdout(file: CurveFile, asked: Asked) -> CurveTable:
    """The motion of one rigid body. Raises SceneError."""
    return _motion(file, RBDOUT, asked.body)


def _motion(file: CurveFile, kind: str, body: str | None) -> CurveTable:
    source = file.source
    text = io.TextIOWrapper(io.BytesIO(file.data), encoding="utf-8", errors="replace")
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
    states = found[chosen_body(source, body, list(found))]
    return table_of_states(source, kind, list(states.values()))


def table_of_states(source: str, kind: str, states: list[dict[str, float]]) -> CurveTable:
    """The table of ``states``, each with values by column. The last one may lack values, if the run
    was stopped. Raises SceneError if another one does."""
    names = [name for name in UNITS[kind] if states and name in states[0]]
    names = ["time", *names]
    if len(states) > 1 and len(states[-1]) < len(states[0]):
        states = states[:-1]
    for state in states:
        if missing := [name for name in names if name not in state]:
            given = f"no {missing[0]} at time {state['time']:g}"
            raise SceneError([Fault(source, kind, given, "the same values at every time")])
    rows = np.array([[state[name] for name in names] for state in states])
    rows = rows.reshape(len(states), len(names))
    units = ["{time}", *(UNITS[kind][name] for name in names[1:])]
    return CurveTable(names, units, rows, DEFAULTS[kind], is_consistent=True, axes=SCENE)


def _nodes(source: str, text: Iterator[str] | io.TextIOWrapper) -> Iterator[_Block]:
    time, columns, lengths = None, None, set[tuple[int, int]]()
    for number, line in enumerate(text, 1):
        if match := _NODE_TIME.search(line):
            time, columns = _number(source, number, match[1]), None
        elif line.lstrip().startswith("nodal point"):
            columns = list(_OF_NODE_TURN if "x-rot" in line else _OF_NODE)
        elif time is not None and columns is not None and line.strip():
            if _may_be_cut(line, len(columns), lengths):
                return
            node, cells = _fields(line, len(columns))
            values = [_number(source, number, cell) for cell in cells]
            if not node.isdecimal() or len(values) != len(columns):
                given = f"{line.strip()[:40]!r} in line {number}"
                expected = f"a number of a node and {len(columns)} values"
                raise SceneError([Fault(source, NODOUT, given, expected)])
            yield _Block(time, node, columns, values)


def _bodies(source: str, text: Iterator[str] | io.TextIOWrapper) -> Iterator[_Block]:
    time, body, is_global, lengths = None, None, False, set[tuple[int, int]]()
    for number, line in enumerate(text, 1):
        head, colon, rest = line.partition(":")
        if match := _BODY_TIME.search(line):
            time, body = _number(source, number, match[1]), None
        elif match := _BODY_NUMBER.match(line):
            body, is_global = f"{match[1] or ''}{match[2]}", True
        elif line.lstrip().startswith(("principal", "output in")):
            is_global = False
        elif colon and time is not None and body is not None and is_global:
            columns = list(_OF_BODY.get(head.strip(), ()))
            if _may_be_cut(line, len(columns), lengths):
                return
            other, cells = _fields(rest, len(columns))
            values = [_number(source, number, cell) for cell in (*other.split(), *cells)]
            if len(values) != len(columns):
                given = f"{len(values)} values of {head.strip()[:40]!r} in line {number}"
                raise SceneError([Fault(source, RBDOUT, given, f"{len(columns)} values")])
            yield _Block(time, body, columns, values)


def _may_be_cut(line: str, count: int, lengths: set[tuple[int, int]]) -> bool:
    """Whether a line of ``count`` numbers has no end, and another length than such lines before it; adds
    its length."""
    length = count, len(line.rstrip("\r\n"))
    if line.endswith("\n"):
        lengths.add(length)
        return False
    return length not in lengths


def _fields(line: str, count: int) -> tuple[str, list[str]]:
    """What is in front of the last ``count`` numbers of a line, and the numbers. They are between blanks,
    or fill their columns."""
    words, text = line.split(), line.rstrip("\r\n")
    at = len(text) - _WIDTH * count
    if at >= 0 and len(words) < count + bool(text[:at].strip()):
        return text[:at].strip(), [text[k : k + _WIDTH] for k in range(at, len(text), _WIDTH)]
    front = max(0, len(words) - count)
    return " ".join(words[:front]), words[front:]


def _number(source: str, line: int, cell: str) -> float:
    try:
        return float(_SHORT_EXPONENT.sub("E", cell.strip()))
    except ValueError:
        given = f"{cell[:40]!r} in line {line}"
        raise SceneError([Fault(source, "file", given, "a number")]) from None


FORMATS = (
    CurveFormat(
        "nodout of LS-DYNA",
        read_nodout,
        [
            (
                "LS-DYNA `nodout`, text",
                "`x_displacement`, `x_velocity`, `rx_velocity` ... of one node",
                "number of the node",
                '`--units "time=ms, length=mm"`',
                "scene",
            )
        ],
        is_in=lambda data: _NODOUT_MARK in data,
    ),
    CurveFormat(
        "rbdout of LS-DYNA",
        read_rbdout,
        [
            (
                "LS-DYNA `rbdout`, text",
                "`global_dx`, `global_vx`, `global_rvx` ... of one rigid body",
                "number of the body",
                '`--units "time=ms, length=mm"`',
                "scene",
            )
        ],
        is_in=lambda data: _RBDOUT_MARK in data,
    ),
)
