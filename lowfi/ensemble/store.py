"""Results of an ensemble in a folder, chunk by chunk, so that it may stop at any time and continue
later::

    cases.zarr/        a zarr group: status, exit_time, velocity ... and inputs/<dotted key>, SI,
                       one chunk per 4096 cases, with checksums; and the columns of ``add``,
                       computed from whole stores, again on each request
    done/000012.json   written last, atomically (``tipoff.cache``): chunk 12 is complete; with the
                       ``key`` of its ensemble, the digest of its numbers, its counts, and each case
                       that failed
    twins/             stores of the same cases with a disturbance (``lowfi.ensemble.twins``)

A chunk is done if its file in done/ exists, is intact, and has the digest of the numbers read back;
any other chunk is run again. The descriptions of the arrays (``zarr.json``) are those of a new
store, and are written again if they differ. No time or place is stored, so two runs of one ensemble
leave the same numbers.
"""

import errno
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tipoff.cache import Cache, documents
from tipoff.files import (
    DamageError,
    content_hash,
    fits_digest,
    replacing,
    tell,
    with_digest,
)
from tipoff.lowfi.ensemble import arrays, columns
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.rows import numbers
from tipoff.scenes import overrides as keys
from tipoff.scenes.scene import Scene

CHUNK = 4096
_FAILED = ("refused", "diverged")


class StoreError(RuntimeError):
    """An ensemble that cannot continue in its store; the message gives the reason and the remedy.
    Stored cases stay."""


class Chunk(NamedTuple):
    """Cases of one chunk."""

    number: int
    rows: Sequence[Mapping[str, Any]]  # overrides
    results: Columns
    messages: Sequence[str]  # one per case, mostly empty


