"""What is asked of a file with curves, and the columns that are read from it, before their units."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError, close
from tipoff.files import open_input, read_input
from tipoff.formats.csv_file import Line, numbers
from tipoff.formats.declared import Format

MOST_BYTES = 2**27  # of a text; of that of LS-DYNA or Adams only some columns are kept
HEAD = 2**16  # bytes in which the root of XML is
_SHOWN = 40  # names or bodies listed in a fault
BODY, SCENE = "body", "scene"  # axes of rates


class CurveFile:
    """A file with curves. Raises OSError if it cannot be read."""

    def __init__(self, path: str | Path) -> None:
        self.path, self.source = Path(path), str(path)
        with open_input(path) as stream:
            self.head = stream.read(HEAD)

    @cached_property
    def data(self) -> bytes:
        """The content of a text, in UTF-8."""
        return read_input(self.path, MOST_BYTES)


class Asked(NamedTuple):
    """What is asked of a file."""

    body: str | None  # number of a body or node, name of a part
    columns: tuple[str, ...]  # by header or number, with a sign
    names: tuple[str, ...]  # of the columns of a table by default

    def unsigned(self) -> list[str]:
        """The columns without their signs."""
        return [column.removeprefix("-") for column in self.columns]


@dataclass(frozen=True)
class CurveFormat(Format):
    """A format of curves: ``read`` makes a CurveTable from a CurveFile and what is asked."""

    begins: Callable[[bytes], bool] | None = None  # whether a binary file is in it, by its head
    is_in: Callable[[bytes], bool] | None = None  # whether a text is in it, by its content
    # files of a binary one, of which the digest is; None: itself
    parts: Callable[[Path], list[Path]] | None = None


class CurveTable(NamedTuple):
    """Columns of one body or node.

    ``columns`` names the default column of a quantity if it is not that of the quantity.
    ``is_consistent``: all columns are in one consistent system, and ``units`` are patterns of its
    units of time and length, "{length}/{time}". ``axes`` of the rates are None if the file does not tell them.
    """

    names: Sequence[str]  # of the columns; empty if the file has none
    units: Sequence[str | None]
    rows: list[Line] | np.ndarray  # lines with cells, or numbers (n,k)
    columns: Mapping[str, str] = MappingProxyType({})
    is_consistent: bool = False
    axes: str | None = BODY

    @property
    def width(self) -> int:
        """Number of columns."""
        if isinstance(self.rows, np.ndarray):
            return self.rows.shape[1]
        return max([len(self.names), *(len(row) for _, row in self.rows[:1])])

    def place(self, text: str) -> int | None:
        """Place of the column with a name or a number (from 1); None unless there is one."""
        if list(self.names).count(text) == 1:
            return list(self.names).index(text)
        if text.isdecimal() and len(text) < 6 and text not in self.names:
            return int(text) - 1 if 1 <= int(text) <= self.width else None
        return None

    def numbers(self, source: str, name: str, place: int) -> tuple[np.ndarray, list[Fault]]:
        """The column (n,) at a ``place``, and the faults of its cells."""
        if not isinstance(self.rows, np.ndarray):
            return numbers(source, name, place, self.rows)
        values = self.rows[:, place]
        if (count := int((~np.isfinite(values)).sum())) == 0:
            return values, []
        return values, [Fault(source, name, f"{count} values NaN or inf", "finite numbers")]

    def no_column(self, source: str, name: str, text: str) -> Fault:
        """The fault of a quantity ``name`` without its one column ``text``."""
        given = "twice" if list(self.names).count(text) > 1 else "no such column"
        given += "" if text == name else f" {text!r}"
        if not self.names:
            known = f"a number from 1 to {self.width} in --columns: the file has no header"
        else:
            known = f"once in the header, which has {listed(self.names)}{close(text, self.names)}"
        return Fault(source, name, given, known)


def listed(names: Sequence[str]) -> str:
    """The names as text, at most ``_SHOWN`` of them."""
    shown = [name for name in names if name]
    more = [f"and {len(shown) - _SHOWN} more"] if len(shown) > _SHOWN else []
    return ", ".join([*shown[:_SHOWN], *more]) or "nothing"


def chosen_body(source: str, body: str | None, found: Sequence[str]) -> str:
    """The name of one body or node among those ``found``: "rbdout 7", also by its last word "7".
    Without ``body`` the file must have one. Raises SceneError."""
    alike = [name for name in found if body in (None, name)]
    alike = alike or [name for name in found if body == name.split()[-1]]
    if len(alike) == 1:
        return alike[0]
    given = "no number" if body is None else repr(body)
    raise SceneError([Fault(source, "--body", given, f"one of {listed(found)}")])
