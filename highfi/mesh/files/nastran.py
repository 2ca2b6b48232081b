"""Meshes in bulk data files of Nastran and OptiStruct.

The format gives each element a property by its number, which is a group: ``property 2``. So are sets
(``nastran_sets``). Preprocessors write names of properties in comments:

    $HMNAME PROP 2"mount" 4                               HyperMesh
    $ANSA_NAME_COMMENT;2;PSHELL;mount;;NO;NO;NO;          ANSA
    $ Femap Property 2 : mount                            Femap
    $ Elements and Element Properties for region : mount  Patran, before the property's card
"""

import re

import meshio
import numpy as np

from tipoff.highfi.mesh.files.nastran_sets import ELEMENTS, GRIDS, Sets
from tipoff.highfi.mesh.files.nastran_systems import Systems
from tipoff.highfi.mesh.files.nastran_text import Card, cards
from tipoff.highfi.mesh.files.tables import Block, Unreadable, any_case, decoded, mesh, real, whole

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


def read(content: bytes) -> meshio.Mesh:
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
    sets, systems = Sets(text), Systems()
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
        for name, members in sets.of(ELEMENTS, block.labels).items():
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
        for name, members in sets.of(GRIDS, numbers).items()
    }
    return mesh(numbers, places, blocks, groups, grids, sets.left_out)


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
