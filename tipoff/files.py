"""Files that are written atomically and contain a digest of their content.

A file is written under a temporary name, flushed to disk, then renamed. A file that is read back
ends with the bytes::

    # sha-256 <hexadecimal digest of every byte before this line>

This line is a comment in TOML, and readers of HDF5, netCDF and zip ignore it. A file of a cache
(``tipoff.cache``) has a line ``# key <key>`` before it. A JSON file has the digest under the key
``sha256`` instead; it is the digest of the canonical JSON of all other keys, so that it does not
depend on the layout.

Results state the number of their format: JSON and TOML under the key ``format``, netCDF in an attribute of
this name, npz in an array. A file without it is of the first format.
"""

import codecs
import errno
import glob
import hashlib
import io
import json
import os
import re
import stat
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

MOST_TEXT = 2**25  # bytes of a text file from a user; reading takes about ten times as much memory
FORMAT = 1  # of result files
FORMAT_KEY = "format"
KEY = "sha256"  # of the digest in a JSON object
_MARK = b"# sha-256 "
_ENCODINGS = {  # by the mark that a text begins with
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_XML_ENCODING = re.compile(r"""(<\?xml[^>]*?)\sencoding\s*=\s*("[^"]*"|'[^']*')""")
_LINE = re.compile(_MARK + rb"([0-9a-f]{64})\n")
_LENGTH = len(_MARK) + 64 + 1
_KEY_LINE = re.compile(rb"\n# key ([0-9a-f]{64})\n")
_KEY_LENGTH = len("\n# key \n") + 64
# Dimensions, values (array, or a list of texts), and attributes, such as the units.
Labelled = tuple[tuple[str, ...], Any, Mapping[str, Any]]
# The name that netCDF gives to the scale of a dimension without a coordinate.
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
_temporaries: set[Path] = set()  # of this process, not yet renamed
_CARRIES_NONE = "has no digest of its content, or a damaged one"
_DIFFERS = "differs from its digest (damaged, or edited)"


class DamageError(ValueError):
    """A file without a digest or with another content; ``reason`` follows the path in a message."""

    def __init__(self, path: str | Path, reason: str):
        self.path, self.reason = path, reason
        super().__init__(f"{path} {reason}; remove it, and repeat the command that wrote it")

    def __reduce__(self):
        return type(self), (self.path, self.reason)


@contextmanager
def open_input(path: str | Path) -> Iterator[io.BufferedReader]:
    """Yield the bytes of a file that a user named. Raises OSError unless it is a regular file: a
    device or a pipe may never end, and opening a pipe may never return."""

    def opened(name: str, flags: int) -> int:
        return os.open(name, flags | getattr(os, "O_NONBLOCK", 0))

    path = os.fspath(path)  # a number would mean an open file
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "a null character in its name", str(path))
    with open(path, "rb", opener=opened) as stream:
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise OSError(errno.EINVAL, "not a regular file", str(path))
        yield stream


def encoding(begin: bytes) -> str:
    """Encoding of a text by its first bytes: UTF-16 or UTF-32 with a byte order mark, as Windows writes
    them, or UTF-16 without one, whose first characters are of ASCII, else UTF-8."""
    for mark, name in _ENCODINGS.items():
        if begin.startswith(mark):
            return name
    for name, zeros, letters in (
        ("utf-16-le", begin[1:4:2], begin[0:4:2]),
        ("utf-16-be", begin[0:4:2], begin[1:4:2]),
    ):
        if zeros == b"\0\0" and all(byte in b"\t\r\n" or 32 <= byte < 127 for byte in letters):
            return name
    return "utf-8-sig"


def utf_8(content: bytes) -> bytes:
    """A text of another ``encoding`` in UTF-8, without a byte order mark; anything else as it is."""
    if (found := encoding(content[:4])) == "utf-8-sig":
        return content.removeprefix(codecs.BOM_UTF8)
    try:
        return _XML_ENCODING.sub(r"\1", content.decode(found), count=1).encode()
    except UnicodeError:  # no text
        return content


def read_input(path: str | Path, most: int = MOST_TEXT) -> bytes:
    """Content of a file that a user named, as ``utf_8`` gives it. Raises OSError as ``open_input``
    does, and for a file of more than ``most`` bytes; no more are read."""
    with open_input(path) as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"larger than {most // 2**20} MiB", str(path))
    return utf_8(content)


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path. On success it replaces ``path`` atomically; on any exception it is
    removed."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    _temporaries.add(temporary)
    try:
        yield temporary
        with open(temporary, "rb") as stream:
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        if error.errno and not error.filename:  # errors of writing have no file name
            error.filename = str(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)
        _temporaries.discard(temporary)


def remove_temporaries() -> None:
    """Remove the temporary files of ``replacing`` in all threads, for a process that ends at
    once."""
    for temporary in list(_temporaries):
        temporary.unlink(missing_ok=True)


def discard(path: str | Path) -> None:
    """Remove ``path`` if it exists, and the temporary files of an interrupted ``replacing``."""
    path = Path(path)
    path.unlink(missing_ok=True)
    for leftover in path.parent.glob(f".{glob.escape(path.name)}.*{glob.escape(path.suffix)}"):
        leftover.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write ``text`` in UTF-8 atomically."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_csv(path: str | Path, columns: Mapping[str, Any]) -> None:
    """Write ``columns`` of numbers (n,), by titles with units, in UTF-8 atomically."""
    rows = zip(*(values.tolist() for values in columns.values()))
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    write_text(path, "\n".join(lines) + "\n")


