"""Shared by the readers of all formats: their declaration, their fault, numbers of nodes converted to
places in a list, and a mesh made of blocks of elements with named groups."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import meshio
import numpy as np

from tipoff.formats.declared import Format
from tipoff.formats.meshes.lsdyna_includes import Piece

LEFT_OUT = "left out"  # key of the reasons, by the name of a group, in the info of a mesh
_LISTED = 5  # numbers in one message


class Unreadable(ValueError):
    """A file that is not valid in its format, or has contents that are not read here; the message
    gives the place and the remedy."""


@dataclass(frozen=True)
class MeshFormat(Format):
    """A format of meshes: ``read`` makes a ``meshio.Mesh`` from the content of a file, in UTF-8 if it is
    a text. Its ``cell_sets`` has every group of elements and ``point_sets`` every group of nodes. It
    raises Unreadable."""

    # the pieces of a file that includes others; ``read`` gets them in place of the content
    pieces: Callable[[Path], list[Piece]] | None = None


_EXPONENT = re.compile(r"^([-+]?[\d.]+)([-+]\d+)$")  # 7.0-1 for 7.0E-1


def decoded(content: bytes) -> str:
    """Text of a file in UTF-8, with or without a byte order mark."""
    return content.decode("utf-8-sig", "replace")


def require_end(text: str, marks: tuple[str, ...], first: int = 1) -> None:
    """Raise Unreadable if the last line of a ``text`` has no end, because its last number may be cut. Lines
    that begin with one of the ``marks`` are no data; ``first`` is the number of the first line."""
    last = text[text.rfind("\n") + 1 :]
    if last.strip() and not last.startswith(marks):
        raise Unreadable(
            f"line {first + text.count(chr(10))}: the last line has no end, so its last number may be cut; "
            "end the line if the file is whole"
        )


def whole(text: str, line: int) -> int:
    """The integer in a field. Raises Unreadable."""
    try:
        value = int(text)
    except ValueError as fault:
        raise Unreadable(f"line {line}: {text[:40]!r} in place of an integer") from fault
    if abs(value) >= 2**62:
        raise Unreadable(f"line {line}: {text[:40]} is too large")
    return value


def real(text: str, line: int, is_short: bool = False) -> float:
    """The number in a field, zero in an empty one. The exponent may have a D instead of the E, and
    with ``is_short`` no letter. Raises Unreadable."""
    if not text:
        return 0.0
    plain = text.upper().replace("D", "E")
    if is_short and (found := _EXPONENT.match(plain)):
        plain = f"{found[1]}E{found[2]}"
    try:
        return float(plain)
    except ValueError as fault:
        raise Unreadable(f"line {line}: {text[:40]!r} in place of a number") from fault


class Block(NamedTuple):
    """Elements of one type."""

    kind: str  # name of the type in meshio
    labels: np.ndarray  # (e,) numbers of the elements in the file
    nodes: np.ndarray  # (e,k) numbers of their nodes in the file


def is_surface(name: str) -> bool:
    """Whether a group is a wall or the clamped surface of a rail."""
    return name.startswith("contact") or name == "mount"


def any_case(name: str) -> str:
    """Name of a surface in a format that ignores case; empty for other groups."""
    lower = name.lower()
    return lower if is_surface(lower) else ""


def shown(numbers: Iterable) -> str:
    """The first of some numbers of a file, and how many more there are."""
    every = list(numbers)
    text = ", ".join(str(number) for number in every[:_LISTED])
    return text if len(every) <= _LISTED else f"{text} and {len(every) - _LISTED} more"


def joined_mesh(
    labels: np.ndarray,
    points: np.ndarray,
    blocks: Sequence[Block],
    groups: dict[str, list[np.ndarray]],
    nodes: Mapping[str, np.ndarray] = MappingProxyType({}),
    left_out: Mapping[str, str] = MappingProxyType({}),
) -> meshio.Mesh:
    """Mesh of nodes with numbers ``labels`` (n,) at ``points`` (n,3), and of ``blocks``; ``groups``
    has, for each name, the places of its members in each block, ``nodes`` the numbers of the nodes
    of further groups, ``left_out`` the reason why a group is not read, or not all of it.

    Raises Unreadable for nodes with two places or without one.
    """
    order = np.argsort(labels, kind="stable")
    ordered = labels[order]
    again = np.flatnonzero(ordered[1:] == ordered[:-1])
    differ = (points[order[again]] != points[order[again + 1]]).any(axis=1)
    if differ.any():
        raise Unreadable(f"two places for nodes {shown(ordered[again[differ]])}")
    cells = []
    for block in blocks:
        place = np.searchsorted(ordered, block.nodes)
        known = place < len(ordered)
        known[known] = ordered[place[known]] == block.nodes[known]
        if not known.all():
            missing = np.unique(block.nodes[~known])
            raise Unreadable(f"no coordinates for nodes {shown(missing)}, which elements use")
        cells.append((block.kind, order[place]))
    sets = {name: np.flatnonzero(np.isin(labels, members)) for name, members in nodes.items()}
    return meshio.Mesh(points, cells, cell_sets=groups, point_sets=sets, info={LEFT_OUT: left_out})
