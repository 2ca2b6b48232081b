"""Meshes in LS-DYNA keyword files: nodes, solids, shells, parts with their titles, and sets.

A surface is a ``*SET_SEGMENT``, a ``*SET_SHELL``, a part of shells or a ``*SET_NODE``. Its name is its
title, or the comment below its keyword. Solids with repeated nodes are tetrahedra, wedges and pyramids.
See ``*ELEMENT_SOLID``, ``*PART`` and ``*SET`` in the LS-DYNA Keyword User's Manual, volume I.
"""

from collections.abc import Iterator, Sequence

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import (
    Block,
    MeshFormat,
    Unreadable,
    any_case,
    is_surface,
    joined_mesh,
    real,
    whole,
)
from tipoff.formats.meshes.lsdyna_includes import SUFFIXES, Piece, pieces
from tipoff.formats.meshes.lsdyna_keywords import Keyword, keywords, named

_NODE, _ELEMENT, _OTHER = [8, 16, 16, 16], [8] * 10, [10] * 8
# lines of nodes below a line with the number and the part
_SOLIDS = {"": 1, "TET4TOTET10": 1, "H8TOH20": 1, "T10": 1, "H20": 2, "H27": 3}
_TYPES = {
    4: "tetra",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    20: "hexahedron20",
    27: "hexahedron27",
}
# which of eight nodes are left, by those that equal an earlier one
_REPEATED: dict[tuple[int, ...], str] = {
    (0, 1, 2, 3, 4, 5, 6, 7): "hexahedron",
    (0, 1, 2, 3, 3, 3, 3, 3): "tetra",
    (0, 1, 2, 3, 4, 4, 4, 4): "pyramid",
    (0, 1, 2, 3, 4, 4, 6, 6): "wedge",
}
_CARDS = {"THICKNESS": 1, "BETA": 1, "MCID": 1, "OFFSET": 1, "DOF": 1}  # below each shell
_SETS = ("NODE", "SEGMENT", "SHELL", "SOLID", "PART")
_LAYOUTS = {"", "LIST", "COLUMN", "GENERATE", "LIST_GENERATE", "COLLECT", "LIST_COLLECT"}


class _Model:
    """Contents of a file."""

    def __init__(self) -> None:
        self.labels: list[int] = []
        self.points: list[list[float]] = []
        # elements of a class (solid or shell), a type and a part: their numbers and nodes
        self.elements: dict[tuple[str, str, int], dict[int, list[int]]] = {}
        self.seen: dict[tuple[str, int], list[int]] = {}
        self.parts: dict[int, str] = {}
        self.titles: dict[tuple[str, int], str] = {}  # of sets
        self.sets: dict[tuple[str, int], list[tuple[int, ...]]] = {}
        self.sums: dict[tuple[str, int], tuple[int, list[int]]] = {}  # line, numbers of sets
        self.left_out: dict[str, str] = {}  # sets that are not read, and why

    def add(self, group: str, kind: str, line: int, numbers: list[int]) -> None:
        """Add an element: its number, its part and its nodes."""
        label, part, *nodes = numbers
        if self.seen.setdefault((group, label), nodes) != nodes:
            raise Unreadable(f"line {line}: a second element {label}")
        self.elements.setdefault((group, kind, part), {})[label] = nodes


def read_keyword_file(pieces: Sequence[Piece]) -> meshio.Mesh:
    """The mesh in the ``pieces`` of a file and its includes. Raises Unreadable."""
    model = _Model()
    for keyword in keywords(pieces):
        with named(keyword.file):
            _add(model, keyword)
    if not model.labels:
        raise Unreadable("no *NODE, which a keyword file of LS-DYNA has")
    return _mesh(model)


def _add(model: _Model, keyword: Keyword) -> None:
    name = keyword.name
    if name == "NODE":
        _nodes(model, keyword)
    elif name.startswith("ELEMENT_SOLID"):
        _solids(model, keyword)
    elif name.startswith("ELEMENT_SHELL"):
        _shells(model, keyword)
    elif name == "PART" or name.startswith("PART_"):
        _parts(model, keyword)
    elif name.startswith("SET_"):
        _set(model, keyword)


def _nodes(model: _Model, keyword: Keyword) -> None:
    for line, text in keyword.lines:
        if text:
            label, *places = keyword.fields(text, _NODE)[:4]
            model.labels.append(whole(label, line))
            model.points.append(([real(place, line) for place in places] + [0.0] * 3)[:3])


def _numbers(
    keyword: Keyword, text: str, line: int, widths: list[int], most: int | None = None
) -> list[int]:
    """Integers of the first ``most`` fields of a line, up to the last one that is not empty."""
    fields = keyword.fields(text, widths)[:most]
    while fields and not fields[-1]:
        fields.pop()
    return [whole(field or "0", line) for field in fields]


def _first(keyword: Keyword, text: str, line: int) -> int:
    """The number at the start of the card of a part or a set."""
    return whole(keyword.fields(text, _OTHER)[0], line)


