"""The files that ``*INCLUDE`` puts together to one keyword file of LS-DYNA.

A name is searched in the folder of the file that includes it, in the folder of the first file, and in
the folders of ``*INCLUDE_PATH``; these and those of ``*INCLUDE_PATH_RELATIVE`` count from the folder of
the first file. A blank and a plus at the end of a line continue a name. See ``*INCLUDE`` in the LS-DYNA
Keyword User's Manual, volume I.
"""

import errno
import hashlib
import re
from pathlib import Path
from typing import NamedTuple

from tipoff.files import open_input, utf_8

SUFFIXES = (".k", ".key", ".dyn")
_MOST = 500  # files
_KEYWORD = re.compile(rb"\*\s*([A-Za-z0-9_]*)")
_INCLUDE = re.compile(rb"^\*\s*INCLUDE", re.MULTILINE | re.IGNORECASE)
_PATHS = (b"INCLUDE_PATH", b"INCLUDE_PATH_RELATIVE")


class IncludeError(OSError):
    """An ``*INCLUDE`` that cannot be followed; ``strerror`` names the line."""

    def __str__(self) -> str:
        return self.strerror or ""


class Piece(NamedTuple):
    """Lines of a file between two includes."""

    path: Path
    first: int  # number of the first line
    content: bytes


def pieces(path: Path) -> list[Piece]:
    """All lines of a file and of those that it includes, in the order in which they are read.

    Raises OSError for a file that cannot be read, and IncludeError for one that is not found, is
    included twice, or includes itself.
    """
    reading = _Reading([], [], [], path.parent)
    _read(path, (), reading)
    return reading.found


def digest(path: Path) -> str:
    """SHA-256 of the content of a file; of a keyword file with includes, of the digests of all
    pieces. Raises OSError as ``pieces`` does."""
    if path.suffix.lower() not in SUFFIXES:
        with open_input(path) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    each = [hashlib.sha256(piece.content) for piece in pieces(path)]
    if len(each) == 1:
        return each[0].hexdigest()
    return hashlib.sha256(b"".join(one.digest() for one in each)).hexdigest()


class _Reading(NamedTuple):
    """What was read so far."""

    found: list[Piece]
    files: list[Path]
    folders: list[Path]  # of *INCLUDE_PATH
    top: Path  # folder of the first file


def _read(path: Path, chain: tuple[Path, ...], reading: _Reading) -> None:
    reading.files.append(path.resolve())
    with open_input(path) as stream:
        content = utf_8(stream.read())
    if not _INCLUDE.search(content):
        reading.found.append(Piece(path, 1, content))
        return
    lines, start, place = content.splitlines(keepends=True), 0, 0
    while place < len(lines):
        name = _name(lines[place])
        if name == b"END":
            break
        if name != b"INCLUDE" and name not in _PATHS:
            place += 1
            continue
        reading.found.append(Piece(path, start + 1, b"".join(lines[start:place])))
        where = f"{path.name}, line {place + 1}: *{name.decode()}"
        start = place + 1
        while start < len(lines) and not lines[start].startswith(b"*"):
            start += 1
        for given in _given(lines[place + 1 : start]):
            if name == b"INCLUDE":
                found = _searched(given, path, reading, where)
                _require_new(found, (*chain, path.resolve()), reading, where)
                _read(found, (*chain, path.resolve()), reading)
            else:
                reading.folders.append(reading.top / given)
        place = start
    reading.found.append(Piece(path, start + 1, b"".join(lines[start:place])))


def _name(line: bytes) -> bytes:
    """The keyword of a line in capitals; empty for data."""
    found = _KEYWORD.match(line)
    return found[1].upper() if found else b""


def _given(lines: list[bytes]) -> list[str]:
    """The names in the lines below a keyword."""
    names, begun = [], ""
    for line in lines:
        text = line.decode("utf-8", "replace").strip()
        if line.startswith(b"$") or not text:
            continue
        if text.endswith(" +"):
            begun += text.removesuffix("+").rstrip()
        else:
            names.append((begun + text).replace("\\", "/"))
            begun = ""
    return names


def _searched(given: str, path: Path, reading: _Reading, where: str) -> Path:
    for folder in (path.parent, reading.top, *reading.folders):
        if (folder / given).is_file():
            return folder / given
    text = f"{where} names {given}, which is not beside it and in no folder of *INCLUDE_PATH"
    raise IncludeError(errno.ENOENT, text)


def _require_new(path: Path, chain: tuple[Path, ...], reading: _Reading, where: str) -> None:
    """Check that a file is included once; else nodes are there twice, or reading never ends."""
    if path.resolve() in chain:
        raise IncludeError(errno.ELOOP, f"{where} names {path.name}, which is being read: a circle")
    if path.resolve() in reading.files:
        raise IncludeError(errno.EEXIST, f"{where} names {path.name}, which is included already")
    if len(reading.files) >= _MOST:
        raise IncludeError(errno.E2BIG, f"{where}: more than {_MOST} files")
