"""Reads the section of a rail from a file of any format, chosen by the suffix of its name."""

from pathlib import Path

from tipoff.formats.declared import declared, of_suffix
from tipoff.formats.sections.drawn import Drawn


def read_section(path: str | Path, unit: str | None) -> Drawn:
    """The section in a file. ``unit`` of the lengths; None for the one that the file states. Raises
    OSError, and ValueError with what the file lacks."""
    found = of_suffix(declared(__package__), path)
    assert found is not None  # one format reads any file
    return found.read(path, unit)
