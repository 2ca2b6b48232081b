"""Results in files, each under a key: the digest of everything that the result depends on.

A file has its key and a digest of its content (``tipoff.files``), and is written atomically. So two
processes that make one result at the same time write the same file. A file that is missing, damaged
or of another key is never used. Damage is reported once on standard error.
"""

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from tipoff.files import read_json, require_whole, tell, write_json, write_sealed

_T = TypeVar("_T")
_SAID: dict[Path, str] = {}  # reports of this process on files that were not written again since


def file(folder: Path, label: str, key: str, suffix: str) -> Path:
    """The file of the result ``key`` in a folder. Its name has the first digits of the key."""
    return folder / f"{label}-{key[:8]}{suffix}"


@dataclass(frozen=True)
class Cache(Generic[_T]):
    """Results of one kind. ``read`` returns the result in a file, or None for a file of another
    key. It raises FileNotFoundError, and any exception for a damaged file. ``write`` returns the
    result as read back from the file, and raises OSError."""

    read: Callable[[Path, str], _T | None]
    write: Callable[[Path, str, _T], _T]

    def get(self, path: Path, key: str, again: str) -> _T | None:
        """The result ``key`` in the file; None without an intact one. A message on damage is the
        path and ``again``, its consequence."""
        return whole(path, again, lambda: self.read(path, key))

    def put(self, path: Path, key: str, value: _T) -> _T:
        """Write a result. Returns and raises as ``write``."""
        _SAID.pop(path, None)
        return self.write(path, key, value)

    def get_or_make(self, path: Path, key: str, again: str, make: Callable[[], _T]) -> _T:
        """The result ``key`` in the file; else the result of ``make``, which is written."""
        found = self.get(path, key, again)
        return self.put(path, key, make()) if found is None else found


@dataclass(frozen=True)
class Held(Cache[_T]):
    """A cache whose results stay in the memory of the process too: the last ``most``, each as long as
    its file is untouched. All callers share a result, so that nobody may change it."""

    most: int = 8
    _results: dict[Path, tuple[str, "_Stamp | None", _T]] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def get(self, path: Path, key: str, again: str) -> _T | None:
        """As of any cache."""
        held = self._results.get(path)
        if held is not None and held[0] == key and held[1] == _stamp(path) is not None:
            return held[2]
        found = super().get(path, key, again)
        if found is not None:
            self._hold(path, key, found)
        return found

    def put(self, path: Path, key: str, value: _T) -> _T:
        """As of any cache."""
        found = super().put(path, key, value)
        self._hold(path, key, found)
        return found

    def _hold(self, path: Path, key: str, found: _T) -> None:
        with self._lock:
            self._results.pop(path, None)
            while len(self._results) >= self.most:
                self._results.pop(next(iter(self._results)))
            self._results[path] = key, _stamp(path), found


_Stamp = tuple[int, int, int]
_TICK = 50_000_000  # ns, more than file systems need to give a later write a later time


def _stamp(path: Path) -> _Stamp | None:
    """What changes when a file is written: place on the disk, time, size. None without a file, and where
    it was written just now: another write may have the same time."""
    try:
        state = path.stat()
    except OSError:
        return None
    old = time.time_ns() - state.st_mtime_ns > _TICK
    return (state.st_ino, state.st_mtime_ns, state.st_size) if old else None


def binary(
    content: Callable[[_T], bytes | memoryview],
    load: Callable[[Path], _T],
    kind: type[Cache] = Cache,
) -> Cache[_T]:
    """Results that ``content`` converts to bytes, and ``load`` reads from a file with further lines at
    its end. Keys have 64 hexadecimal digits."""

    def write(path: Path, key: str, value: _T) -> _T:
        write_sealed(path, content(value), key)
        return value

    return kind(lambda path, key: load(path) if require_whole(path) == key else None, write)


def documents(
    plain: Callable[[_T], Mapping[str, Any]],
    load: Callable[[dict], _T],
    kind: type[Cache] = Cache,
) -> Cache[_T]:
    """Results that ``plain`` converts to JSON and ``load`` reads from it. The key is under ``key``."""

    def read(path: Path, key: str) -> _T | None:
        found = read_json(path)
        return load(found) if found.get("key") == key else None

    return kind(read, lambda path, key, value: load(write_json(path, {**plain(value), "key": key})))


def whole(path: Path, again: str, read: Callable[[], _T]) -> _T | None:
    """The result of ``read`` for a file; None without a file. Reports damage once, with ``again``,
    its consequence."""
    try:
        found = read()
    except FileNotFoundError:
        return None
    except Exception as fault:  # libraries raise many kinds on foreign bytes
        refusal = fault.strerror if isinstance(fault, OSError) else None
        reason = f"cannot be read ({refusal})" if refusal else "is damaged or was edited"
        line = f"  {path} {reason}: {again}"
        if _SAID.get(path) != line:
            tell(line)
        _SAID[path] = line
        return None
    _SAID.pop(path, None)
    return found