@contextmanager
def sealed(path: str | Path) -> Iterator[Path]:
    """As ``replacing``; the digest is appended as the last line."""
    with replacing(path) as temporary:
        yield temporary
        with open(temporary, "rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
        with open(temporary, "ab") as stream:
            stream.write(_MARK + digest.encode() + b"\n")


def write_sealed(path: str | Path, content: bytes | memoryview, key: str = "") -> None:
    """Write ``content`` as ``sealed`` does, with the ``key`` (64 hexadecimal digits) of a cache if
    given."""
    with sealed(path) as temporary, open(temporary, "wb") as stream:
        stream.write(content)
        stream.write(f"\n# key {key}\n".encode() if key else b"")


def netcdf(found: Any) -> bytes | memoryview:
    """An xarray Dataset or DataTree as a netCDF file. It is made in memory, because HDF5 ends the
    whole process if the disk is full."""
    return found.to_netcdf(engine="h5netcdf")


def labelled_netcdf(variables: Mapping[str, Labelled], attributes: Mapping[str, Any]) -> memoryview:
    """The ``variables`` by name as a netCDF file, in a tenth of the time of ``netcdf``. A variable with the name of its
    only dimension is the coordinate of that dimension."""
    import h5py  # slow to load

    content = io.BytesIO()
    with h5py.File(content, "w", track_order=True) as file:
        written, scales = {}, {}
        for name, (dimensions, values, units) in variables.items():
            kind = h5py.string_dtype() if isinstance(values, list) else None
            written[name] = file.create_dataset(name, data=values, dtype=kind)
            written[name].attrs.update(units)
            for dimension, size in zip(dimensions, written[name].shape):
                if dimension not in variables and dimension not in scales:
                    scales[dimension] = file.create_dataset(dimension, (size,), ">f4")
                    scales[dimension].make_scale(f"{_NO_VARIABLE}{size:10}")
            if (name,) == tuple(dimensions):
                scales[name] = written[name]
                scales[name].make_scale(name)
        for name in sorted(written.keys() - scales.keys()):
            for place, dimension in enumerate(variables[name][0]):
                h5py.h5ds.attach_scale(written[name].id, scales[dimension].id, place)
        file.attrs.update(attributes)
    return content.getbuffer()


def write_netcdf(path: str | Path, found: Any) -> None:
    """Write an xarray Dataset or DataTree as ``sealed`` does."""
    stated = found.copy(deep=False)  # a DataTree has no assign_attrs
    stated.attrs = {**found.attrs, FORMAT_KEY: FORMAT}
    write_sealed(path, netcdf(stated))


def require_whole(path: str | Path) -> str:
    """The key of a file of ``write_sealed``, empty without one. Raises DamageError unless the file
    is as ``sealed`` wrote it, FileNotFoundError or another OSError if it cannot be read."""
    content = memoryview(_content(path))
    last = _LINE.fullmatch(content[-_LENGTH:])
    if last is None:
        raise DamageError(path, _CARRIES_NONE)
    content = content[:-_LENGTH]
    if hashlib.sha256(content).hexdigest().encode() != last[1]:
        raise DamageError(path, _DIFFERS)
    named = _KEY_LINE.fullmatch(content[-_KEY_LENGTH:])
    return named[1].decode() if named else ""


def is_sealed(path: str | Path) -> bool:
    """Whether any line of the file begins like the line of a digest. Raises OSError if the file
    cannot be read."""
    return any(line.startswith(_MARK) for line in _content(path).splitlines())


def _content(path: str | Path) -> bytes:
    with open_input(path) as stream:
        return stream.read()


def require_format(path: str | Path, stated: Any) -> None:
    """Raise DamageError unless a result file states ``FORMAT``, or None."""
    if stated is not None and stated != FORMAT:
        raise DamageError(path, f"has format {stated}, and this version reads format {FORMAT}")


def write_json(path: str | Path, value: Mapping[str, Any]) -> dict[str, Any]:
    """Write ``value`` as strict JSON (no NaN) with its digest, atomically; returns the object as in
    the file."""
    found = with_digest({FORMAT_KEY: FORMAT, **value})
    write_text(path, json.dumps(found, indent=1, allow_nan=False) + "\n")
    return found


def read_json(path: str | Path) -> dict[str, Any]:
    """The object that ``write_json`` wrote. Raises DamageError, or OSError if the file cannot be
    read."""
    try:
        found = json.loads(_content(path))
        whole = isinstance(found, dict) and fits_digest(found)
    except (ValueError, RecursionError) as fault:
        raise DamageError(path, "is not JSON (damaged, or edited)") from fault
    if not whole:
        raise DamageError(
            path, _DIFFERS if isinstance(found, dict) and KEY in found else _CARRIES_NONE
        )
    require_format(path, found.get(FORMAT_KEY))
    return found


def with_digest(value: Mapping[str, Any]) -> dict[str, Any]:
    """``value`` with the digest of its content; an existing one is replaced."""
    rest = {key: item for key, item in value.items() if key != KEY}
    # keys are text only after conversion to JSON
    return rest | {KEY: content_hash(json.loads(json.dumps(rest, allow_nan=False)))}


def fits_digest(value: Mapping[str, Any]) -> bool:
    """Whether the content of ``value``, as read from JSON, fits its digest."""
    return value.get(KEY) == content_hash({key: item for key, item in value.items() if key != KEY})


def tell(text: str) -> None:
    """Print one line on standard error."""
    print(text, file=sys.stderr, flush=True)


def content_hash(*parts: Any) -> str:
    """Hexadecimal SHA-256 of the canonical JSON of ``parts``."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True, allow_nan=False).encode()).hexdigest()