def _solids(model: _Model, keyword: Keyword) -> None:
    option = keyword.name.removeprefix("ELEMENT_SOLID").lstrip("_")
    if option not in _SOLIDS:
        raise Unreadable(f"line {keyword.line}: *{keyword.name} is not read; write *ELEMENT_SOLID")
    lines = iter([(line, text) for line, text in keyword.lines if text])
    for line, text in lines:
        row = _numbers(keyword, text, line, _ELEMENT)
        more = _SOLIDS[option] if len(row) <= 2 else 0
        while more or text.endswith(","):  # a comma at the end of a free line continues it
            line, text = next(lines, (line, ""))
            if not text:
                raise Unreadable(f"line {line}: the last element lacks nodes")
            row += _numbers(keyword, text, line, _ELEMENT)
            more = max(0, more - 1)
        while len(row) > 2 and row[-1] == 0:
            row.pop()
        kind, nodes = _solid(row[2:], line)
        model.add("solid", kind, line, [*row[:2], *nodes])


def _solid(nodes: list[int], line: int) -> tuple[str, list[int]]:
    """Type and nodes of a solid."""
    if len(nodes) == 8:
        first = tuple(nodes.index(node) for node in nodes)
        kind = _REPEATED.get(first, "")
        if kind:
            return kind, [nodes[place] for place in dict.fromkeys(first)]
    elif len(nodes) in _TYPES and len(set(nodes)) == len(nodes):
        return _TYPES[len(nodes)], nodes
    raise Unreadable(
        f"line {line}: a solid with {len(nodes)} nodes, {len(set(nodes))} of them different; "
        f"{', '.join(map(str, _TYPES))} are expected"
    )


def _shells(model: _Model, keyword: Keyword) -> None:
    options = [each for each in keyword.name.removeprefix("ELEMENT_SHELL").split("_") if each]
    if unknown := [each for each in options if each not in _CARDS]:
        raise Unreadable(
            f"line {keyword.line}: *ELEMENT_SHELL with {unknown[0]} is not read; write *ELEMENT_SHELL"
        )
    # thickness, angle and system share one line
    below = len({each if each in ("OFFSET", "DOF") else "" for each in options})
    lines = [(line, text) for line, text in keyword.lines if text]
    for line, text in lines[:: 1 + below]:
        label, part, *nodes = (_numbers(keyword, text, line, _ELEMENT) + [0] * 6)[:6]
        kind, corners = _facet(nodes, line)
        model.add("shell", kind, line, [label, part, *corners])


def _facet(nodes: list[int], line: int) -> tuple[str, list[int]]:
    """Type and corners of a shell or a segment; a triangle repeats its third node or has no
    fourth."""
    corners = list(dict.fromkeys(node for node in nodes if node))
    if len(corners) not in (3, 4):
        raise Unreadable(
            f"line {line}: {len(corners)} different corners, where 3 or 4 are expected"
        )
    return ("triangle" if len(corners) == 3 else "quad"), corners


def _parts(model: _Model, keyword: Keyword) -> None:
    """A title and a line with the number; parts with options have further lines."""
    lines = keyword.lines if keyword.name == "PART" else keyword.lines[:2]
    for (_, title), (line, text) in zip(lines[::2], lines[1::2]):
        if text:
            model.parts[_first(keyword, text, line)] = title.strip()


def _set(model: _Model, keyword: Keyword) -> None:
    words = keyword.name.split("_")[1:]
    group, options = words[0], "_".join(word for word in words[1:] if word != "TITLE")
    if group not in _SETS:
        return
    lines, title = list(keyword.lines), ""
    if "TITLE" in words and lines:
        title = lines.pop(0)[1].strip()
    elif is_surface(any_case(comment := (keyword.comments or [""])[0])):
        title = comment  # as gmsh writes it
    lines = [(line, text) for line, text in lines if text]
    if not lines:
        raise Unreadable(f"line {keyword.line}: *{keyword.name} without a number")
    number = _first(keyword, lines[0][1], lines[0][0])
    if options not in (*_LAYOUTS, "ADD"):
        reason = f"line {keyword.line}: *{keyword.name} is not read"
        if is_surface(any_case(title)):
            raise Unreadable(f"{reason}; write '{title}' as a list")
        model.left_out[title or _untitled(group, number)] = f"{reason}; write the set as a list"
        return
    if options == "ADD":
        model.titles.setdefault((group, number), title)
        numbers = [_numbers(keyword, text, line, _OTHER, 8) for line, text in lines[1:]]
        _, every = model.sums.setdefault((group, number), (keyword.line, []))
        every += [each for row in numbers for each in row if each]
        return
    members = model.sets.setdefault((group, number), [])
    model.titles.setdefault((group, number), title)
    # attributes follow the corners of a segment, and the number in a column
    count = 4 if group == "SEGMENT" else 1 if options == "COLUMN" else 8
    for line, text in lines[1:]:
        members += _members(group, options, _numbers(keyword, text, line, _OTHER, count), line)


def _untitled(group: str, number: int) -> str:
    return f"{group.lower()} set {number}"


