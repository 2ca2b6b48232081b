"""Reads a thrust over time from a file of any format, chosen by the suffix of its name."""

from tipoff.formats.declared import declared, of_suffix
from tipoff.formats.thrusts.record import Choice, Record


def read_thrust(path: str, data: bytes, choice: Choice) -> Record:
    """The thrust in ``data``, the content of the file. Raises ValueError with what is wrong."""
    found = of_suffix(declared(__package__), path)
    assert found is not None  # one format reads any file
    return found.read(path, data, choice)
