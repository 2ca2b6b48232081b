"""Meshes in bulk data files of Nastran and OptiStruct.

The format gives each element a property by its number, which is a group: ``property 2``. Preprocessors
write names of properties in comments:

    $HMNAME PROP 2"mount" 4                               HyperMesh
    $ANSA_NAME_COMMENT;2;PSHELL;mount;;NO;NO;NO;          ANSA
    $ Femap Property 2 : mount                            Femap
    $ Elements and Element Properties for region : mount  Patran, before the property's card

Sets are groups too:

    SET 4 = 1 THRU 9, 12                  before BEGIN BULK: of grids or of elements, by its use
    SET1    4       1       THRU    9     in the bulk data: the same
    SET     4       GRID    LIST          OptiStruct; the numbers follow in the next lines

OptiStruct says of what a set is, the other two do not. So these are two groups each, ``set 4 of grids``
and ``set 4 of elements``. HyperMesh writes the name of a set in a comment: $HMSET 4 1 "mount".
"""

import re
from typing import NamedTuple

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
from tipoff.formats.meshes.nastran_cards import Card, cards

# name in meshio by the number of nodes
_TYPES = {
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CPYRAM": {5: "pyramid", 13: "pyramid13"},
    "CQUAD4": {4: "quad"},
    "CQUADR": {4: "quad"},
    "CSHEAR": {4: "quad"},
    "CTRIA3": {3: "triangle"},
    "CTRIAR": {3: "triangle"},
    "CTRIA6": {6: "triangle6"},
    "CQUAD8": {8: "quad8"},
}
_PROPERTIES = ("PSHELL", "PSOLID", "PCOMP", "PCOMPG", "PLPLANE", "PSHEAR", "PLSOLID")
_NAMED = (
    re.compile(r'^\$HMNAME\s+PROP\s+(\d+)\s*"([^"]*)"', re.IGNORECASE),
    re.compile(r"^\$ANSA_NAME_COMMENT;(\d+);P\w+;([^;]*);", re.IGNORECASE),
    re.compile(r"^\$\s*Femap\b.*\bProperty\s+(\d+)\s*:\s*(.*)$", re.IGNORECASE),
)
_REGION = re.compile(r"^\$\s*Elements and Element Properties for region\s*:\s*(.*)$", re.IGNORECASE)
_GRIDS, _ELEMENTS = "grids", "elements"
_CASE = re.compile(r"^\s*SET\s+(\d{1,9})\s*=\s*(.*)$", re.IGNORECASE)
_NAMED_SET = re.compile(r'^\$HMSET\s+(\d{1,9})\s+\d+\s+"([^"]*)"', re.IGNORECASE)
_SET_TYPES = {"GRID": _GRIDS, "NODE": _GRIDS, "ELEM": _ELEMENTS}
_MOST = 50  # systems that are given in each other