class Store:
    """The store of ``asked`` cases with inputs under the dotted ``names``, at ``path``: opened, or
    created if it does not exist.

    ``identity`` (JSON) is everything that determines the numbers; ``attributes`` are stored with
    them. Raises StoreError for a folder that is no store, and for a store of another identity.
    """

    def __init__(
        self, path: str | Path, asked: int, names: Sequence[str], identity: dict, attributes: dict
    ):
        self.path, self.asked, self.names = Path(path), asked, list(names)
        self.ensemble = content_hash(plain(identity))
        attributes = with_digest({"identity": identity, **attributes})
        is_new = not self.path.exists() or (self.path.is_dir() and not any(self.path.iterdir()))
        with self._explained():
            is_made = is_new and self._make(attributes)
        if not is_made:
            self._require(identity)
            with self._explained():
                self._describe(attributes)
        self._arrays, self._inputs = self._opened()

    def _make(self, attributes: dict) -> bool:
        """Create the store under another name and rename it, so that it is never incomplete. False
        if another process has created one in the meantime; both then write the same numbers."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f".{self.path.name}.", dir=self.path.parent))
        try:
            self._create(folder / "cases.zarr", attributes)
            (folder / "done").mkdir()
            folder.chmod(0o755)
            os.replace(folder, self.path)
            return True
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise
            return False
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _create(self, place, attributes: dict) -> None:
        """Create the group and its arrays, without cases, in a folder or in memory."""
        import zarr

        root = zarr.create_group(place, attributes=attributes)
        for name in Columns._fields:
            units = {"units": columns.UNITS[name]} if name in columns.UNITS else {}
            arrays.create(root, name, self.asked, CHUNK, units, arrays.kind(name))
        root["status"].attrs.update(
            flag_values=list(range(len(columns.STATUSES))), flag_meanings=" ".join(columns.STATUSES)
        )
        inputs = root.create_group("inputs")
        for name in self.names:
            units = {"units": keys.unit(Scene, name) or "SI"}
            arrays.create(inputs, name, self.asked, CHUNK, units)

    def _require(self, identity: dict) -> None:
        """Raise StoreError unless this is a store of the ensemble with this ``identity``. If its
        description is damaged, its chunks identify it."""
        there, expected = described(self.path), plain(identity)
        if there is None:
            if not any(map(self._belongs, range(len(self)))):
                raise StoreError(
                    f"{self.path} is no store of an ensemble, or its cases.zarr/zarr.json is "
                    f"damaged; "
                    "give another --store, or remove it"
                )
        elif other := [name for name in expected if there["identity"].get(name) != expected[name]]:
            raise StoreError(
                f"{self.path} holds another ensemble: {', '.join(other)} differ; "
                "give another --store, or remove it"
            )

    def _belongs(self, number: int) -> bool:
        try:
            return self._marks(number).read(self._mark(number), self.ensemble) is not None
        except (DamageError, OSError):
            return False

    def _describe(self, attributes: dict) -> None:
        """Rewrite every description that differs from a new store; attributes that fit their digest
        may differ."""
        import zarr

        new: dict = {}
        self._create(zarr.storage.MemoryStore(new), attributes)
        for name, content in new.items():
            path = self.path / "cases.zarr" / name
            if not path.is_file() or not _alike(path.read_bytes(), content.to_bytes()):
                tell(f"{path} is damaged or was edited: it is written again")
                with replacing(path) as temporary:
                    temporary.write_bytes(content.to_bytes())

    def _opened(self) -> tuple[dict, list]:
        """Arrays of the results by name, and of the inputs."""
        import zarr

        try:
            group = zarr.open_group(self.path / "cases.zarr", mode="r+")
            return {name: group[name] for name in Columns._fields}, [
                group[f"inputs/{name}"] for name in self.names
            ]
        except (OSError, ValueError, KeyError) as error:
            raise StoreError(
                f"{self.path} is no store of an ensemble ({type(error).__name__}: {error}); "
                "give another --store"
            ) from error

    def __len__(self) -> int:
        return -(-self.asked // CHUNK)

    def bounds(self, number: int) -> tuple[int, int]:
        """First case of a chunk, and first case of the next."""
        return number * CHUNK, min((number + 1) * CHUNK, self.asked)

    def pending(self) -> list[int]:
        """Numbers of the chunks that are missing or damaged; damage is reported."""
        return [number for number in range(len(self)) if not self._whole(number)]

    def holds(self, case: int) -> bool:
        """Whether the chunk of a case is done and whole; damage is reported."""
        return self._whole(case // CHUNK)

    def write(self, chunk: Chunk) -> None:
        """Store the results of a chunk. Raises StoreError if that fails, for example on a full
        disk."""
        begin, end = self.bounds(chunk.number)
        inputs = numbers(self.names, chunk.rows)
        with self._explained():
            for name, values in zip(Columns._fields, chunk.results):
                self._arrays[name][begin:end] = values
            for place, values in zip(self._inputs, inputs.T):
                place[begin:end] = values
            failures = [
                {"case": begin + n, "status": status, "reason": message, "inputs": _plain(row)}
                for n, (code, message, row) in enumerate(
                    zip(chunk.results.status, chunk.messages, chunk.rows)
                )
                if (status := columns.STATUSES[code]) in _FAILED
            ]
            failed = {failure["case"] for failure in failures}
            warnings = {
                str(begin + n): text
                for n, text in enumerate(chunk.messages)
                if text and begin + n not in failed
            }
            self._marks(chunk.number).put(
                self._mark(chunk.number),
                self.ensemble,
                {
                    "digest": _digest(chunk.results, inputs),
                    **columns.counts(chunk.results.status),
                    "failures": failures,
                    "warnings": warnings,
                },
            )

    def add(self, name: str, attributes: dict, values: Iterable[np.ndarray]) -> None:
        """Store a further column (n,) with the results, its ``values`` by chunk; an existing one
        stays until all of the new one is written, and if it cannot be put in place. Raises StoreError
        as ``write`` does."""
        import zarr

        with self._explained():
            folder = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=self.path))
            try:
                group = zarr.create_group(folder / "group")
                column = arrays.create(group, name, self.asked, CHUNK, attributes)
                for number, part in enumerate(values):
                    column[slice(*self.bounds(number))] = part
                arrays.exchange(
                    folder / "group" / name, self.path / "cases.zarr" / name, folder / "old"
                )
            finally:
                shutil.rmtree(folder, ignore_errors=True)

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise StoreError(
                f"cannot write {self.path}: {error.strerror or error}; {self.progress()}"
            ) from error

    def progress(self) -> str:
        """Number of stored cases, as part of a message."""
        return (
            f"{self.done():,} of {self.asked:,} cases are stored, and the same command goes on "
            f"from there"
        )

    def _whole(self, number: int) -> bool:
        begin, end = self.bounds(number)
        again = f"the cases {begin:,} to {end - 1:,} are run again"
        mark = self._marks(number).get(self._mark(number), self.ensemble, again)
        if mark is None:
            return False
        try:
            whole = mark["digest"] == _digest(*self.read(begin, end))
        except Exception:  # zarr raises many kinds on damaged bytes
            whole = False
        if not whole:
            tell(f"  {self.path / 'cases.zarr'} is damaged or was edited: {again}")
        return whole

    def _mark(self, number: int) -> Path:
        return self.path / "done" / f"{number:06}.json"

    def _marks(self, number: int) -> Cache[dict]:
        """Cache of the mark of a chunk. A mark with another layout counts as damaged."""

        def listed(mark: dict) -> dict:
            if not _is_listed(mark, *self.bounds(number)):
                raise DamageError(self._mark(number), "has another layout")
            return mark

        return documents(dict, listed)

    def _read_mark(self, number: int) -> dict | None:
        """The mark of a chunk, None before it is done. Raises StoreError if it is damaged."""
        try:
            return self._marks(number).read(self._mark(number), self.ensemble)
        except FileNotFoundError:
            return None
        except (DamageError, OSError) as fault:
            words = "is damaged or was edited; the same command runs its cases again"
            raise StoreError(f"{self._mark(number)} {words}") from fault

    def read(self, begin: int, end: int) -> tuple[Columns, np.ndarray]:
        """Results, and inputs (n, k), of the cases ``begin`` to ``end`` - 1; status -1 for cases
        that have not run yet."""
        found = Columns(*(self._arrays[name][begin:end] for name in Columns._fields))
        return found, np.array([place[begin:end] for place in self._inputs]).reshape(
            len(self.names), -1
        ).T

    def column(self, name: str, begin: int = 0, end: int | None = None) -> np.ndarray:
        """One of the results of the cases ``begin`` to ``end`` - 1 (default: all)."""
        return self._arrays[name][begin:end]

    def done(self) -> int:
        """Number of stored cases."""
        return sum(
            end - begin
            for begin, end in (
                self.bounds(number) for number in range(len(self)) if self._mark(number).is_file()
            )
        )

    def failures(self) -> list[dict]:
        """Case number, status, reason and inputs of each case that was refused or diverged. Raises
        StoreError if the list is damaged."""
        return [
            failure
            for number in range(len(self))
            for failure in (self._read_mark(number) or {"failures": []})["failures"]
        ]

    def digest(self) -> str:
        """Hexadecimal digest of all numbers, the same for every run of one ensemble."""
        return content_hash(
            [(self._read_mark(number) or {}).get("digest") for number in range(len(self))]
        )

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


def described(path: Path) -> dict | None:
    """Attributes of the store at ``path``; None if there are none or they do not fit their
    digest."""
    try:
        found = json.loads((path / "cases.zarr" / "zarr.json").read_bytes())["attributes"]
        return found if fits_digest(found) else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _is_listed(mark: dict, begin: int, end: int) -> bool:
    """Whether the lists of a mark have a text for each of the cases ``begin`` to ``end`` - 1."""
    try:
        texts = [(item["case"], item["reason"]) for item in mark["failures"]]
        texts += [(int(case), text) for case, text in mark["warnings"].items()]
        return all(begin <= case < end and isinstance(text, str) for case, text in texts)
    except (KeyError, TypeError, ValueError, AttributeError):
        return False


def plain(identity: dict) -> dict:
    """An identity in the form of a file: tuples are lists."""
    return json.loads(json.dumps(identity))


def _alike(there: bytes, new: bytes) -> bool:
    """Whether two descriptions (JSON) are equal, except for attributes that fit their own
    digest."""
    try:
        found, expected = json.loads(there), json.loads(new)
        if fits_digest(found["attributes"]):
            found["attributes"] = expected["attributes"]
        return found == expected
    except (ValueError, KeyError, TypeError, AttributeError):
        return False


def _digest(results: Columns, inputs: np.ndarray) -> str:
    digest = hashlib.sha256()
    for name, values in zip(Columns._fields, results):
        digest.update(np.ascontiguousarray(values, dtype=arrays.kind(name)).data)
    digest.update(np.ascontiguousarray(inputs).data)
    return digest.hexdigest()


def _plain(row: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs in the form of JSON: text for values that are neither finite numbers nor text."""
    return {
        key: value
        if isinstance(value, (str, int)) or (isinstance(value, float) and np.isfinite(value))
        else repr(value)
        for key, value in row.items()
    }
