"""Text of an Abaqus input file as keywords with their parameters and data."""

from collections.abc import Iterator
from typing import NamedTuple

from tipoff.highfi.mesh.files.tables import Unreadable

# Keywords that make or move nodes or elements in ways that are not read here.
_MAKERS = {
    *("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "IMPORT", "INCLUDE"),
    *("PARAMETER", "SUBMODEL", "SUBSTRUCTURE"),
}


class Keyword(NamedTuple):
    """A keyword with its parameters and data."""

    name: str  # capitals, without the star
    given: dict[str, str]  # parameters in capitals; a value may be empty
    data: list[tuple[int, list[str]]]  # number of a line and its fields
    line: int

    def of(self, parameter: str) -> str:
        """Value of a required parameter. Raises Unreadable without it."""
        value = self.given.get(parameter, "")
        if not value:
            raise Unreadable(f"line {self.line}: *{self.name} without {parameter}=")
        return value


def keywords(text: str) -> Iterator[Keyword]:
    """The keywords of a file in their order. Raises Unreadable for keywords that make or move nodes
    and elements."""
    current: Keyword | None = None
    header, start = "", 0
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if header and not line.startswith("*"):  # parameters go on behind a comma
            header += line
        elif line.startswith("*"):
            if current is not None:
                yield current
            header, start = line, number
        else:
            if current is None:
                raise Unreadable(f"line {number}: data before the first keyword")
            fields = [field.strip() for field in line.split(",")]
            current.data.append((number, fields[:-1] if fields[-1] == "" else fields))
            continue
        if header.endswith(","):
            current = None
            continue
        current, header = _keyword(header, start), ""
    if current is not None:
        yield current


def _keyword(header: str, line: int) -> Keyword:
    name, *parameters = [part.strip() for part in header[1:].split(",")]
    given = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        given[key.strip().upper()] = value.strip().strip('"')
    name = " ".join(name.upper().split())
    is_elsewhere = name in ("NODE", "ELEMENT", "ELSET", "SURFACE") and "INPUT" in given
    if name in _MAKERS or is_elsewhere:
        raise Unreadable(
            f"line {line}: *{name}{' with INPUT' * is_elsewhere} is not read; write the file with all "
            "nodes, elements and sets in it"
        )
    return Keyword(name, given, [], line)