def read_nastran(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    labels: list[int] = []
    points: list[list[float]] = []
    elements: dict[tuple[str, int], dict[int, list[int]]] = {}
    names: dict[int, str] = {}
    text = decoded(content)
    for line in text.splitlines():
        if line.startswith("$"):
            for found in (pattern.match(line) for pattern in _NAMED):
                if found:
                    names[int(found[1][:18])] = found[2].strip()
    seen: dict[int, tuple[str, list[int]]] = {}
    sets, systems = _Sets(text), _Systems()
    frames: list[tuple[str, int]] = []  # of each grid: number of its system, and its line
    usual = ""  # system of grids that give none
    for card in cards(text):
        if card.name == "GRID":
            labels.append(whole(card.fields[0], card.line))
            points.append(_place(card))
            frames.append((card.fields[1], card.line))
        elif card.name == "GRDSET":
            usual = card.fields[1]
        elif card.name.startswith(("CORD1", "CORD2", "CORD3")):
            systems.take(card)
        elif card.name in ("SET", "SET1"):
            sets.take(card)
        elif card.name in _TYPES:
            label, owner, kind, nodes = _element(card)
            if seen.setdefault(label, (kind, nodes)) != (kind, nodes):
                raise Unreadable(f"line {card.line}: a second element {label}")
            elements.setdefault((kind, owner), {})[label] = nodes
        elif card.name in _PROPERTIES:
            for found in map(_REGION.match, card.comments):
                if found:
                    names[whole(card.fields[0], card.line)] = found[1].strip()
    if not labels:
        raise Unreadable("no GRID, which a bulk data file of Nastran has")
    blocks = [
        Block(kind, np.array(list(found), dtype=np.int64), np.array(list(found.values())))
        for (kind, _), found in elements.items()
    ]
    nothing = np.array([], dtype=np.int64)
    groups: dict[str, list[np.ndarray]] = {}
    for place, (_, owner) in enumerate(elements):
        name = names.get(owner, f"property {owner}")
        parts = groups.setdefault(any_case(name) or name, [nothing] * len(blocks))
        parts[place] = np.arange(len(blocks[place].nodes))
    for place, block in enumerate(blocks):
        for name, members in sets.places(_ELEMENTS, block.labels).items():
            parts = groups.setdefault(any_case(name) or name, [nothing] * len(blocks))
            parts[place] = np.union1d(parts[place], members)
    numbers = np.array(labels, dtype=np.int64)
    owners = np.array(
        [whole(given or usual or "0", line) for given, line in frames], dtype=np.int64
    )
    places = systems.in_basic(
        np.array(points, dtype=float), owners, np.array([line for _, line in frames])
    )
    grids = {
        any_case(name) or name: numbers[members]
        for name, members in sets.places(_GRIDS, numbers).items()
    }
    return joined_mesh(numbers, places, blocks, groups, grids, sets.left_out)


def _place(card: Card) -> list[float]:
    if len(card.fields) < 5:
        raise Unreadable(f"line {card.line}: GRID with too few fields")
    return [real(field, card.line, is_short=True) for field in card.fields[2:5]]


def _element(card: Card) -> tuple[int, int, str, list[int]]:
    """Number, property, type and nodes of an element."""
    kinds = _TYPES[card.name]
    label = whole(card.fields[0], card.line)
    owner = whole(card.fields[1], card.line) if card.fields[1] else label
    most = card.fields[2 : 2 + max(kinds)]
    # A solid has middle nodes on all its edges or on none; further fields of a shell are no nodes.
    count = sum(bool(field) for field in most)
    if len(kinds) == 1:
        count = max(kinds)
    if count not in kinds or any(field == "" for field in most[:count]) or len(most) < count:
        raise Unreadable(
            f"line {card.line}: {card.name} with {count} nodes, where "
            f"{' or '.join(str(number) for number in kinds)} are expected"
        )
    return label, owner, kinds[count], [whole(field, card.line) for field in most[:count]]


class _Sets:
    """Sets of a file by their names: their kind and the ends of ranges of numbers."""

    def __init__(self, text: str) -> None:
        self._found: dict[tuple[str, str], list[tuple[int, int]]] = {}
        self.left_out: dict[str, str] = {}  # sets that are not read, and why
        lines = text.splitlines()
        self._names = {
            found[1]: found[2].strip() for found in map(_NAMED_SET.match, lines) if found
        }
        bulk = [
            number for number, line in enumerate(lines) if line.upper().split() == ["BEGIN", "BULK"]
        ]
        head = enumerate(lines[: bulk[0]] if bulk else [], start=1)
        for number, line in head:
            if found := _CASE.match(line.split("$")[0]):
                words = found[2]
                while words.rstrip().endswith(","):
                    words += next(head, (0, ""))[1].split("$")[0]
                self._add_both(found[1], words.replace(",", " ").split(), number)

    def take(self, card: Card) -> None:
        """Add the set of a card SET or SET1. Raises Unreadable."""
        number = str(whole(card.fields[0], card.line))
        if card.name == "SET1":
            self._add_both(number, [field for field in card.fields[1:] if field], card.line)
        elif (kind := _SET_TYPES.get(card.fields[1].upper())) and card.fields[2].upper() in (
            "",
            "LIST",
        ):
            words = [field for field in card.fields[3:] if field]
            self._add(self._names.get(number, f"set {number}"), kind, words, card.line)

    def _add_both(self, number: str, words: list[str], line: int) -> None:
        for kind in (_GRIDS, _ELEMENTS):
            self._add(self._names.get(number, f"set {number}") + f" of {kind}", kind, words, line)

    def _add(self, name: str, kind: str, words: list[str], line: int) -> None:
        words = [word.upper() for word in words]
        if unread := {"ALL", "EXCEPT", "SKIN"} & {*words}:
            reason = f"line {line}: a set with {min(unread)}; write its numbers"
            self.left_out[name] = reason
            return
        found = self._found.setdefault((name, kind), [])
        while words:
            first = whole(words.pop(0), line)
            last = first
            if words[:1] == ["THRU"]:
                if len(words) < 2:
                    raise Unreadable(f"line {line}: a set with THRU and no number behind it")
                last = whole(words[1], line)
                del words[:2]
            found.append((first, last))

    def places(self, kind: str, labels: np.ndarray) -> dict[str, np.ndarray]:
        """Places (m,) in some ``labels`` (n,) of the members of each set of a kind."""
        places = {}
        for (name, own), ranges in self._found.items():
            if own == kind:
                ends = np.array(ranges, dtype=np.int64).reshape(-1, 2)
                inside = np.isin(labels, ends[ends[:, 0] == ends[:, 1], 0])
                for first, last in ends[ends[:, 0] < ends[:, 1]].tolist():
                    inside |= (labels >= first) & (labels <= last)
                places[name] = np.flatnonzero(inside)
        return places


class _Frame(NamedTuple):
    """A rectangular system."""

    origin: np.ndarray  # (3,) in the basic system
    axes: np.ndarray  # (3,3) rows: unit vectors of x, y and z


class _Systems:
    """The coordinate systems of a file by their numbers: CORD2R, given by three points.

    Point A is the origin, B lies on the axis z, and C in the plane x z, so

        z = (B - A) / |B - A|    y = z x (C - A) / |z x (C - A)|    x = y x z

    (CORD2R in the MSC and NX Nastran quick reference guides). The points are in another system or in
    the basic one, 0.
    """

    def __init__(self) -> None:
        self._cards: dict[int, Card] = {}
        self._frames = {0: _Frame(np.zeros(3), np.eye(3))}

    def take(self, card: Card) -> None:
        """Keep the card of a system. Raises Unreadable without a number."""
        self._cards[whole(card.fields[0], card.line)] = card

    def frame(self, number: int, line: int, depth: int = 0) -> _Frame:
        """A system, which a card in ``line`` uses. Raises Unreadable."""
        if number in self._frames:
            return self._frames[number]
        card = self._cards.get(number)
        if card is None:
            raise Unreadable(f"line {line}: coordinates in system {number}, which the file lacks")
        if card.name != "CORD2R":
            raise Unreadable(
                f"line {line}: coordinates in system {number}, a {card.name}; write them in the basic "
                "system, 0, or in a CORD2R"
            )
        if depth > _MOST:
            raise Unreadable(f"line {card.line}: system {number} is given in itself")
        fields = card.fields + [""] * 11
        other = self.frame(whole(fields[1] or "0", card.line), card.line, depth + 1)
        given = [real(field, card.line, is_short=True) for field in fields[2:11]]
        a, b, c = other.origin + np.reshape(given, (3, 3)) @ other.axes
        with np.errstate(all="ignore"):
            z = (b - a) / np.linalg.norm(b - a)
            y = np.cross(z, c - a)
            y = y / np.linalg.norm(y)
        axes = np.stack([np.cross(y, z), y, z])
        if not np.isfinite(axes).all():
            raise Unreadable(f"line {card.line}: three points of CORD2R {number} on one line")
        self._frames[number] = _Frame(a, axes)
        return self._frames[number]

    def in_basic(self, points: np.ndarray, numbers: np.ndarray, lines: np.ndarray) -> np.ndarray:
        """Points (n,3) in the basic system, from the numbers (n,) of their systems and their lines
        (n,). Raises Unreadable for a system that is not rectangular."""
        points = points.copy()
        for number in np.unique(numbers).tolist():
            inside = numbers == number
            origin, axes = self.frame(number, int(lines[inside][0]))
            if number:
                points[inside] = origin + points[inside] @ axes
        return points


FORMATS = (
    MeshFormat(
        "Nastran",
        read_nastran,
        [
            (
                "Nastran, OptiStruct `.bdf`, `.nas`, `.fem`, `.dat`",
                "`GRID`, `CHEXA`, `CTETRA`, shells; small, large and free fields, the latter "
                "between commas or blanks; `CORD2R`",
                "properties: names that HyperMesh, ANSA, Femap or Patran write in comments, "
                "else `property 2`; sets: `set 4 of grids`, `set 4 of elements`",
            )
        ],
        suffixes=(".bdf", ".nas", ".fem", ".dat"),
    ),
)
