"""A scene under expansion: its tables, which parts change, and what was derived or refused."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from tipoff.scenes import overrides as keys
from tipoff.units import parse


class Made(NamedTuple):
    """A scene under expansion."""

    tables: dict  # changed in place
    raw: dict  # as written
    bare: bool
    derived: dict[str, str]
    faults: list[tuple[str, str, str]]

    def put(self, key: str, value: Any, source: str) -> None:
        """Set a dotted ``key`` whose tables are there."""
        keys.apply(self.tables, key, value)
        self.derived[key] = source

    def put_absent(self, table: str, values: Mapping[str, Any], source: str) -> None:
        """Set the keys of a ``table`` that it does not have; none without the table."""
        own = self.tables.get(table)
        if not isinstance(own, dict) or not own:
            return
        for name, value in values.items():
            if name not in own:
                self.put(f"{table}.{name}", keys.plain(value), source)

    def put_inertia(
        self, payload: dict, of_mass: Callable[[float], Mapping[str, str]], source: str
    ) -> None:
        """Set the moments of inertia of a ``payload`` that states none; none of a mass that is refused."""
        if "inertia" in payload:
            return
        mass = number(payload.get("mass"), "kg", self.bare)
        if mass is None:
            self.derived["payload.inertia"] = ""
        else:
            self.put("payload.inertia", dict(of_mass(mass)), source)

    def refuse(self, key: str, given: str, expected: str) -> None:
        self.faults.append((key, given, expected))

    def length(self, value: Any) -> float | None:
        """A length (m); None where the scene refuses it under its own key."""
        return number(value, "m", self.bare)


def number(value: Any, unit: str, bare: bool) -> float | None:
    """A value in SI; None if it is none, which the scene refuses under its own key."""
    try:
        return parse(value, unit, bare)
    except ValueError:
        return None


def text(length: float) -> str:
    """A length (m) as a file has it, in mm; rounding removes the noise of sums."""
    return f"{round(1e3 * length, 9)!r} mm"
