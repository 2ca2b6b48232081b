"""Results of an ensemble in a folder, chunk by chunk, so that it may stop at any instant and go on later::

    cases.zarr/     a zarr group: status, exit_time, velocity ... and inputs/<dotted key>, SI, one chunk per 4096 cases,
                    with checksums
    done/000012.json   written last, in one piece: chunk 12 is whole; the digest of its numbers, its counts,
                       and each case that failed

A chunk counts as done once its file in done/ is there and the digest of what is read back agrees; any other is run again. No time
or place is stored, so two runs of one ensemble leave the same numbers, whoever ran them.
"""

import hashlib
import json
import os
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, Mapping, NamedTuple, Sequence

import numpy as np

from lowfi import columns
from lowfi.columns import Columns
from lowfi.rows import numbers
from scenes import overrides as keys
from scenes.files import content_hash, write_json
from scenes.scene import Scene

CHUNK = 4096
_NOT_RUN = -1
_FAILED = ("refused", "diverged")


class StoreError(RuntimeError):
    """An ensemble that cannot go on in its store; the message says why and what to do. What is stored stays."""


class Chunk(NamedTuple):
    """Cases of one chunk: its number, their rows of overrides, results, and a message each, mostly empty."""

    number: int
    rows: Sequence[Mapping[str, Any]]
    results: Columns
    messages: Sequence[str]


