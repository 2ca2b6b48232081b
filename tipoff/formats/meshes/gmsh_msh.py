"""Meshes in gmsh's own formats, in text and in binary: 2, 4.0 and 4.1.

In format 4 an element belongs to an entity, and an entity to any number of physical groups. The
entities of a partitioned mesh have a section of their own. In format 2 an element is written once
for each group. See section "Gmsh file formats" of the manual of gmsh 4.15; for formats 2 and 4.0
"Legacy formats". A physical tag is negative if the entity is used in reverse. A group without a
name is called by its dimension and tag, "surface 3".
"""

import re

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import Block, MeshFormat, Unreadable, joined_mesh
from tipoff.formats.meshes.gmsh_sections import INT, REAL, Binary, Section, Text

# name in meshio, nodes and dimension of each element type
_TYPES = {
    1: ("line", 2, 1),
    2: ("triangle", 3, 2),
    3: ("quad", 4, 2),
    4: ("tetra", 4, 3),
    5: ("hexahedron", 8, 3),
    6: ("wedge", 6, 3),
    7: ("pyramid", 5, 3),
    8: ("line3", 3, 1),
    9: ("triangle6", 6, 2),
    10: ("quad9", 9, 2),
    11: ("tetra10", 10, 3),
    12: ("hexahedron27", 27, 3),
    13: ("wedge18", 18, 3),
    14: ("pyramid14", 14, 3),
    15: ("vertex", 1, 0),
    16: ("quad8", 8, 2),
    17: ("hexahedron20", 20, 3),
    18: ("wedge15", 15, 3),
    19: ("pyramid13", 13, 3),
    21: ("triangle10", 10, 2),
    26: ("line4", 4, 1),
    29: ("tetra20", 20, 3),
}
_TETRA10 = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # place of each node of VTK in the order of gmsh
_NAME = re.compile(rb'^\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*$')
_SIZES = {1, 2, 4, 8}  # bytes of a size_t
_PARAMETRIC = "ParametricNodes"
_DIMENSIONS = ("point", "curve", "surface", "volume")

Names = dict[tuple[int, int], str]  # of a dimension and a physical tag
Entities = dict[tuple[int, int], list[int]]  # physical tags of a dimension and an entity


