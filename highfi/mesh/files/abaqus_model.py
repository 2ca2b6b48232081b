"""Contents of an Abaqus input file: bodies with nodes, elements, sets and surfaces."""

from typing import NamedTuple

ROOT = ""  # name of the body of lines outside all parts


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
