"""Reads a thrust over time from a file of any format, chosen by the suffix of its name."""

from pathlib import Path

from tipoff.scenes.thrust_files import rasp, rocksim, table
from tipoff.scenes.thrust_files.record import Choice, Record


def read(path: str, data: bytes, choice: Choice) -> Record:
    """The thrust in ``data``, the content of the file. Raises ValueError with what is wrong."""
    suffix = Path(path).suffix.lower()
    if suffix == ".eng":
        return rasp.read(data, choice)
    if suffix == ".rse":
        return rocksim.read(data, choice)
    return table.read(path, data, choice)
