"""Coordinate systems in bulk data files of Nastran: CORD2R, given by three points.

Point A is the origin, B lies on the axis z, and C in the plane x z, so

    z = (B - A) / |B - A|    y = z x (C - A) / |z x (C - A)|    x = y x z

(CORD2R in the MSC and NX Nastran quick reference guides). The points are in another system or in the
basic one, 0.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh.files.nastran_text import Card
from tipoff.highfi.mesh.files.tables import Unreadable, real, whole

_MOST = 50  # systems that are given in each other


class Frame(NamedTuple):
    """A rectangular system."""

    origin: np.ndarray  # (3,) in the basic system
    axes: np.ndarray  # (3,3) rows: unit vectors of x, y and z


class Systems:
    """The systems of a file by their numbers."""

    def __init__(self) -> None:
        self._cards: dict[int, Card] = {}
        self._frames = {0: Frame(np.zeros(3), np.eye(3))}

    def take(self, card: Card) -> None:
        """Keep the card of a system. Raises Unreadable without a number."""
        self._cards[whole(card.fields[0], card.line)] = card

    def frame(self, number: int, line: int, depth: int = 0) -> Frame:
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
        self._frames[number] = Frame(a, axes)
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
