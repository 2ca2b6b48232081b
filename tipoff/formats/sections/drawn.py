"""What is read from a drawing or a solid with a section."""

from typing import NamedTuple

from tipoff.formats.outline import Corner


class Drawn(NamedTuple):
    """The section of a rail."""

    loops: list[list[Corner]]  # m, in any order and direction
    length: float | None = None  # m, of a solid
