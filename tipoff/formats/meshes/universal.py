"""Meshes in universal files of I-deas, which Salome, NX, Femap and gmsh write (``.unv``).

| dataset | content |
|---|---|
| 2411, 781 | nodes: number, systems, colour; then three coordinates |
| 2412 | elements: number, descriptor, tables, colour, number of nodes; then nodes, eight in a line |
| 2467, 2477, 2452, 2435 | groups: numbers, the last of them the count; name; members of four integers |
| 2417, 2429, 2430, 2432 | groups with members of two integers |
| 2420 | coordinate systems: only those at the origin and along the axes |

Integers have ten columns. A member is a node (7) or an element (8). Elements of second order have the
middle nodes between the corners of their edges. See "Universal File Formats for Modal Analysis Testing" of
the University of Cincinnati.
"""

from collections.abc import Iterator

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import (
    Block,
    MeshFormat,
    Unreadable,
    any_case,
    decoded,
    joined_mesh,
    real,
    whole,
)

_NODES, _ELEMENTS, _SYSTEMS = ("2411", "781"), "2412", "2420"
# integers of each member of a group
_GROUPS = {
    **dict.fromkeys(("2467", "2477", "2452", "2435"), 4),
    **dict.fromkeys(("2417", "2429", "2430", "2432"), 2),
}
_NODE, _ELEMENT = 7, 8  # types of members
_BEAMS = {11, 21, 22, 23, 24}  # elements with a further line
# name in meshio and, of the nodes in a file, those in the order of VTK
_SOLIDS = {
    111: ("tetra", [0, 1, 2, 3]),
    112: ("wedge", list(range(6))),
    113: ("wedge15", list(range(15))),
    115: ("hexahedron", list(range(8))),
    116: (
        "hexahedron20",
        [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
    ),
    118: ("tetra10", [0, 2, 4, 9, 1, 3, 5, 6, 7, 8]),
}
# plane stress and strain, plates, membranes, solids of revolution, thin shells; by number of nodes
_SURFACES = {number for first in (41, 51, 61, 71, 81, 91) for number in range(first, first + 5)}
_CORNERS = {3: ("triangle", [0, 1, 2]), 4: ("quad", [0, 1, 2, 3])} | {
    6: ("triangle", [0, 2, 4]),
    8: ("quad", [0, 2, 4, 6]),
}

Lines = list[tuple[int, str]]  # number and text of each


def read_universal(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    labels: list[int] = []
    points: list[list[float]] = []
    elements: dict[str, dict[int, list[int]]] = {}
    groups: dict[str, dict[int, list[int]]] = {}
    for number, lines in _datasets(decoded(content)):
        if number in _NODES:
            _nodes(lines, labels, points)
        elif number == _ELEMENTS:
            _elements(lines, elements)
        elif number == _SYSTEMS:
            _systems(lines)
        elif number in _GROUPS:
            _groups(lines, _GROUPS[number], groups)
    if not labels:
        raise Unreadable("no dataset 2411 with nodes, which a universal file has")
    blocks = [
        Block(kind, np.array(list(found), dtype=np.int64), np.array(list(found.values())))
        for kind, found in elements.items()
    ]
    sets = {
        name: [np.flatnonzero(np.isin(block.labels, found[_ELEMENT])) for block in blocks]
        for name, found in groups.items()
    }
    nodes = {name: np.array(found[_NODE], dtype=np.int64) for name, found in groups.items()}
    numbers = np.array(labels, dtype=np.int64)
    return joined_mesh(numbers, np.array(points, dtype=float), blocks, sets, nodes)


def _datasets(text: str) -> Iterator[tuple[str, Lines]]:
    """Number and lines of each dataset, which stands between two lines of -1."""
    lines: Lines = []
    is_inside = False
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip() != "-1":
            if is_inside:
                lines.append((number, line))
            continue
        if is_inside and lines:
            yield lines[0][1].strip(), lines[1:]
        is_inside, lines = not is_inside, []
    if is_inside and lines:
        raise Unreadable(f"dataset {lines[0][1].strip()[:20]} has no end, a line of -1")


def _integers(line: int, text: str) -> list[int]:
    """Integers of ten columns; where they are written in others, those between blanks."""
    fields = [text[at : at + 10].strip() for at in range(0, len(text.rstrip()), 10)]
    if any(" " in field for field in fields):
        fields = text.split()
    return [whole(field, line) for field in fields]


def _record(lines: Iterator[tuple[int, str]], count: int, last: int) -> list[int]:
    """``count`` integers from the next lines. Raises Unreadable if there are fewer."""
    found: list[int] = []
    while len(found) < count:
        line, text = next(lines, (last, ""))
        if not text.strip():
            raise Unreadable(f"line {last}: {count} integers are expected behind it")
        found += _integers(line, text)
    return found[:count]


def _nodes(lines: Lines, labels: list[int], points: list[list[float]]) -> None:
    if len(lines) % 2:
        raise Unreadable(f"line {lines[-1][0]}: a node without coordinates")
    for (first, head), (second, text) in zip(lines[::2], lines[1::2]):
        places = [real(word, second) for word in text.split()]
        if len(places) != 3:
            raise Unreadable(f"line {second}: {len(places)} coordinates in place of 3")
        labels.append(_record(iter([(first, head)]), 1, first)[0])
        points.append(places)


def _elements(lines: Lines, elements: dict[str, dict[int, list[int]]]) -> None:
    rest = iter(lines)
    seen: dict[int, list[int]] = {}
    for line, text in rest:
        label, descriptor, *_, count = _record(iter([(line, text)]), 6, line)
        if not 0 < count < 100:
            raise Unreadable(f"line {line}: an element with {count} nodes")
        if descriptor in _BEAMS:
            next(rest, None)
        nodes = _record(rest, count, line)
        if descriptor in _SOLIDS:
            kind, order = _SOLIDS[descriptor]
        elif descriptor in _SURFACES and count in _CORNERS:
            kind, order = _CORNERS[count]
        elif descriptor in _SURFACES or 101 <= descriptor <= 118:
            raise Unreadable(
                f"line {line}: elements of descriptor {descriptor} with {count} nodes; solids are 111, "
                "115, 116 and 118"
            )
        else:
            continue
        if len(order) != count and descriptor in _SOLIDS:
            raise Unreadable(f"line {line}: {count} nodes in place of {len(order)}")
        if seen.setdefault(label, nodes) != nodes:
            raise Unreadable(f"line {line}: a second element {label}")
        elements.setdefault(kind, {})[label] = [nodes[place] for place in order]


def _systems(lines: Lines) -> None:
    """Raise Unreadable for a system that is turned, moved or not rectangular."""
    for place in range(2, len(lines), 6):
        line, text = lines[place]
        label, kind, *_ = _record(iter([(line, text)]), 2, line)
        rows = [
            [real(word, number) for word in text.split()]
            for number, text in lines[place + 2 : place + 6]
        ]
        if kind or rows != [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]:
            raise Unreadable(
                f"line {line}: coordinate system {label} is turned, moved or not rectangular; write all "
                "nodes in the global one"
            )


def _groups(lines: Lines, width: int, groups: dict[str, dict[int, list[int]]]) -> None:
    rest = iter(lines)
    for line, text in rest:
        *_, count = _record(iter([(line, text)]), 8, line)
        name = next(rest, (line, ""))[1].strip() or f"group {_integers(line, text)[0]}"
        if count < 0:
            raise Unreadable(f"line {line}: a group with {count} members")
        members = np.array(_record(rest, width * count, line), dtype=np.int64).reshape(-1, width)
        found = groups.setdefault(any_case(name) or name, {_NODE: [], _ELEMENT: []})
        for kind, numbers in found.items():
            numbers += members[members[:, 0] == kind, 1].tolist()


FORMATS = (
    MeshFormat(
        "I-deas",
        read_universal,
        [
            (
                "I-deas, Salome, NX `.unv`",
                "datasets 2411, 781, 2412, 2420",
                "groups 2467, 2477, 2452, 2435, 2432, 2430, 2429, 2417, of elements or nodes",
            )
        ],
        suffixes=(".unv",),
    ),
)
