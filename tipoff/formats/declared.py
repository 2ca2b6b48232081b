"""Formats of files, each declared in the file of its reader.

A room is a folder whose modules have ``FORMATS``, a tuple of declarations. All of its modules are
imported, so a file in the folder is enough for a format.
"""

import functools
import importlib
import pkgutil
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

_PLACE = re.compile(r"\{formats of (\w+)\}")


@dataclass(frozen=True)
class Format:
    """One format of a room."""

    name: str  # in messages and in --help
    read: Callable[..., Any]  # its arguments are those of the room
    rows: Sequence[tuple[str, ...]]  # cells of its rows in the documentation, in Markdown
    suffixes: tuple[str, ...] = ()  # lower case, with the dot
    is_any_other: bool = False  # whether it reads all files that no other format of the room reads


Kind = TypeVar("Kind", bound=Format)


@functools.cache
def declared(room: str, kind: type[Kind] = Format) -> tuple[Kind, ...]:  # type: ignore[assignment]
    """The formats of all modules in the folder of a package, by the names of the modules; the one for
    any other file is last. Raises ValueError for a declaration of another ``kind`` and for a suffix of
    two formats."""
    folder = importlib.import_module(room).__path__
    modules = [importlib.import_module(f"{room}.{each.name}") for each in _modules(folder)]
    found = [each for module in modules for each in getattr(module, "FORMATS", ())]
    if others := [each.name for each in found if not isinstance(each, kind)]:
        raise ValueError(f"a format of {room} is a {kind.__name__}, and {others[0]} is none")
    suffixes = [suffix for each in found for suffix in each.suffixes]
    if len(set(suffixes)) < len(suffixes) or sum(each.is_any_other for each in found) > 1:
        raise ValueError(f"two formats of {room} for one file, among {', '.join(suffixes)}")
    return tuple(sorted(found, key=lambda each: each.is_any_other))


def filled(text: str) -> str:
    """A text with the names of the formats of a room in place of each ``{formats of ROOM}``."""
    return _PLACE.sub(lambda place: _names(f"{__package__}.{place[1]}"), text)


def _names(room: str) -> str:
    return ", ".join(dict.fromkeys(each.name for each in declared(room)))


def _modules(folder: Sequence[str]) -> list[pkgutil.ModuleInfo]:
    return sorted(pkgutil.iter_modules(folder), key=lambda each: each.name)


def of_suffix(formats: Iterable[Kind], path: str | Path) -> Kind | None:
    """The one of the ``formats`` for a file by the end of its name; None if no format reads it."""
    suffix = Path(path).suffix.lower()
    fitting = (each for each in formats if suffix in each.suffixes or each.is_any_other)
    return next(fitting, None)
