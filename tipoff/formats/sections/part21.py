"""Instances in a STEP file: the text of ISO 10303-21, without the meaning of any entity.

An instance is ``#12 = NAME(...);``, or ``#12 = (NAME(...) NAME(...));`` if it is of several types at once.
The text of an instance is read when it is asked for.

Source: ISO 10303-21:2016, clear text encoding of the exchange structure.
"""

import math
import re
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from tipoff.files import read_input

_COMMENT = re.compile(r"('[^']*+')|/\*(?:[^*]++|\*(?!/))*+(?:\*/|\Z)")
_STATEMENT = re.compile(r"\s*+((?:[^';]++|'[^']*+')*+);")
_INSTANCE = re.compile(r"#(\d{1,18})\s*+=\s*+")
_TOKEN = re.compile(
    r"\s*+(?:(?P<text>'(?:[^']|'')*+')|(?P<reference>#\d{1,18})|(?P<mark>[(),*$])"
    r"|(?P<number>[-+]?\d[\d.]*+(?:[Ee][-+]?\d++)?+)|(?P<word>\.?[A-Za-z_][\w-]*+\.?)|\"[^\"]*+\")"
)
_DEEPEST = 50  # brackets within brackets
_MOST_INSTANCES = 500_000


class Reference(int):
    """Number of another instance."""


class Typed(NamedTuple):
    """A value with its type, such as LENGTH_MEASURE(25.4)."""

    name: str
    values: list


class Instances:
    """All instances of a file, by their number."""

    def __init__(self, path: str | Path):
        """Raises OSError for a file that cannot be read, ValueError for one that is not STEP."""
        content = read_input(path).decode("latin-1")
        if not content.lstrip("\ufeff\xef\xbb\xbf \r\n\t").startswith("ISO-10303-21"):
            raise ValueError("a STEP file, which begins with ISO-10303-21")
        if "END-ISO-10303-21" not in content:
            raise ValueError("a whole STEP file; the end, END-ISO-10303-21, is missing")
        if "/*" in content:
            content = _COMMENT.sub(lambda found: found[1] or " ", content)
        self._texts = dict(_instances(content))
        if len(self._texts) > _MOST_INSTANCES:
            raise ValueError(f"at most {_MOST_INSTANCES:,} instances, not {len(self._texts):,}")
        self._read: dict[int, dict[str, list]] = {}

    @cached_property
    def _names(self) -> dict[int, list[str]]:
        return {
            number: re.findall(r"[A-Z_0-9]+(?=\s*\()", text.upper())
            for number, text in self._texts.items()
        }

    def instance(self, number: Any) -> dict[str, list]:
        """Names of an instance, each with its values. Raises ValueError if it is none."""
        if not isinstance(number, Reference) or number not in self._texts:
            raise ValueError(f"a whole STEP file; {_shown(number)} is no instance of it")
        if number not in self._read:
            self._read[number] = _instance(number, self._texts[number])
        return self._read[number]

    def named(self, *names: str) -> Iterator[tuple[Reference, list]]:
        """Number and values of each instance with one of the ``names``, in the order of the file."""
        for number, found in self._names.items():
            if name := next((name for name in names if name in found), None):
                values = self.instance(Reference(number)).get(name)
                if values is not None:
                    yield Reference(number), values


def _instances(content: str) -> Iterator[tuple[int, str]]:
    """Number and text of each instance. What has no end is left out: another one refers to it, or none
    does."""
    place = 0
    while statement := _STATEMENT.match(content, place):
        place = statement.end()
        if begin := _INSTANCE.match(statement[1]):
            yield int(begin[1]), statement[1][begin.end() :]


def value(values: list, place: int, kind: type) -> Any:
    """The value at a ``place``. Raises ValueError if it is not of this ``kind``: Reference, list, str,
    or float, which must be finite."""
    found = values[place] if place < len(values) else None
    if isinstance(found, Typed):
        found = found.values[0] if len(found.values) == 1 else None
    if not isinstance(found, kind) or (isinstance(found, float) and not math.isfinite(found)):
        raise ValueError(f"a whole STEP file; {_shown(found)} stands where another value belongs")
    return found


def _shown(found: Any) -> str:
    if isinstance(found, Reference):
        return f"#{found:d}"
    return "nothing" if found is None else repr(found)[:40]


def _instance(number: int, text: str) -> dict[str, list]:
    values = _values(number, text)
    if len(values) == 1 and isinstance(values[0], list):
        values = values[0]
    return {each.name: each.values for each in values if isinstance(each, Typed)}


def _values(number: int, text: str) -> list:
    """The values of an instance; a word before a bracket is the name of what is in the bracket."""
    every: list = []
    open_lists, names = [every], list[str | None]()
    place, text = 0, text.rstrip()
    while place < len(text):
        token = _TOKEN.match(text, place)
        if token is None or len(open_lists) > _DEEPEST:
            raise ValueError(f"a whole STEP file; #{number} cannot be read")
        place = token.end()
        kind, found = token.lastgroup, token[token.lastgroup or 0]
        inside = open_lists[-1]
        if found == "(":
            named = bool(inside) and isinstance(inside[-1], _Word)
            names.append(inside.pop() if named else None)
            open_lists.append([])
        elif found == ")":
            if not names:
                raise ValueError(f"a whole STEP file; #{number} has a bracket too many")
            name, closed = names.pop(), open_lists.pop()
            open_lists[-1].append(closed if name is None else Typed(name, closed))
        elif kind == "word":
            inside.append(_Word(found.upper()))
        elif kind == "reference":
            inside.append(Reference(found[1:]))
        elif kind == "number":
            inside.append(_number(number, found))
        elif kind == "text":
            inside.append(found[1:-1].replace("''", "'"))
        elif found != ",":
            inside.append(None)  # * and $, and binary
    if names:
        raise ValueError(f"a whole STEP file; #{number} has an open bracket")
    return every


class _Word(str):
    """A name, or an enumeration such as .T."""


def _number(number: int, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"a whole STEP file; {text[:20]!r} in #{number} is no number") from None
