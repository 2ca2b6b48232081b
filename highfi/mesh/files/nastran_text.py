"""Cards of a Nastran bulk data file: fields of free, small and large format, with continuations.

A field has 8 columns, or 16 where the name of the card ends in a star; commas separate the fields
of a free line. A line that begins with a plus, a star or an empty field goes on with the card of the
line before. See chapter "Bulk data entries" of the MSC and NX Nastran quick reference guides.
"""

from collections.abc import Iterator
from typing import NamedTuple

from tipoff.highfi.mesh.files.tables import Unreadable


class Card(NamedTuple):
    """A card."""

    name: str
    fields: list[str]  # without those that only connect lines
    line: int  # its number
    comments: list[str]  # lines of comment in front of the card


def cards(text: str) -> Iterator[Card]:
    """Cards of the bulk data. Raises Unreadable for a continuation without a card."""
    lines = text.splitlines()
    begin = next(
        (place for place, line in enumerate(lines) if line.upper().split() == ["BEGIN", "BULK"]), -1
    )
    current: Card | None = None
    tail, comments = "", []
    for number, raw in enumerate(lines[begin + 1 :], start=begin + 2):
        if raw.lstrip().startswith("$"):
            comments.append(raw.strip())
            continue
        line = raw.split("$")[0].rstrip()
        if not line:
            continue
        if line.upper().startswith("ENDDATA"):
            break
        first, fields, last = _fields(line)
        if not first or first[0] in "+*":
            mark = first.lstrip("+*").strip()
            if current is None or (mark and tail and mark != tail):
                raise Unreadable(f"line {number}: it continues a card that is not before it")
            current.fields.extend(fields)
        else:
            if current is not None:
                yield current
            name = first.rstrip("*").strip().upper()
            if name == "INCLUDE" or name.startswith("INCLUDE "):
                raise Unreadable(f"line {number}: INCLUDE is not read; put all cards in the file")
            current, comments = Card(name, fields, number, comments), []
        tail = last.lstrip("+*").strip()
    if current is not None:
        yield current


def _fields(line: str) -> tuple[str, list[str], str]:
    """First field of a line, its data, and the mark that its continuation repeats. A line has eight
    data fields in small or free format, four in large format. A free line may have a whole card, whose
    tenth field is no mark then."""
    if "," in line:
        first, *rest = [field.strip() for field in line.split(",")]
        count = 4 if first.endswith("*") or first.startswith("*") else 8
        data, last = rest[:count], "".join(rest[count : count + 1])
        if len(rest) > count + 1 and last and last[0] not in "+*":
            data, last = rest, ""  # a whole card in one line
            count *= -(-len(rest) // count)
    else:
        line = line.expandtabs(8)
        first = line[:8].strip()
        width = 16 if first.startswith("*") or first.endswith("*") else 8
        data = [line[at : at + width].strip() for at in range(8, 72, width)]
        last, count = line[72:80].strip(), 64 // width
    return first, data + [""] * (count - len(data)), last