class _File:
    """Sections of a file by their names."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        header = re.match(
            rb"(?:\xef\xbb\xbf)?\s*(?:\$Comments\b.*?\$EndComments\s+)?\$MeshFormat[ \t]*\r?\n"
            rb"\s*([\d.]+)\s+([01])\s+(\d+)[ \t]*\r?\n",
            content[: 2**16],
            re.DOTALL,
        )
        if header is None:
            start = content[:20].decode(errors="replace")
            raise Unreadable(f"a file of gmsh starts with $MeshFormat, this one with {start!r}")
        version = header[1].decode()
        self.version = {"4": "4.0", "4.0": "4.0", "4.1": "4.1"}.get(version, version)
        self.is_old = version.split(".")[0] == "2"
        if not (self.is_old or self.version in ("4.0", "4.1")):
            raise Unreadable(f"format {version} of gmsh; save it in format 4.1 or 2.2")
        self.is_text, self.size, self.order = header[2] == b"0", int(header[3]), "<"
        if self.size not in _SIZES:
            raise Unreadable(f"{self.size} bytes for a size; gmsh writes 8")
        if not self.is_text and self.version == "4.0":
            raise Unreadable("format 4.0 of gmsh in binary; save it in format 4.1")
        if not self.is_text:
            one = content[header.end() : header.end() + 4]
            orders = {(1).to_bytes(4, order): order for order in ("little", "big")}
            if one not in orders:
                raise Unreadable("the binary number 1 does not follow the header")
            self.order = "<" if orders[one] == "little" else ">"

    def find(self, name: str) -> bytes | None:
        """Content of a section, from the line after its name; None without the section."""
        found = re.search(
            rb"^[ \t]*\$" + name.encode() + rb"[ \t]*\r?\n", self.content, re.MULTILINE
        )
        if found is None:
            return None
        # A binary section ends where its counts say; in text, $ only begins a section name.
        end = self.content.find(b"$End" + name.encode(), found.end())
        if end < 0:
            raise Unreadable(f"${name} has no end")
        return self.content[found.end() : end if self.is_text else len(self.content)]

    def section(self, name: str) -> Section | None:
        """Numbers of a section; None without the section."""
        content = self.find(name)
        if content is None:
            return None
        if self.is_text:
            return Text(name, content.split())
        return Binary(name, memoryview(content), self.order, self.size)

    def needed(self, name: str) -> Section:
        """Numbers of a section. Raises Unreadable without the section."""
        found = self.section(name)
        if found is None:
            raise Unreadable(f"no ${name}")
        return found


def read_gmsh(content: bytes) -> meshio.Mesh:
    """The mesh in the ``content`` of a file. Raises Unreadable."""
    file = _File(content)
    names = _names(file)
    if file.is_old:
        labels, points = _old_nodes(file)
        blocks, tags = _old_elements(file)
        groups = _groups(
            blocks, names, [[(_TYPES_BY_NAME[b.kind], t)] for b, t in zip(blocks, tags)]
        )
        blocks, groups = _once(blocks, groups)
    else:
        entities = _entities(file)
        labels, points = _nodes(file)
        blocks, owners = _elements(file)
        groups = _groups(blocks, names, [_members(entities, owner) for owner in owners])
    return joined_mesh(labels, points, [_in_vtk_order(block) for block in blocks], groups)


_TYPES_BY_NAME = {name: dimension for name, _, dimension in _TYPES.values()}


def _names(file: _File) -> Names:
    found = re.search(
        rb"\$PhysicalNames[ \t]*\r?\n(.*?)\$EndPhysicalNames", file.content, re.DOTALL
    )
    names: Names = {}
    for line in (found[1] if found else b"").splitlines()[1:]:
        if (one := _NAME.match(line)) and one[3]:  # an empty name is none
            names[int(one[1]), abs(int(one[2]))] = one[3].decode("utf-8", "replace")
    return names


def _groups(
    blocks: list[Block], names: Names, members: list[list[tuple[int, int]]]
) -> dict[str, list[np.ndarray]]:
    """Members of each group in each block, from the dimension and the physical tags of every
    block; the tag 0 is that of no group."""
    nothing = np.array([], dtype=np.int64)
    groups: dict[str, list[np.ndarray]] = {}
    for place, (block, tags) in enumerate(zip(blocks, members)):
        for dimension, tag in tags:
            if tag == 0:
                continue
            name = names.get((dimension, abs(tag)), f"{_DIMENSIONS[dimension]} {abs(tag)}")
            parts = groups.setdefault(name, [nothing] * len(blocks))
            parts[place] = np.arange(len(block.nodes))
    return groups


def _members(entities: Entities, owner: tuple[int, int]) -> list[tuple[int, int]]:
    return [(owner[0], tag) for tag in entities.get(owner, [])]


def _in_vtk_order(block: Block) -> Block:
    return block._replace(nodes=block.nodes[:, _TETRA10]) if block.kind == "tetra10" else block


def _type(number: int) -> tuple[str, int, int]:
    if number not in _TYPES:
        raise Unreadable(f"elements of type {number} of gmsh; hexahedra are 5, tetrahedra 11")
    return _TYPES[number]


# --- format 2


def _old_nodes(file: _File) -> tuple[np.ndarray, np.ndarray]:
    section = file.section("Nodes")
    if section is None:
        return _parametric_nodes(file)
    count = _count_line(file, "Nodes", section)
    labels, points = section.rows(count, (INT, 1), (REAL, 3))
    return labels[:, 0], points


def _parametric_nodes(file: _File) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of ``-parametric``: behind its place, each has the dimension and the tag of its entity, and
    its coordinates on a curve or a surface."""
    section = file.section(_PARAMETRIC)
    if section is None:
        raise Unreadable("no $Nodes")
    labels, points = [], []
    for _ in range(_count_line(file, _PARAMETRIC, section)):
        labels.append(section.one())
        points.append(section.take(3, REAL))
        dimension, _ = section.take(2)
        section.take(int(dimension) if dimension in (1, 2) else 0, REAL)
    return np.array(labels, dtype=np.int64), np.array(points).reshape(-1, 3)


def _count_line(file: _File, name: str, section: Section) -> int:
    """The count at the start of a section of format 2; it is text in binary files too."""
    if isinstance(section, Text):
        return section.one()
    assert isinstance(section, Binary)
    content = file.find(name) or b""
    line = content.partition(b"\n")[0]
    if not line.strip().isdigit():
        raise Unreadable(f"${name} does not begin with a count")
    section.at = len(line) + 1
    return int(line)


