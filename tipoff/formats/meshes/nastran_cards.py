"""Cards of a Nastran bulk data file: fields of free, small and large format, with continuations.

A field has 8 columns, or 16 where the name of the card ends in a star; commas or blanks separate the
fields of a free line. Fields of fixed width have no blank between their characters, which tells the two
apart. A line that begins with a plus, a star or an empty field goes on with the card of the line before.
See chapter "Bulk data entries" of the MSC and NX Nastran quick reference guides.
"""

import re
from collections.abc import Iterator
from typing import NamedTuple

from tipoff.formats.meshes.blocks import Unreadable, require_end

# A card with a number, which text before the bulk data, such as TITLE = rail 2, is not.
_FREE = re.compile(r"\s*[A-Za-z]\w*\*?\s+\d+(\s[^=]*)?$")
_GOES_ON = re.compile(r"[+*]|\s+\d")
_MARK = re.compile(r"[+*](?![.\d])")  # and no number with a sign


class Card(NamedTuple):
    """A card."""

    name: str
    fields: list[str]  # without those that only connect lines
    line: int  # its number
    comments: list[str]  # lines of comment in front of the card


def cards(text: str) -> Iterator[Card]:
    """Cards of the bulk data. Raises Unreadable for a continuation without a card and for a
    last card that may be cut."""
    lines = text.splitlines()
    begin = next(
        (place for place, line in enumerate(lines) if line.upper().split() == ["BEGIN", "BULK"]), -1
    )
    current: Card | None = None
    tail, comments, is_free = "", [], False
    for number, raw in enumerate(lines[begin + 1 :], start=begin + 2):
        if raw.lstrip().startswith("$"):
            comments.append(raw.strip())
            continue
        line = raw.split("$")[0].rstrip()
        if not line:
            continue
        if line.upper().startswith("ENDDATA"):
            break
        is_free = _is_free(line, is_free)
        first, fields, last = _between_blanks(line, number) if is_free else _fields(line)
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
    else:  # no ENDDATA
        require_end(text, ("$",))
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
        first, *data = _columns(line)
        last, count = line.expandtabs(8)[72:80].strip(), len(data)
    return first, data + [""] * (count - len(data)), last


def _columns(line: str) -> list[str]:
    """Name and data of a line with fields of fixed width."""
    line = line.expandtabs(8)
    first = line[:8].strip()
    width = 16 if first.startswith("*") or first.endswith("*") else 8
    return [first, *(line[at : at + width].strip() for at in range(8, 72, width))]


def _is_free(line: str, before: bool) -> bool:
    """Whether blanks separate the fields of a line; ``before``: those of the line before."""
    if "," in line:
        return False
    if _GOES_ON.match(line):  # a mark in a field of fixed width may have blanks
        return before
    return bool(_FREE.match(line)) and any(len(field.split()) > 1 for field in _columns(line))


def _between_blanks(line: str, number: int) -> tuple[str, list[str], str]:
    """Fields of a line as ``_fields`` returns them, separated by blanks. Raises Unreadable for a GRID
    that lacks a number: no blank stands for an empty field."""
    first, *data = line.split()
    if line[0].isspace() and first[0].isdigit():
        first, data = "", [first, *data]
    last = data.pop() if data and _MARK.match(data[-1]) else ""
    width = 4 if first.endswith("*") or first.startswith("*") else 8
    if first.upper().rstrip("*") == "GRID" and not last and len(data) < min(width, 5):
        raise Unreadable(
            f"line {number}: GRID with {len(data)} fields between blanks: its number, its system "
            "and three coordinates are expected; commas stand for empty fields"
        )
    return first, data + [""] * (-len(data) % width), last
