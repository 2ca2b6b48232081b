"""What is asked of a file with a thrust, and what is read from it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff.faults import close
from tipoff.formats.instrument_table import PAGE

SECTION = f"see {PAGE}, section Thrust"
_LISTED = 20  # names of motors in a message
_SHOWN = 5  # lines in a message


class Choice(NamedTuple):
    """Keys of ``[thrust]`` that choose from a file; None where absent."""

    motor: str | None = None
    time_column: str | None = None
    thrust_column: str | None = None
    time_unit: str | None = None
    thrust_unit: str | None = None

    def require_only(self, allowed: tuple[str, ...], kind: str) -> None:
        """Raise ValueError if a key is given that a file of this ``kind`` does not have."""
        wrong = [key for key, value in self._asdict().items() if value and key not in allowed]
        if wrong:
            keys = ", ".join(f"thrust.{key}" for key in wrong)
            raise ValueError(f"{kind} without {keys}; {SECTION}")


ANYTHING = Choice()


class Record(NamedTuple):
    """time (n,) s and force (n,) N; what was read in words, empty for the layout of tipoff; the line of
    each point in its file; what is wrong with the numbers; whether it is a motor, which cannot pull; what
    ``lines`` counts."""

    time: np.ndarray
    force: np.ndarray
    words: str
    lines: tuple[int, ...]
    faults: tuple[str, ...] = ()
    is_motor: bool = False
    counted: str = "line"

    def where(self, wrong: np.ndarray) -> str:
        """The lines of the ``wrong`` points (n,)."""
        lines = [str(line) for line, is_wrong in zip(self.lines, wrong, strict=True) if is_wrong]
        more = f" and {len(lines) - _SHOWN} more" if len(lines) > _SHOWN else ""
        plural = "s" if len(lines) > 1 else ""
        return f"{self.counted}{plural} {', '.join(lines[:_SHOWN])}{more}"


def chosen(names: Sequence[tuple[str, str]], wanted: str | None) -> int:
    """Place of the wanted motor among ``names`` and makers. A motor is named by its name, or by
    maker and name. Raises ValueError, with all names, unless it is there exactly once."""
    full = [f"{maker} {name}".strip() for name, maker in names]
    if wanted is None:
        found = list(range(len(names)))
    else:
        found = [place for place, (name, _) in enumerate(names) if name == wanted]
        if len(found) != 1:
            found = [place for place, name in enumerate(full) if name == wanted] or found
    if len(found) == 1:
        return found[0]
    more = f" and {len(full) - _LISTED} more" if len(full) > _LISTED else ""
    listed = ", ".join(full[:_LISTED]) + more
    if not names:
        raise ValueError(f"a file with a motor (it has none); {SECTION}")
    if wanted is None:
        raise ValueError(f"thrust.motor, one of {len(full)} in the file: {listed}; {SECTION}")
    count = f"{len(found)} times" if found else "not"
    meant = "" if found else close(wanted, [name for name, _ in names] + full)
    raise ValueError(
        f"a file with thrust.motor = {wanted!r} once (it is {count} there{meant}), it has {listed}; "
        f"{SECTION}"
    )
