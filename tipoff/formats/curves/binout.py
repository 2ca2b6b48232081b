"""The branches rbdout and nodout of binout, the binary file of LS-DYNA (LSDA).

A header of at least 8 bytes: its length; the bytes of a length, an offset, a command and a type; 1 for
little-endian numbers, 0 for big-endian ones. Then records: length of the whole record, command, content.

=======  ==========================================================================
command  content
=======  ==========================================================================
2        path of the folder of the data that follow, absolute or relative
3        type, length of the name (1 byte), name, numbers
others   tables of symbols, which repeat the paths; not read
=======  ==========================================================================

A large file continues in ``binout0000%001`` and so on. A branch has the folder ``metadata`` with the
numbers ``ids`` of its nodes or bodies, and a folder ``d000001``, ``d000002`` ... for each time. Source:
the description of the LSTC I/O library, lsda-1.1.
"""

import glob
import io
import os
import posixpath
import re
import struct
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import open_input
from tipoff.formats.curves.nodout import NODOUT, RBDOUT, UNITS, table_of_states
from tipoff.formats.curves.record import Asked, CurveFile, CurveFormat, CurveTable, chosen_body

_HEADER = 8
_CD, _DATA = 2, 3
_SIZES = {1: "B", 2: "H", 4: "I", 8: "Q"}
_TYPES = {
    **{1: "i1", 2: "i2", 3: "i4", 4: "i8", 5: "u1", 6: "u2", 7: "u4", 8: "u8", 9: "f4", 10: "f8"}
}
_STATE = re.compile(r"/(nodout|rbdout)/(metadata|d\d{1,12})$")
_MOST_STATES = 1_000_000
_MOST_BODIES = 10_000_000
_LONGEST_PATH = 4096


class _Numbers(NamedTuple):
    """Numbers of a record: their file, their place in it, their type and number."""

    stream: io.BufferedReader
    place: int
    kind: np.dtype
    size: int


def is_one(head: bytes) -> bool:
    """Whether a file that begins with ``head`` is an LSDA file: no text has such a header."""
    return (
        len(head) >= _HEADER
        and 8 <= head[0] < 32
        and all(size in _SIZES for size in head[1:5])
        and head[5] in (0, 1)
    )


def parts(path: str | Path) -> list[Path]:
    """The file and its continuations ``binout0000%001``, ``binout0000%002`` ..."""
    path = Path(path)
    found = path.parent.glob(f"{glob.escape(path.name)}%[0-9]*")
    return [path, *sorted(found, key=lambda part: (len(part.name), part.name))]


def read_binout(file: CurveFile, asked: Asked) -> CurveTable:
    """The motion of one body or node. Raises SceneError, and OSError for a file that cannot be
    read."""
    source, body = file.source, asked.body
    with ExitStack() as opened:
        folders: dict[tuple[str, str], dict[str, _Numbers]] = {}
        for part in parts(file.path):
            stream = opened.enter_context(open_input(part))
            for branch, folder, name, numbers in _records(str(part), stream):
                folders.setdefault((branch, folder), {})[name] = numbers
            if len(folders) > _MOST_STATES:
                raise SceneError([Fault(source, "file", "more times", f"{_MOST_STATES:,} at most")])
        names: dict[str, tuple[str, int]] = {}
        for branch in (RBDOUT, NODOUT):
            for place, word in enumerate(_bodies(source, folders, branch)):
                names.setdefault(f"{branch} {word}", (branch, place))
        if not names:
            given = "no rbdout and no nodout"
            words = "one of them: *DATABASE_RBDOUT or *DATABASE_NODOUT in the model"
            raise SceneError([Fault(source, "file", given, words)])
        branch, place = names[chosen_body(source, body, list(names))]
        states = [
            _state(source, folders[branch, folder], list(UNITS[branch]), place)
            for folder in _in_order(folder for own, folder in folders if own == branch)
        ]
    return table_of_states(source, branch, states)


