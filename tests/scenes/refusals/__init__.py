"""What is refused of each scene table: a module a table, with its ``CASES`` and the scene that a case
changes. ``tests.scenes.test_refusal`` reads all of them.

A case is a change of a table, the keys of exactly the faults that it has, and words of their text.
"""

import importlib
import pkgutil
from pathlib import Path
from typing import Any, NamedTuple


class Refused(NamedTuple):
    """A case."""

    change: Any  # as the module takes it
    keys: str  # of all faults, separated by spaces
    words: tuple[str, ...]  # of the message


class Written(NamedTuple):
    """The content of a file, where a scene names one."""

    content: str | bytes

    def path(self, folder: Path) -> str:
        """The path of such a file."""
        path = folder / "written.csv"
        path.write_bytes(self.content if isinstance(self.content, bytes) else self.content.encode())
        return str(path)


def case(change, keys: str, *words: str) -> Refused:
    """A case, short to write."""
    return Refused(change, keys, words)


def in_folder(value, folder: Path):
    """A change with the paths of its written files."""
    if isinstance(value, Written):
        return value.path(folder)
    if isinstance(value, dict):
        return {key: in_folder(item, folder) for key, item in value.items()}
    return value


def modules() -> list:
    """Names and modules of all tables."""
    names = [found.name for found in pkgutil.iter_modules(__path__)]
    return [(name, importlib.import_module(f"{__name__}.{name}")) for name in names]
