"""Sets of grids and elements in bulk data files of Nastran and OptiStruct.

    SET 4 = 1 THRU 9, 12                  before BEGIN BULK: of grids or of elements, by its use
    SET1    4       1       THRU    9     in the bulk data: the same
    SET     4       GRID    LIST          OptiStruct; the numbers follow in the next lines

OptiStruct says of what a set is, the other two do not. So these are two groups each, ``set 4 of grids``
and ``set 4 of elements``. HyperMesh writes the name of a set in a comment: $HMSET 4 1 "mount".
"""

import re

import numpy as np

from tipoff.highfi.mesh.files.nastran_text import Card
from tipoff.highfi.mesh.files.tables import Unreadable, whole

GRIDS, ELEMENTS = "grids", "elements"
_CASE = re.compile(r"^\s*SET\s+(\d{1,9})\s*=\s*(.*)$", re.IGNORECASE)
_NAMED = re.compile(r'^\$HMSET\s+(\d{1,9})\s+\d+\s+"([^"]*)"', re.IGNORECASE)
_TYPES = {"GRID": GRIDS, "NODE": GRIDS, "ELEM": ELEMENTS}


class Sets:
    """Sets of a file by their names: their kind and the ends of ranges of numbers."""

    def __init__(self, text: str) -> None:
        self._found: dict[tuple[str, str], list[tuple[int, int]]] = {}
        self.left_out: dict[str, str] = {}  # sets that are not read, and why
        lines = text.splitlines()
        self._names = {found[1]: found[2].strip() for found in map(_NAMED.match, lines) if found}
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
        elif (kind := _TYPES.get(card.fields[1].upper())) and card.fields[2].upper() in (
            "",
            "LIST",
        ):
            words = [field for field in card.fields[3:] if field]
            self._add(self._names.get(number, f"set {number}"), kind, words, card.line)

    def _add_both(self, number: str, words: list[str], line: int) -> None:
        for kind in (GRIDS, ELEMENTS):
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

    def of(self, kind: str, labels: np.ndarray) -> dict[str, np.ndarray]:
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