def _records(source: str, stream: io.BufferedReader) -> Iterator[tuple[str, str, str, _Numbers]]:
    """Branch, folder, name and numbers of each record of the wanted branches."""
    header = stream.read(_HEADER)
    if not is_one(header):
        raise SceneError([Fault(source, "file", "no header of LSDA", "a part of binout")])
    order = "<" if header[5] else ">"
    start = struct.Struct(f"{order}{_SIZES[header[1]]}{_SIZES[header[3]]}")
    types = header[4]
    place, end, folder = header[0], os.fstat(stream.fileno()).st_size, "/"
    while place < end:
        stream.seek(place)
        head = stream.read(start.size).ljust(start.size, b"\0")
        length, command = start.unpack(head)
        if length < start.size or place + length > end:
            given = f"a record of {length} bytes at byte {place} of {end}"
            raise SceneError([Fault(source, "file", given, "a whole binout")])
        if command == _CD:
            path = stream.read(min(length - start.size, _LONGEST_PATH)).decode("utf-8", "replace")
            folder = posixpath.normpath(posixpath.join(folder, path))
        elif command == _DATA and (found := _STATE.search(folder)):
            kind, name, first = _description(stream, order, types)
            size = length - start.size - first
            if kind is not None and size >= 0:
                count = size // kind.itemsize
                begin = place + start.size + first
                yield found[1], found[2], name, _Numbers(stream, begin, kind, count)
        place += length


def _description(
    stream: io.BufferedReader, order: str, types: int
) -> tuple[np.dtype | None, str, int]:
    """Type of the numbers, None for another kind of data, name, and bytes in front of them."""
    head = stream.read(types + 1)
    if len(head) <= types:
        return None, "", 0
    kind = _TYPES.get(int.from_bytes(head[:types], "little" if order == "<" else "big"))
    name = stream.read(head[types]).decode("utf-8", "replace")
    found = np.dtype(order + kind) if kind else None
    return found, name, types + 1 + head[types]


def _in_order(folders: Iterable[str]) -> list[str]:
    """The folders of the states; a number may have six or eight digits."""
    return sorted((name for name in folders if name != "metadata"), key=lambda name: int(name[1:]))


def _bodies(
    source: str,
    folders: dict[tuple[str, str], dict[str, _Numbers]],
    branch: str,
) -> list[str]:
    """The numbers of the nodes or bodies of a branch as text; "nodal 7" is a nodal rigid body."""
    about = folders.get((branch, "metadata"), {})
    if "ids" not in about:
        return []
    ids = about["ids"]
    if ids.size > _MOST_BODIES:
        raise SceneError(
            [Fault(source, branch, f"{ids.size} numbers", f"{_MOST_BODIES:,} at most")]
        )
    numbers = _values(ids, 0, ids.size).astype(int).tolist()
    nodal = int(_values(about["num_nodal"], 0, 1)[0]) if "num_nodal" in about else 0
    rigid = len(numbers) - nodal if branch == RBDOUT else len(numbers)
    return [f"{'nodal ' if place >= rigid else ''}{one}" for place, one in enumerate(numbers)]


def _state(
    source: str,
    folder: dict[str, _Numbers],
    columns: list[str],
    place: int,
) -> dict[str, float]:
    """The values of one body at one time by column."""
    if "time" not in folder:
        raise SceneError([Fault(source, "time", "a state without it", "the time of each state")])
    found = {"time": _values(folder["time"], 0, 1)}
    for name in columns:
        if name in folder:
            found[name] = _values(folder[name], place, 1)
    if short := [name for name, values in found.items() if not values.size]:
        raise SceneError([Fault(source, short[0], "no value", "one for each node or body")])
    return {name: float(values[0]) for name, values in found.items()}


def _values(numbers: _Numbers, first: int, count: int) -> np.ndarray:
    """``count`` numbers from the ``first`` on, fewer at the end of the record."""
    count = max(0, min(count, numbers.size - first))
    numbers.stream.seek(numbers.place + first * numbers.kind.itemsize)
    return np.frombuffer(numbers.stream.read(count * numbers.kind.itemsize), numbers.kind)


FORMATS = (
    CurveFormat(
        "binout of LS-DYNA",
        read_binout,
        [
            (
                "LS-DYNA `binout`, LSDA",
                "the branches `rbdout` and `nodout`, with the columns of these files",
                '`7`, or `"rbdout 7"`, `"nodout 1001"` if both have the number',
                '`--units "time=ms, length=mm"`',
                "scene",
            )
        ],
        begins=is_one,
        parts=parts,
    ),
)