def _sum(model: _Model, key: tuple[str, int]) -> list[tuple[int, ...]]:
    """Members of the sets that a set adds up, each once. Raises Unreadable for a set that is not there or
    contains itself."""
    line, _ = model.sums[key]
    found: dict[tuple[int, ...], tuple[int, ...]] = {}
    left, seen = [key], set[tuple[str, int]]()
    while left:
        if (one := left.pop()) in seen:
            continue
        seen.add(one)
        for member in model.sets.get(
            one, []
        ):  # corners of a facet in any order, or the ends of a range
            found.setdefault(tuple(sorted(member)) if key[0] == "SEGMENT" else member, member)
        for number in model.sums.get(one, (0, []))[1]:
            other = (key[0], number)
            if other == key or (other not in model.sets and other not in model.sums):
                wrong = "contains itself" if other == key else "is not there as a list"
                raise Unreadable(f"line {line}: {_untitled(*other)} {wrong}")
            left.append(other)
    return list(found.values())


def _add_sums(model: _Model) -> None:
    sums: dict[tuple[str, int], list[tuple[int, ...]]] = {}
    for key in model.sums:
        try:
            sums[key] = _sum(model, key)
        except Unreadable as fault:
            title = model.titles[key]
            if is_surface(any_case(title)):
                raise
            model.left_out[title or _untitled(*key)] = str(fault)
    model.sets |= sums


def _members(group: str, options: str, row: list[int], line: int) -> Iterator[tuple[int, ...]]:
    """Members of a set in one line: corners of a facet, one number, or the ends of a range."""
    if group == "SEGMENT":
        yield tuple(_facet(row, line)[1])
    elif "GENERATE" in options:
        for first, last in zip(row[::2], row[1::2]):
            if last < first:
                raise Unreadable(f"line {line}: a range from {first} to {last}")
            if first:
                yield first, last
    else:
        yield from ((number,) for number in row if number)


def _mesh(model: _Model) -> meshio.Mesh:
    _add_sums(model)
    labels = np.array(model.labels, dtype=np.int64)
    blocks = [
        Block(kind, np.array(list(found), dtype=np.int64), np.array(list(found.values())))
        for (_, kind, _), found in model.elements.items()
    ]
    owners = [(group, part) for group, _, part in model.elements]
    chosen: dict[str, dict[int, np.ndarray]] = {}  # members of each group by block
    nodes: dict[str, np.ndarray] = {}

    def put(name: str, place: int, members: np.ndarray) -> None:
        parts = chosen.setdefault(any_case(name) or name, {})
        parts[place] = np.union1d(parts.get(place, members), members)

    for place, (_, part) in enumerate(owners):
        put(model.parts.get(part) or f"part {part}", place, np.arange(len(blocks[place].labels)))
    for (group, number), members in model.sets.items():
        name = model.titles[group, number] or _untitled(group, number)
        if group == "SEGMENT":
            for width, kind in ((3, "triangle"), (4, "quad")):
                if rows := [row for row in members if len(row) == width]:
                    blocks.append(Block(kind, np.arange(len(rows)), np.array(rows)))
                    owners.append(("segment", number))
                    put(name, len(blocks) - 1, np.arange(len(rows)))
            continue
        if group == "NODE":
            found = labels[_inside(labels, members)]
            nodes[any_case(name) or name] = np.union1d(
                nodes.get(any_case(name) or name, found), found
            )
        for place, (owner, part) in enumerate(owners):
            if owner == group.lower():
                put(name, place, np.flatnonzero(_inside(blocks[place].labels, members)))
            elif group == "PART" and owner != "segment" and _inside(np.array([part]), members):
                put(name, place, np.arange(len(blocks[place].labels)))
    nothing = np.array([], dtype=np.int64)
    groups = {
        name: [parts.get(place, nothing) for place in range(len(blocks))]
        for name, parts in chosen.items()
    }
    return joined_mesh(
        labels, np.array(model.points, dtype=float), blocks, groups, nodes, model.left_out
    )


def _inside(labels: np.ndarray, members: list[tuple[int, ...]]) -> np.ndarray:
    """Which ``labels`` (n,) are members of a set."""
    found = np.isin(labels, [row[0] for row in members if len(row) == 1])
    for first, last in (row for row in members if len(row) == 2):
        found |= (labels >= first) & (labels <= last)
    return found


FORMATS = (
    MeshFormat(
        "LS-DYNA",
        read_keyword_file,
        [
            (
                "LS-DYNA `.k`, `.key`, `.dyn`",
                "`*NODE`, `*ELEMENT_SOLID` in one line or two, `*ELEMENT_SHELL`, `*PART`; "
                "fixed, `I10=Y`, `LONG=Y` and free fields",
                "titles of `*SET_SEGMENT`, `*SET_NODE`, `*SET_SHELL`, `*SET_PART`, sums of "
                "them (`_ADD`) and `*PART`; without a title `segment set 3`, `node set 3`, "
                "`part 3`",
            )
        ],
        suffixes=SUFFIXES,
        pieces=pieces,
    ),
)