def _old_elements(file: _File) -> tuple[list[Block], list[int]]:
    """Blocks with one type and one physical tag each, and the tags."""
    section = file.needed("Elements")
    left = _count_line(file, "Elements", section)
    found: dict[tuple[str, int], list[np.ndarray]] = {}
    while left > 0:
        if isinstance(section, Text):
            label, number = section.take(2)
            count, tags = 1, section.one()
        else:
            number, count, tags = section.take(3)
        kind, nodes, _ = _type(int(number))
        if not 0 < count <= left or tags < 0:
            raise Unreadable("$Elements has a block of another size than its count says")
        if isinstance(section, Text):
            row = np.concatenate([[label], section.take(int(tags) + nodes)])[None]
        else:
            (row,) = section.rows(int(count), (INT, 1 + int(tags) + nodes))
        physical = np.abs(row[:, 1]) if tags else np.zeros(len(row), dtype=np.int64)
        kept = np.delete(row, np.s_[1 : 1 + tags], axis=1)
        for tag in np.unique(physical):
            found.setdefault((kind, int(tag)), []).append(kept[physical == tag])
        left -= int(count)
    joined = {key: np.concatenate(rows) for key, rows in found.items()}
    blocks = [Block(kind, rows[:, 0], rows[:, 1:]) for (kind, _), rows in joined.items()]
    return blocks, [tag for _, tag in joined]


def _once(
    blocks: list[Block], groups: dict[str, list[np.ndarray]]
) -> tuple[list[Block], dict[str, list[np.ndarray]]]:
    """Blocks without repeated solid elements: format 2 writes an element once for each of its
    groups."""
    seen: set[tuple[int, ...]] = set()
    kept = []
    for place, block in enumerate(blocks):
        if _TYPES_BY_NAME[block.kind] < 3:
            kept.append(block)
            continue
        rows = [tuple(row) for row in np.sort(block.nodes, axis=1).tolist()]
        first = np.array([row not in seen for row in rows], dtype=bool)
        seen.update(rows)
        kept.append(block._replace(labels=block.labels[first], nodes=block.nodes[first]))
        number = np.cumsum(first) - 1
        for parts in groups.values():
            parts[place] = number[parts[place]][first[parts[place]]]
    return kept, groups


# --- formats 4


def _entities(file: _File) -> Entities:
    found: Entities = {}
    if (section := file.section("Entities")) is not None:
        _physical(file, section, found, is_part=False)
    if (section := file.section("PartitionedEntities")) is not None:
        section.one(_size(file))
        section.take(2 * section.one(_size(file)))  # ghost entities
        _physical(file, section, found, is_part=True)
    return found


def _size(file: _File) -> str:
    return "size" if not file.is_text else INT


def _physical(file: _File, section: Section, found: Entities, is_part: bool) -> None:
    size, counts = _size(file), section.counts(4, _size(file))
    for dimension, count in enumerate(counts):
        for _ in range(count):
            tag = section.one()
            if is_part:
                section.take(2)  # dimension and tag of the whole entity
                section.take(section.one(size))
            section.take(3 if dimension == 0 and file.version == "4.1" else 6, REAL)
            found[dimension, tag] = section.take(section.one(size)).tolist()
            if dimension:
                section.take(section.one(size))


def _nodes(file: _File) -> tuple[np.ndarray, np.ndarray]:
    section, size, is_first = file.needed("Nodes"), _size(file), file.version == "4.0"
    labels, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    count = section.counts(2 if is_first else 4, size)[0]
    for _ in range(count):
        dimension, entity, parametric = section.take(3)
        if is_first:
            dimension, entity = entity, dimension
        # parametric nodes have their coordinates on the entity after those in space
        place, number = (REAL, 3 + (int(dimension) if parametric else 0)), section.one(size)
        if is_first:
            label, found = section.rows(number, (INT, 1), place)
        else:
            label, found = section.take(number, size), section.rows(number, place)[0]
        labels.append(label.reshape(-1))
        points.append(found[:, :3])
    return np.concatenate(labels), np.concatenate(points)


def _elements(file: _File) -> tuple[list[Block], list[tuple[int, int]]]:
    """Blocks of elements, and the dimension and tag of the entity of each."""
    section, size, is_first = file.needed("Elements"), _size(file), file.version == "4.0"
    blocks, owners = [], []
    count = section.counts(2 if is_first else 4, size)[0]
    for _ in range(count):
        dimension, entity, number = section.take(3)
        if is_first:
            dimension, entity = entity, dimension
        kind, nodes, own = _type(int(number))
        if own != dimension:
            raise Unreadable(f"elements of {own} dimensions on an entity of {dimension}")
        (rows,) = section.rows(section.one(size), (INT if is_first else size, 1 + nodes))
        blocks.append(Block(kind, rows[:, 0], rows[:, 1:]))
        owners.append((int(dimension), int(entity)))
    return blocks, owners


FORMATS = (
    MeshFormat(
        "gmsh",
        read_gmsh,
        [
            (
                "gmsh `.msh` 2.2 and 4.1, text or binary; 4.0, text",
                "all elements",
                "physical groups; without a name `surface 3`, `volume 1`",
            )
        ],
        suffixes=(".msh",),
    ),
)