class Store:
    """The store of ``asked`` cases with inputs under the dotted ``names``, at ``path``: opened, or made when there is none.

    ``identity`` (JSON) is everything the numbers depend on; ``attributes`` are kept beside them. Raises StoreError for a folder
    that is no store, or one of another identity.
    """

    def __init__(self, path: str | Path, asked: int, names: Sequence[str], identity: dict, attributes: dict):
        self.path, self.asked, self.names = Path(path), asked, list(names)
        if not self.path.exists() or self.path.is_dir() and not any(self.path.iterdir()):
            with self._explained():
                self._make({"identity": identity, **attributes})
        self._arrays, self._inputs = self._opened(identity)

    def _make(self, attributes: dict) -> None:
        """Made under another name and then renamed, so that a store is never half made."""
        zarr = _zarr()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f".{self.path.name}.", dir=self.path.parent))
        try:
            root = zarr.create_group(folder / "cases.zarr", attributes=attributes)
            for name in Columns._fields:
                self._array(root, name, _type(name), {"units": columns.UNITS[name]} if name in columns.UNITS else {})
            root["status"].attrs.update(flag_values=list(range(len(columns.STATUSES))), flag_meanings=" ".join(columns.STATUSES))
            inputs = root.create_group("inputs")
            for name in self.names:
                self._array(inputs, name, "f8", {"units": keys.unit(Scene, name) or "SI"})
            (folder / "done").mkdir()
            folder.chmod(0o755)
            os.replace(folder, self.path)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _array(self, group, name: str, kind: str, attributes: dict) -> None:
        from zarr.codecs import Crc32cCodec

        inner = (3,) if name in columns.VECTORS else ()
        group.create_array(name, shape=(self.asked, *inner), chunks=(CHUNK, *inner), dtype=kind, compressors=[Crc32cCodec()],
                           fill_value=np.nan if kind == "f8" else _NOT_RUN, attributes=attributes,
                           dimension_names=("case", "axis")[:1 + len(inner)])

    def _opened(self, identity: dict) -> tuple[dict, list]:
        """Arrays of the results by name, and of the inputs."""
        try:
            group = _zarr().open_group(self.path / "cases.zarr", mode="r+")
            found, expected = group.attrs["identity"], json.loads(json.dumps(identity))
            if other := [name for name in expected if found.get(name) != expected[name]]:
                raise StoreError(f"{self.path} holds another ensemble: {', '.join(other)} differ; "
                                 "give another --store, or remove it")
            return {name: group[name] for name in Columns._fields}, [group[f"inputs/{name}"] for name in self.names]
        except (OSError, ValueError, KeyError) as error:
            raise StoreError(f"{self.path} is no store of an ensemble ({type(error).__name__}: {error}); "
                             "give another --store") from error

    def __len__(self) -> int:
        return -(-self.asked // CHUNK)

    def bounds(self, number: int) -> tuple[int, int]:
        """First case of a chunk, and first of the next."""
        return number * CHUNK, min((number + 1) * CHUNK, self.asked)

    def pending(self) -> list[int]:
        """Numbers of the chunks that are missing or damaged."""
        return [number for number in range(len(self)) if not self._whole(number)]

    def write(self, chunk: Chunk) -> None:
        """Keep the results of a chunk. Raises StoreError when that fails, as on a full disk."""
        begin, end = self.bounds(chunk.number)
        inputs = numbers(self.names, chunk.rows)
        with self._explained():
            for name, values in zip(Columns._fields, chunk.results):
                self._arrays[name][begin:end] = values
            for place, values in zip(self._inputs, inputs.T):
                place[begin:end] = values
            failures = [{"case": begin + n, "status": status, "reason": message, "inputs": _plain(row)}
                        for n, (code, message, row) in enumerate(zip(chunk.results.status, chunk.messages, chunk.rows))
                        if (status := columns.STATUSES[code]) in _FAILED]
            failed = {failure["case"] for failure in failures}
            warnings = {str(begin + n): text for n, text in enumerate(chunk.messages) if text and begin + n not in failed}
            write_json(self._mark(chunk.number), {"digest": _digest(chunk.results, inputs), **columns.counts(chunk.results.status),
                                                  "failures": failures, "warnings": warnings})

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise StoreError(f"cannot write {self.path}: {error.strerror or error}; {self.progress()}") from error

    def progress(self) -> str:
        """How far the ensemble is, for a message that ends it."""
        return f"{self.done():,} of {self.asked:,} cases are stored, and the same command goes on from there"

    def _whole(self, number: int) -> bool:
        if (mark := self._read_mark(number)) is None:
            return False
        try:
            return mark["digest"] == _digest(*self.read(*self.bounds(number)))
        except Exception:  # whatever zarr raises on damaged bytes, the remedy is the same
            return False

    def _mark(self, number: int) -> Path:
        return self.path / "done" / f"{number:06}.json"

    def _read_mark(self, number: int) -> dict | None:
        try:
            return json.loads(self._mark(number).read_text())
        except (OSError, ValueError):
            return None

    def read(self, begin: int, end: int) -> tuple[Columns, np.ndarray]:
        """Results, and inputs (n, k), of the cases ``begin`` to ``end`` - 1; status -1 in those that did not run yet."""
        found = Columns(*(self._arrays[name][begin:end] for name in Columns._fields))
        return found, np.array([place[begin:end] for place in self._inputs]).reshape(len(self.names), -1).T

    def column(self, name: str, begin: int = 0, end: int | None = None) -> np.ndarray:
        """One of the results of the cases ``begin`` to ``end`` - 1, absent: of all."""
        return self._arrays[name][begin:end]

    def done(self) -> int:
        """Cases that are stored."""
        return sum(end - begin
                   for begin, end in (self.bounds(number) for number in range(len(self)) if self._mark(number).is_file()))

    def failures(self) -> list[dict]:
        """Case number, status, reason and inputs of each case that was refused or diverged."""
        return [failure for number in range(len(self)) for failure in (self._read_mark(number) or {"failures": []})["failures"]]

    def digest(self) -> str:
        """Hexadecimal digest of all numbers, the same for every run of one ensemble."""
        return content_hash([(self._read_mark(number) or {}).get("digest") for number in range(len(self))])

    def results(self) -> tuple[Columns, list[str]]:
        """Results of all cases, and a message each."""
        messages = [""] * self.asked
        for number in range(len(self)):
            mark = self._read_mark(number) or {"failures": [], "warnings": {}}
            for failure in mark["failures"]:
                messages[failure["case"]] = failure["reason"]
            for case, text in mark["warnings"].items():
                messages[int(case)] = text
        return Columns(*map(self.column, Columns._fields)), messages


def _digest(results: Columns, inputs: np.ndarray) -> str:
    digest = hashlib.sha256()
    for name, values in zip(Columns._fields, results):
        digest.update(np.ascontiguousarray(values, dtype=_type(name)))
    digest.update(np.ascontiguousarray(inputs))
    return digest.hexdigest()


def _type(name: str) -> str:
    return {"status": "i1", "steps": "i8"}.get(name, "f8")


def _plain(row: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs as JSON has them: text for what is neither a finite number nor text."""
    return {key: value if isinstance(value, (str, int)) or isinstance(value, float) and np.isfinite(value) else repr(value)
            for key, value in row.items()}


def _zarr():
    try:
        import zarr
    except ImportError:
        raise StoreError("a store needs zarr: pip install 'tipoff[ensemble]'") from None
    return zarr
