"""Reads the columns of a file with curves; its content tells the format."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

from tipoff.faults import Fault, SceneError
from tipoff.files import open_input
from tipoff.formats.curves.record import Asked, CurveFile, CurveFormat, CurveTable
from tipoff.formats.declared import declared

_HDF5 = b"\x89HDF\r\n\x1a\n"
_BLOCK = 2**20


def read_curves(path: str | Path, asked: Asked) -> tuple[CurveTable, str]:
    """The table of a file and its digest (SHA-256). Raises SceneError and OSError."""
    file = CurveFile(path)
    _require_described(file)
    formats = declared(__package__, CurveFormat)
    for each in formats:
        if each.begins is not None and each.begins(file.head):
            parts = each.parts(file.path) if each.parts else [file.path]
            return each.read(file, asked), _digest(parts)
    digest = hashlib.sha256(file.data).hexdigest()
    fitting = (
        each
        for each in formats
        if each.is_any_other or (each.is_in is not None and each.is_in(file.data))
    )
    return next(fitting).read(file, asked), digest


def _require_described(file: CurveFile) -> None:
    """Refuse files whose layout is not in public documentation."""
    if file.head.startswith(_HDF5):
        words = "binout of LS-DYNA as LSDA, or rbdout or nodout as text"
        raise SceneError([Fault(file.source, "file", "HDF5", words)])
    if file.path.suffix.lower() == ".req":
        words = "results of Adams in XML (.res), or a table of Adams/PostProcessor (.tab)"
        raise SceneError([Fault(file.source, "file", "a request file", words)])


def _digest(paths: Iterable[Path]) -> str:
    """SHA-256 of the files one after another."""
    found = hashlib.sha256()
    for path in paths:
        with open_input(path) as stream:
            while block := stream.read(_BLOCK):
                found.update(block)
    return found.hexdigest()
