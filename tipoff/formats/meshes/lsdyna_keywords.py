"""Text of an LS-DYNA keyword file as keywords with their lines, and the fields of a line.

Fields have fixed widths, or commas between them. In the long format (``*KEYWORD LONG=Y``, or a plus
behind one keyword) every field has 20 columns; with ``I10=Y``, or a percent sign, integers of nodes
and elements have 10 instead of 8. See chapter "Getting started" of the LS-DYNA Keyword User's Manual,
volume I.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from tipoff.formats.meshes.blocks import Unreadable, decoded, require_end
from tipoff.formats.meshes.lsdyna_includes import Piece

STANDARD, I10, LONG = "standard", "i10", "long"
_MARKS = {"+": LONG, "-": STANDARD, "%": I10}
_HEADER = re.compile(r"^\*\s*([A-Za-z0-9_\-/]*?)\s*([+%-]?)(?:\s.*)?$")
# Keywords that make or move nodes or elements in ways that are not read here.
_MAKERS = ("INCLUDE", "NODE_TRANSFORM", "ELEMENT_GENERATE")


class Keyword(NamedTuple):
    """A keyword with the lines below it."""

    name: str  # capitals, without the star
    form: str  # of its fields
    lines: list[tuple[int, str]]  # number and text of each
    line: int
    comments: list[str]  # without dollars, among its lines
    file: str = ""  # name of an included file

    def fields(self, text: str, widths: Sequence[int]) -> list[str]:
        """Fields of a line whose standard format has these ``widths``."""
        if "," in text:
            return [field.strip() for field in text.split(",")]
        if self.form == LONG:
            widths = [20] * len(widths)
        elif self.form == I10:
            widths = [10 if width == 8 else width for width in widths]
        text, start, found = text.expandtabs(8), 0, []
        for width in widths:
            found.append(text[start : start + width].strip())
            start += width
        return found


def keywords(pieces: Sequence[Piece]) -> Iterator[Keyword]:
    """The keywords of all pieces in their order. Raises Unreadable for data before the first keyword
    of a piece and for keywords that make or move nodes and elements."""
    forms: dict[Path, str] = {}
    form = STANDARD
    for piece in pieces:
        form = forms.setdefault(piece.path, form)  # at first that of the file that includes it
        file = "" if piece.path == pieces[0].path else piece.path.name
        with named(file):
            for keyword in _of_piece(piece, form):
                if keyword.name == "KEYWORD":
                    form = forms[piece.path] = keyword.form
                yield keyword._replace(file=file)


@contextmanager
def named(file: str) -> Iterator[None]:
    """Put the name of an included file in front of a fault in it."""
    try:
        yield
    except Unreadable as fault:
        raise Unreadable(f"{file}, {fault}" if file else str(fault)) from fault


def _of_piece(piece: Piece, form: str) -> Iterator[Keyword]:
    current: Keyword | None = None
    text = decoded(piece.content)
    for number, line in enumerate(text.splitlines(), start=piece.first):
        if line.startswith("$"):
            if current is not None:
                current.comments.append(line.strip("$# "))
            continue
        if not line.startswith("*"):
            if current is not None:
                current.lines.append((number, line.rstrip()))
            elif line.strip():
                raise Unreadable(f"line {number}: data before the first keyword")
            continue
        if current is not None:
            yield current
        found = _HEADER.match(line)
        if found is None:
            raise Unreadable(f"line {number}: {line[:40]!r} in place of a keyword")
        name = found[1].upper()
        if name == "END":
            return
        if name == "KEYWORD":
            given = line.upper().replace(" ", "")
            form = LONG if "LONG=Y" in given else I10 if "I10=Y" in given else STANDARD
        if name.startswith(_MAKERS):
            raise Unreadable(
                f"line {number}: *{name} is not read; write one file with all nodes and elements"
            )
        current = Keyword(name, _MARKS.get(found[2], form), [], number, [])
    require_end(text, ("*", "$"), piece.first)
    if current is not None:
        yield current
