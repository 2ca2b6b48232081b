"""A column of a table: its head, and the format of the numbers below it."""

import re
import typing
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from tipoff.uncertain import LEAST, NOTHING, STEPS, Measured, below, number, rounded
from tipoff.uncertain import uncertain as with_uncertainty


@dataclass(frozen=True)
class Column:
    """Head of a column, and the format of the numbers below it.

    ``unit`` is in brackets after the ``title``. A number is multiplied by ``scale`` and shown in
    ``form``, a format of Python, without digits below the smallest step of its unit. An integer has
    all digits, and ``nothing`` stands for None. The terminal leaves out a column of ``detail``.
    """

    title: str
    unit: str = ""
    form: str = ".3g"
    scale: float = 1.0
    nothing: str = NOTHING
    detail: bool = False

    @property
    def head(self) -> str:
        """Title and unit."""
        return f"{self.title} ({self.unit})" if self.unit else self.title

    @property
    def least(self) -> float:
        """The smallest step that is shown; 0 if the unit has none. The unit may be in brackets at
        the end of the title."""
        return STEPS.get(self.unit or _unit(self.title), 0.0)

    def text(self, value: float) -> str:
        """A number as text."""
        return number(self.scale * value, self.form, self.least)

    def of_row(self, row: Sequence[Any]) -> "Column":
        """The column in a row. Without a unit of its own it has the unit of the row, in brackets at
        the end of the first cell."""
        if self.least or self.unit or not row or not (unit := _unit(row[0])):
            return self
        return _InRow(
            self.title,
            self.unit,
            form=self.form,
            scale=self.scale,
            nothing=self.nothing,
            own=STEPS.get(unit, 0.0),
        )

    def measured(self, cell: Measured) -> str:
        """A number, or several, rounded to their uncertainty."""
        if isinstance(cell.value, (list, tuple)):
            parts = (replace(cell, value=part) for part in cell.value)
            return ", ".join(map(self.measured, parts))
        if cell.value is None:
            return NOTHING
        value = self.scale * cell.value
        error = None if cell.uncertainty is None else abs(self.scale) * cell.uncertainty
        least = self.least or STEPS.get(cell.unit) or LEAST * (error or 0.0)
        if error is None or not least:
            return number(value, self.form, least)
        if cell.magnitude:
            return below(value, error, least)
        if cell.apart:
            return rounded(value, error, least, "+" if self.form.startswith("+") else "")
        return with_uncertainty(value, error, least)


@dataclass(frozen=True)
class _InRow(Column):
    """A column in a row that has a unit; ``own`` is the smallest step of that unit."""

    own: float = 0.0

    @property
    def least(self) -> float:
        return self.own


def _unit(text: Any) -> str:
    """The unit in brackets at the end of a text; empty without one."""
    found = re.search(r"\(([^()]+)\)$", text) if isinstance(text, str) else None
    return found[1] if found else ""


def of_record(kind: type) -> dict[str, Column]:
    """The columns that the fields of a dataclass declare, by name:

    time_s: Annotated[float, Column("time", "s")]
    """
    return {
        name: note
        for name, hint in typing.get_type_hints(kind, include_extras=True).items()
        for note in getattr(hint, "__metadata__", ())
        if isinstance(note, Column)
    }
