"""Contents of an Abaqus input file, the members of its sets and surfaces, and the mesh with these groups."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.formats.meshes.blocks import Block, Unreadable, any_case, joined_mesh, shown

_SIDES = ("", "SPOS", "SNEG")  # of a shell
ROOT = ""  # name of the body of lines outside all parts
# Corners of the faces S1, S2, ... of solids, as places in the list of nodes of an element.
_OF_HEXAHEDRON = (
    "quad",
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]],
)
_OF_TETRAHEDRON = ("triangle", [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
FACES = {
    **dict.fromkeys(("hexahedron", "hexahedron20", "hexahedron27"), _OF_HEXAHEDRON),
    **dict.fromkeys(("tetra", "tetra10"), _OF_TETRAHEDRON),
}


class Reference(NamedTuple):
    """Members that a line adds to a set: elements or nodes by a range or a number, or another
    set."""

    scope: str  # name of the part or instance
    numbers: range  # empty for a set
    name: str  # of a set in capitals, empty for numbers
    line: int


class Body:
    """Nodes and elements of a part, of an instance, or of a file without parts."""

    def __init__(self, part: str = "") -> None:
        self.part = part  # name of the part of an instance
        self.labels: list[int] = []
        self.points: list[list[float]] = []
        # elements of one type: their numbers and nodes
        self.elements: dict[str, dict[int, tuple[int, ...]]] = {}
        self.others: set[int] = set()  # numbers of elements of lines and points
        self.sets: dict[str, list[Reference]] = {}
        self.node_sets: dict[str, list[Reference]] = {}
        self.surfaces: dict[str, list[tuple[Reference, str]]] = {}  # members and their faces

    def has(self, label: int) -> bool:
        """Whether an element has this number."""
        return label in self.others or any(label in found for found in self.elements.values())


class Model:
    """Bodies by the names under which they are read; names of sets as the file first writes
    them."""

    def __init__(self) -> None:
        self.bodies: dict[str, Body] = {ROOT: Body()}
        self.parts: dict[str, Body] = {}
        self.written: dict[str, str] = {}  # names of groups by their capitals
        self.left_out: dict[str, str] = {}  # groups that are not read as a whole, and why
        self.current, self.scope = self.bodies[ROOT], ROOT

    def named(self, name: str) -> str:
        """Name of a set in capitals."""
        self.written.setdefault(name.upper(), name)
        return name.upper()


class _Members:
    """Members of each set by the name of their body, found once for each set: ``what`` is element or
    node."""

    def __init__(self, model: Model, what: str) -> None:
        self._model, self._what = model, what
        self._found: dict[tuple[str, str], dict[str, set[int]] | None] = {}
        self._labels = {
            name: np.array(
                sorted(
                    {*body.others, *(one for found in body.elements.values() for one in found)}
                    if what == "element"
                    else set(body.labels)
                ),
                dtype=np.int64,
            )
            for name, body in model.bodies.items()
        }

    def sets(self, body: Body) -> dict[str, list[Reference]]:
        """The sets of a body."""
        return body.sets if self._what == "element" else body.node_sets

    def of_set(self, scope: str, name: str, line: int) -> dict[str, set[int]]:
        """Members of a set of a body. Raises Unreadable for an unknown set or member, and for a set
        that contains itself."""
        body = self._model.bodies.get(scope)
        what = self._what
        if body is None or name not in self.sets(body):
            raise Unreadable(f"line {line}: no {what} set {name} {f'in {scope}' * bool(scope)}")
        key = (scope, name)
        if key not in self._found:
            self._found[key] = None
            gathered: dict[str, set[int]] = {}
            for one in self.sets(body)[name]:
                for owner, labels in self.of_line(one).items():
                    gathered.setdefault(owner, set()).update(labels)
            self._found[key] = gathered
        found = self._found[key]
        if found is None:
            raise Unreadable(f"line {line}: {what} set {name} contains itself")
        return found

    def of_line(self, reference: Reference) -> dict[str, set[int]]:
        """Members that a line names; of a range, those that exist."""
        scope, numbers, name, line = reference
        if name:
            return self.of_set(scope, name, line)
        labels = self._labels.get(scope)
        if labels is None:
            raise Unreadable(f"line {line}: no instance {scope}")
        low, high = np.searchsorted(labels, [numbers.start, numbers.stop])
        there = {one for one in labels[low:high].tolist() if one in numbers}
        if len(numbers) == 1 and not there:
            raise Unreadable(f"line {line}: no {self._what} {numbers.start}")
        return {scope: there}


def gathered(model: Model) -> meshio.Mesh:
    """The mesh of a model, with all its named groups. Raises Unreadable; sets that are no surfaces
    are left out if they have faults."""
    blocks, owners = [], []
    labels, points = [], []
    shifts, shift = {}, 0
    for name, body in model.bodies.items():
        own = np.array(body.labels, dtype=np.int64)
        labels.append(own + shift)
        points.append(np.reshape(np.array(body.points, dtype=float), (-1, 3)))
        for kind, found in body.elements.items():
            nodes = np.array(list(found.values()), dtype=np.int64)
            if not len(nodes):
                continue
            if not (known := np.isin(nodes, own)).all():
                missing = np.unique(nodes[~known])
                raise Unreadable(f"no coordinates for nodes {shown(missing)}, which elements use")
            blocks.append(Block(kind, np.array(list(found), dtype=np.int64), nodes + shift))
            owners.append(name)
        # numbers of nodes belong to a body
        shifts[name] = shift
        shift += int(np.abs(own).max(initial=0)) + 1
        if shift >= 2**62:
            raise Unreadable("numbers of nodes that are too large")
    groups = _Groups(blocks, owners)
    _add_elements(model, groups)
    every, parts = groups.finished()
    node_groups = _node_groups(model, shifts)
    return joined_mesh(
        np.concatenate(labels), np.concatenate(points), every, parts, node_groups, model.left_out
    )


def _add_elements(model: Model, groups: "_Groups") -> None:
    """Sets and surfaces of elements, parts and instances."""
    members = _Members(model, "element")
    for scope, body in model.bodies.items():
        for name, given in body.sets.items():
            line = given[0].line if given else 0
            shown_name = groups.add(model.written[name])
            with _refused(model, name):
                groups.extend(shown_name, members.of_set(scope, name, line))
        for name, lines in body.surfaces.items():
            shown_name = groups.add(model.written[name])
            with _refused(model, name):
                for reference, face in lines:
                    found = members.of_line(reference)
                    groups.extend_by_faces(shown_name, found, face, reference.line)
        if body.part:
            whole = {scope: {one for found in body.elements.values() for one in found}}
            for name in {scope, body.part}:
                groups.extend(groups.add(name), whole)


def _node_groups(model: Model, shifts: dict[str, int]) -> dict[str, np.ndarray]:
    """Numbers of the nodes of each set, with the shift of their body."""
    members = _Members(model, "node")
    found: dict[str, set[int]] = {}
    for scope, body in model.bodies.items():
        for name, given in body.node_sets.items():
            with _refused(model, name):
                inside = members.of_set(scope, name, given[0].line if given else 0)
                group = found.setdefault(any_case(name) or model.written[name], set())
                for owner, nodes in inside.items():
                    group.update(node + shifts[owner] for node in nodes)
    return {name: np.array(sorted(nodes), dtype=np.int64) for name, nodes in found.items()}


@contextmanager
def _refused(model: Model, name: str) -> Iterator[None]:
    """Let faults of walls and mounts pass. Other groups are left out: a scene may still name them."""
    try:
        yield
    except Unreadable as fault:
        if any_case(name):
            raise
        model.left_out[model.written[name]] = str(fault)


class _Groups:
    """Members of groups in each block; faces of solids become blocks of their own."""

    def __init__(self, blocks: list[Block], owners: list[str]) -> None:
        self._blocks, self._owners = blocks, owners
        self._inside: dict[str, list[np.ndarray]] = {}
        self._faces: dict[str, dict[str, list[np.ndarray]]] = {}

    def add(self, written: str) -> str:
        """Name of a group in the form for the checks of rails."""
        name = any_case(written) or written
        self._inside.setdefault(
            name, [np.zeros(len(block.labels), dtype=bool) for block in self._blocks]
        )
        return name

    def extend(self, name: str, members: dict[str, set[int]], kinds: tuple[str, ...] = ()) -> None:
        """Add elements, of all types or of some, to a group."""
        for inside, block, owner in zip(self._inside[name], self._blocks, self._owners):
            if wanted := members.get(owner):
                if not kinds or block.kind in kinds:
                    inside |= np.isin(block.labels, np.array(sorted(wanted)))

    def extend_by_faces(
        self, name: str, members: dict[str, set[int]], face: str, line: int
    ) -> None:
        """Add a face of each element: a shell itself, or S1, S2, ... of a solid. Raises
        Unreadable for a face that an element does not have."""
        if face in _SIDES:
            self.extend(name, members)
        for block, owner in zip(self._blocks, self._owners):
            chosen = np.isin(block.labels, np.array(sorted(members.get(owner, ())), dtype=np.int64))
            if not chosen.any() or (face in _SIDES and block.kind not in FACES):
                continue
            kind, faces = FACES.get(block.kind, ("", []))
            number = int(face[1:]) if face[:1] == "S" and face[1:].isdigit() else 0
            if not 0 < number <= len(faces):
                raise Unreadable(
                    f"line {line}: face {face or 'of no name'} of {block.kind} elements; S1 to "
                    f"S{len(faces)} are read"
                )
            self._faces.setdefault(name, {}).setdefault(kind, []).append(
                block.nodes[chosen][:, faces[number - 1]]
            )

    def finished(self) -> tuple[list[Block], dict[str, list[np.ndarray]]]:
        """All blocks, and the places in them of the members of each group."""
        blocks = list(self._blocks)
        groups = {
            name: [np.flatnonzero(one) for one in inside] for name, inside in self._inside.items()
        }
        nothing = np.array([], dtype=np.int64)
        for name, kinds in self._faces.items():
            for kind, rows in kinds.items():
                _, first = np.unique(
                    np.sort(np.concatenate(rows), axis=1), axis=0, return_index=True
                )
                nodes = np.concatenate(rows)[np.sort(first)]
                blocks.append(Block(kind, np.arange(len(nodes)), nodes))
                for other, parts in groups.items():
                    parts.append(np.arange(len(nodes)) if other == name else nothing)
        return blocks, groups
